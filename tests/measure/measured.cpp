#include "measure/measured.hpp"

#include <algorithm>

#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "engine/sparse/sparse.hpp"
#include "netlist/load.hpp"

namespace pwlsim::test {
namespace {

class NoRows : public engine::RowSink {
 public:
  bool write(std::span<const double>, std::size_t) override { return true; }
};

std::string errors_of(const Diagnostics& diagnostics, const SourceStore& sources) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics.all())
    if (diagnostic.severity == Severity::error) text += render(diagnostic, sources);
  return text;
}

engine::Answer run(const circuit::Compiled& compiled, const engine::Request& request, double reltol) {
  NoRows rows;
  Diagnostics diagnostics;
  if (reltol > 0.0) return engine::sparse::run(*engine::sparse::prepare(compiled.network, diagnostics), request, reltol, rows);
  return engine::run(*engine::prepare(compiled.network, diagnostics), request, rows);
}

}  // namespace

const measure::Result& Measured::result(const std::string& name) const {
  return *std::find_if(results.list.begin(), results.list.end(), [&](const measure::Result& other) { return other.name == name; });
}

Measured measure_deck(const std::string& text, double reltol, const std::atomic<int>* interrupt) {
  Measured measured;
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Deck deck = netlist::parse("deck.net", text, sources, diagnostics);
  const auto compiled = circuit::compile(deck, sources, diagnostics, {.measure = true});
  measured.messages = errors_of(diagnostics, sources);
  if (!compiled) return measured;
  const circuit::TransientAnalysis& transient = *compiled->analyses.transient;
  measure::Measuring measuring(compiled->measurements, transient.start.seconds, transient.stop.seconds, transient.stop.seconds);
  while (measuring.begin_pass()) {
    engine::Request request;
    request.stop = transient.stop.seconds;
    request.use_initial_conditions = transient.use_initial_conditions;
    request.unsaved_signals = compiled->measured_signals;
    request.probes = measuring.probes();
    request.interrupt = interrupt;
    measuring.end_pass(run(*compiled, request, reltol).probed);
    ++measured.passes;
  }
  measured.results = measuring.results();
  for (const measure::Result& result : measured.results.list)
    if (result.failure.empty()) measured.value[result.name] = result.value;
  return measured;
}

}  // namespace pwlsim::test
