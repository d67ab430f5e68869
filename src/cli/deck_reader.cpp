#include "cli/deck_reader.hpp"

#include <algorithm>
#include <chrono>

#include "netlist/load.hpp"

namespace pwlsim::cli {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Whether nothing else is wrong with the deck than that files it names cannot be read.
bool only_unreadable_files(const Diagnostics& diagnostics) {
  return diagnostics.has_errors() && std::all_of(diagnostics.all().begin(), diagnostics.all().end(), [](const Diagnostic& diagnostic) {
           return diagnostic.severity != Severity::error || diagnostic.id == "E-include-unreadable";
         });
}

circuit::DrawnNames names_in(const std::vector<netlist::DrawnPlace>& places) {
  circuit::DrawnNames names;
  for (const netlist::DrawnPlace& place : places) {
    names.nodes.insert(names.nodes.end(), place.nodes.begin(), place.nodes.end());
    names.elements.insert(names.elements.end(), place.elements.begin(), place.elements.end());
  }
  return names;
}

}  // namespace

DeckReading read_deck(const std::string& name, circuit::CompileOptions options, SourceStore& sources, Messages& messages,
                      bool keep_drawing) {
  DeckReading reading;
  Diagnostics diagnostics;
  const auto parse_start = Clock::now();
  netlist::Loaded loaded = netlist::load(name, sources, diagnostics, {}, keep_drawing ? &reading.drawing : nullptr);
  reading.places = netlist::places_of(reading.drawing);
  options.drawn = reading.drawn = names_in(reading.places);
  reading.seconds_parse = since(parse_start);
  const auto flatten_start = Clock::now();
  if (loaded.readable) reading.compiled = circuit::compile(loaded.deck, sources, diagnostics, options);
  reading.seconds_flatten = since(flatten_start);
  reading.deck = std::move(loaded.deck);
  reading.files = std::move(loaded.files);
  messages.report(diagnostics, sources);
  if (reading.compiled) return reading;
  reading.status = !loaded.readable || only_unreadable_files(diagnostics) ? Status::file_error : Status::wrong_input;
  return reading;
}

}  // namespace pwlsim::cli
