#include "engine/exact/probe_impulses.hpp"

#include <algorithm>
#include <limits>

namespace pwlsim::engine {

ProbeImpulses::ProbeImpulses(const std::vector<IslandModel>& islands, const Probes& probes)
    : islands_(islands), probes_(probes), shares_(islands.size()), values_(probes.signals.size()) {
  if (probes.sink == nullptr) return;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const model::System& system = islands[i].extraction.system;
    for (std::size_t k = 0; k < system.outputs.size(); ++k)
      for (std::size_t probe = 0; probe < probes.signals.size(); ++probe)
        if (probes.signals[probe] == system.output_signal[k]) shares_[i].push_back({&system.outputs[k], probe});
  }
}

void ProbeImpulses::before(std::size_t island, const std::vector<double>& x) {
  if (shares_[island].empty()) return;
  const model::System& system = islands_[island].extraction.system;
  zeta_ = Eigen::Map<const model::Vector>(x.data() + system.n, system.n_zeta);
}

void ProbeImpulses::sources_jumped(std::size_t island, const std::vector<double>& x) {
  if (shares_[island].empty()) return;
  const model::System& system = islands_[island].extraction.system;
  const model::Vector change = Eigen::Map<const model::Vector>(x.data() + system.n, system.n_zeta) - zeta_;
  for (const Share& share : shares_[island]) values_[share.probe] += share.row->edge.dot(change);
  any_ = true;
}

/// Where derivatives of impulses acted, those of first order are not all there is.
void ProbeImpulses::ports_jumped(std::size_t island, const model::Selected& selected) {
  for (const Share& share : shares_[island]) {
    if (share.row->input.isZero(0.0)) continue;
    values_[share.probe] +=
        selected.details->higher_order ? std::numeric_limits<double>::quiet_NaN() : share.row->input.dot(selected.details->impulse);
    any_ = true;
  }
}

void ProbeImpulses::end(double time, bool wanted) {
  if (!any_) return;
  if (wanted) probes_.sink->impulse(time, values_);
  std::fill(values_.begin(), values_.end(), 0.0);
  any_ = false;
}

}  // namespace pwlsim::engine
