#include "cli/inspect_session.hpp"

#include "analysis/inspection.hpp"
#include "cli/deck_reader.hpp"
#include "cli/output.hpp"
#include "cli/signals.hpp"
#include "engine/exact/exact.hpp"

namespace pwlsim::cli {
namespace {

int interrupted(Messages& messages) {
  messages.report({Severity::error, "E-interrupted", {}, "interrupted before the model stood; nothing was written"});
  return status_of_signal(caught_signal());
}

}  // namespace

int run_inspect_session(const InspectOptions& options) {
  Messages messages(options.quiet);
  SourceStore sources;
  const DeckReading reading = read_deck(options.deck, {.analysis_required = false}, sources, messages);
  if (!reading.compiled) return static_cast<int>(reading.status);
  if (caught_signal() != 0) return interrupted(messages);
  Diagnostics diagnostics;
  const auto model = engine::prepare(reading.compiled->network, diagnostics);
  std::optional<analysis::Inspection> inspection;
  if (model != nullptr && caught_signal() == 0) inspection = analysis::inspect(*reading.compiled, *model, options.mode, diagnostics);
  messages.report(diagnostics, sources);
  if (caught_signal() != 0) return interrupted(messages);
  if (!inspection) return static_cast<int>(Status::wrong_input);
  return print(options.json ? analysis::inspection_json(*inspection) : analysis::inspection_text(*inspection), messages);
}

}  // namespace pwlsim::cli
