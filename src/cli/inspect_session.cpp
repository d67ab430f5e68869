#include "cli/inspect_session.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "analysis/inspection.hpp"
#include "cli/deck_reader.hpp"
#include "cli/messages.hpp"
#include "cli/signals.hpp"
#include "cli/status.hpp"
#include "engine/exact/exact.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {
namespace {

int print(const std::string& text, Messages& messages) {
  std::size_t written = 0;
  const int error_number = waveform::write_all(STDOUT_FILENO, text, written);
  if (error_number == 0) return static_cast<int>(Status::done);
  if (error_number == EPIPE) return static_cast<int>(Status::closed_pipe);
  messages.report({Severity::error, "E-cannot-write", {}, fmt::format("standard output: {}", std::strerror(error_number))});
  return static_cast<int>(Status::file_error);
}

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
