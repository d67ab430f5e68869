#include "cli/export_session.hpp"

#include <fmt/format.h>

#include "cli/deck_reader.hpp"
#include "cli/messages.hpp"
#include "cli/signals.hpp"
#include "cli/status.hpp"
#include "spice/deck.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {
namespace {

int fail(Messages& messages, Status status, std::string id, std::string text) {
  messages.report({Severity::error, std::move(id), {}, std::move(text)});
  return static_cast<int>(status);
}

int write(const std::string& text, const ExportOptions& options, Messages& messages) {
  if (options.output != "-" && waveform::same_file(options.output, options.deck))
    return fail(messages, Status::wrong_input, "E-output-is-deck", fmt::format("{} is the deck itself; try another name", options.output));
  std::string problem;
  auto file = waveform::OutputFile::open(options.output, problem);
  if (!file) return fail(messages, Status::file_error, "E-cannot-write", fmt::format("{}: {}; try another place", options.output, problem));
  if (file->write(text) && file->commit()) return static_cast<int>(Status::done);
  if (file->closed_pipe()) return static_cast<int>(Status::closed_pipe);
  return fail(messages, Status::file_error, "E-cannot-write", fmt::format("{}: {}", file->name(), file->problem()));
}

}  // namespace

int run_export_session(const ExportOptions& options) {
  Messages messages(options.quiet);
  SourceStore sources;
  const DeckReading reading = read_deck(options.deck, {.keep_circuit = true}, sources, messages);
  if (!reading.compiled) return static_cast<int>(reading.status);
  Diagnostics diagnostics;
  spice::DeckSettings settings;
  settings.sharpness = options.sharpness;
  const auto deck = spice::smooth_deck(*reading.compiled->circuit, settings, diagnostics);
  messages.report(diagnostics, sources);
  if (!deck) return static_cast<int>(Status::wrong_input);
  if (caught_signal() != 0) {
    messages.report({Severity::error, "E-interrupted", {}, "interrupted before the deck was written"});
    return status_of_signal(caught_signal());
  }
  return write(deck->text, options, messages);
}

}  // namespace pwlsim::cli
