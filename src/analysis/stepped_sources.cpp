#include "analysis/stepped_sources.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace pwlsim::analysis {
namespace {

/// Whether each channel has one source that is held.
bool all_are_held(const model::Network& network, std::size_t channels) {
  std::vector<int> found(channels, 0);
  for (const model::Source& source : network.sources)
    if (const auto* held = std::get_if<model::Held>(&source.function)) ++found[static_cast<std::size_t>(held->channel)];
  return std::all_of(found.begin(), found.end(), [](int count) { return count == 1; });
}

bool has_tangents(const model::Network& network) {
  return std::any_of(network.diodes.begin(), network.diodes.end(), [](const model::Diode& diode) { return diode.law.has_value(); });
}

}  // namespace

std::optional<SteppedSources> SteppedSources::make(circuit::Compiled compiled, std::size_t channels, EngineChoice choice) {
  if (channels == 0 || !has_modes(compiled.network, choice) || runs_by_segments(compiled.network, choice) ||
      !all_are_held(compiled.network, channels) || has_tangents(compiled.network) || compiled.draws_random)
    return {};
  Diagnostics diagnostics;
  SteppedSources stepped;
  stepped.model_ = engine::prepare(compiled.network, diagnostics);
  if (!stepped.model_ || diagnostics.has_errors()) return {};
  stepped.compiled_ = std::make_shared<const circuit::Compiled>(std::move(compiled));
  return stepped;
}

Simulate SteppedSources::simulate(std::span<const double> values) const {
  return [model = engine::with_held_values(*model_, values)](const engine::Request& request, engine::RowSink& sink) {
    return engine::run(*model, request, sink);
  };
}

}  // namespace pwlsim::analysis
