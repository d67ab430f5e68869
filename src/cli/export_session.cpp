#include "cli/export_session.hpp"

#include <string_view>

#include "base/names.hpp"
#include "cli/deck_reader.hpp"
#include "cli/output.hpp"
#include "cli/signals.hpp"
#include "netlist/load.hpp"
#include "spice/deck.hpp"

namespace pwlsim::cli {
namespace {

/// `x.net` of a schematic: not its smoothed equivalent, but the deck itself.
bool asks_for_netlist(const ExportOptions& options) {
  const std::string_view output = options.output;
  return netlist::is_schematic(options.deck) && output.size() >= 4 && same_name(output.substr(output.size() - 4), ".net");
}

int export_netlist(const ExportOptions& options, Messages& messages) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::WrittenNetlist netlist = netlist::write_netlist(options.deck, sources, diagnostics);
  messages.report(diagnostics, sources);
  if (!netlist.readable) return static_cast<int>(Status::file_error);
  if (diagnostics.has_errors()) return static_cast<int>(Status::wrong_input);
  std::optional<waveform::OutputFile> file;
  if (const int status = open_output(options.output, netlist.files, messages, file); status != 0) return status;
  return write_whole(*file, netlist.text, messages);
}

}  // namespace

int run_export_session(const ExportOptions& options) {
  Messages messages(options.quiet);
  if (asks_for_netlist(options)) return export_netlist(options, messages);
  SourceStore sources;
  const DeckReading reading = read_deck(options.deck, {.keep_circuit = true}, sources, messages);
  if (!reading.compiled) return static_cast<int>(reading.status);
  Diagnostics diagnostics;
  spice::DeckSettings settings;
  settings.sharpness = options.sharpness;
  const auto deck = spice::smooth_deck(*reading.compiled->circuit, settings, diagnostics);
  messages.report(diagnostics, sources);
  if (!deck) return static_cast<int>(Status::wrong_input);
  if (caught_signal() != 0) return fail_by_signal(messages, "interrupted before the deck was written");
  std::optional<waveform::OutputFile> file;
  if (const int status = open_output(options.output, reading.files, messages, file); status != 0) return status;
  return write_whole(*file, deck->text, messages);
}

}  // namespace pwlsim::cli
