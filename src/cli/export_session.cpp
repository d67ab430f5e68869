#include "cli/export_session.hpp"

#include "cli/deck_reader.hpp"
#include "cli/output.hpp"
#include "cli/signals.hpp"
#include "spice/deck.hpp"

namespace pwlsim::cli {

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
    fail(messages, Status::run_failed, "E-interrupted", "interrupted before the deck was written");
    return status_of_signal(caught_signal());
  }
  std::optional<waveform::OutputFile> file;
  if (const int status = open_output(options.output, reading.files, messages, file); status != 0) return status;
  return write_whole(*file, deck->text, messages);
}

}  // namespace pwlsim::cli
