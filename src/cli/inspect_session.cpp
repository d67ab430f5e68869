#include "cli/inspect_session.hpp"

#include <memory>
#include <utility>

#include "analysis/abandonable.hpp"
#include "analysis/inspection.hpp"
#include "cli/deck_reader.hpp"
#include "cli/output.hpp"
#include "cli/signals.hpp"
#include "engine/exact/exact.hpp"

namespace pwlsim::cli {
namespace {

int interrupted(Messages& messages) { return fail_by_signal(messages, "interrupted before the model was built; nothing was written"); }

/// What may be left to itself after a signal.
struct Work {
  circuit::Compiled compiled;
  InspectOptions options;
  Diagnostics diagnostics;
  std::optional<analysis::Inspection> inspection;

  void run() {
    const auto model = engine::prepare(compiled.network, diagnostics, engine::Leaks::as_written);
    if (model != nullptr && caught_signal() == 0) inspection = analysis::inspect(compiled, *model, options.mode, diagnostics);
  }
};

}  // namespace

int run_inspect_session(const InspectOptions& options) {
  Messages messages(options.quiet);
  SourceStore sources;
  DeckReading reading = read_deck(options.deck, {.analysis_required = false}, sources, messages);
  if (!reading.compiled) return static_cast<int>(reading.status);
  if (caught_signal() != 0) return interrupted(messages);
  const auto work = std::make_shared<Work>(Work{std::move(*reading.compiled), options, {}, {}});
  if (!analysis::finished_in_time([work] { work->run(); }, caught_signal())) return interrupted(messages);
  const std::optional<analysis::Inspection>& inspection = work->inspection;
  messages.report(work->diagnostics, sources);
  if (caught_signal() != 0) return interrupted(messages);
  if (!inspection) return static_cast<int>(Status::wrong_input);
  return print(options.json ? analysis::inspection_json(*inspection) : analysis::inspection_text(*inspection), messages);
}

}  // namespace pwlsim::cli
