#include "analysis/stepped_sources.hpp"

#include <algorithm>
#include <utility>

namespace pwlsim::analysis {
namespace {

/// Whether each channel has one source that is held, and nothing else of the network is named after it.
bool all_are_held(const model::Network& network, const std::vector<std::string>& names) {
  std::vector<int> found(names.size(), 0);
  for (const model::Source& source : network.sources)
    if (const auto* held = std::get_if<model::Held>(&source.function)) ++found[static_cast<std::size_t>(held->channel)];
  return std::all_of(found.begin(), found.end(), [](int count) { return count == 1; });
}

bool has_tangents(const model::Network& network) {
  return std::any_of(network.diodes.begin(), network.diodes.end(), [](const model::Diode& diode) { return diode.law.has_value(); });
}

}  // namespace

std::optional<SteppedSources> SteppedSources::make(const netlist::Deck& deck, SourceStore sources, circuit::CompileOptions options,
                                                   const std::vector<std::string>& names, EngineChoice choice, double reltol) {
  if (names.empty() || choice == EngineChoice::sparse) return {};
  Diagnostics diagnostics;
  options.held = names;
  std::optional<circuit::Compiled> compiled = circuit::compile(deck, sources, diagnostics, options);
  if (!compiled || !all_are_held(compiled->network, names) || has_tangents(compiled->network) || compiled->draws_random) return {};
  if (prepare_engine(compiled->network, choice, reltol, diagnostics).name != "exact") return {};
  SteppedSources stepped;
  stepped.model_ = engine::prepare(compiled->network, diagnostics);
  if (!stepped.model_ || diagnostics.has_errors()) return {};
  stepped.compiled_ = std::make_shared<const circuit::Compiled>(std::move(*compiled));
  return stepped;
}

Simulate SteppedSources::simulate(std::span<const double> values) const {
  return [model = engine::with_held_values(*model_, values)](const engine::Request& request, engine::RowSink& sink) {
    return engine::run(*model, request, sink);
  };
}

}  // namespace pwlsim::analysis
