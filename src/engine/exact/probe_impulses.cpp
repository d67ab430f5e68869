#include "engine/exact/probe_impulses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {
namespace {

/// Whether ports whose impulses are of that order give the signal one: directly, or, beyond the first, by way of states, x = Σ A^{j−2} B u^{−j} δ + ….
bool may_act(const model::System& system, const model::OutputRow& row, int order) {
  if (row.reads_ports()) return true;
  model::Vector reads = row.state;
  for (int k = 2; k <= order; ++k) {
    const model::Vector share = system.b.transpose() * reads, terms = system.b.cwiseAbs().transpose() * reads.cwiseAbs();
    if ((share.cwiseAbs().array() > tolerance::probe_impulse * terms.array()).any()) return true;
    reads = system.a.transpose() * reads;
  }
  return false;
}

}  // namespace

ProbeImpulses::ProbeImpulses(const std::vector<IslandModel>& islands, const Probes& probes)
    : islands_(islands), probes_(probes), shares_(islands.size()), values_(probes.signals.size()), terms_(probes.signals.size()) {
  if (probes.sink == nullptr) return;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const model::System& system = islands[i].extraction.system;
    for (std::size_t k = 0; k < system.outputs.size(); ++k)
      for (std::size_t probe = 0; probe < probes.signals.size(); ++probe)
        if (probes.signals[probe] == system.output_signal[k]) shares_[i].push_back({&system.outputs[k], probe});
  }
}

void ProbeImpulses::keep(const IslandAt& island) {
  const model::System& system = island.run.system();
  zeta_ = Eigen::Map<const model::Vector>(island.run.x.data() + system.n, system.n_zeta);
}

void ProbeImpulses::add_edges(const IslandAt& island) {
  const model::System& system = island.run.system();
  const Eigen::Map<const model::Vector> after(island.run.x.data() + system.n, system.n_zeta);
  const model::Vector change = after - zeta_;
  const model::Vector size = after.cwiseAbs() + zeta_.cwiseAbs();
  for (const Share& share : shares_[island.number]) add(share.probe, share.row->edge.dot(change), share.row->edge.cwiseAbs().dot(size));
}

void ProbeImpulses::add(std::size_t probe, double value, double terms) {
  values_[probe] += value;
  terms_[probe] += terms;
  any_ = true;
}

/// Where derivatives of impulses acted, those of first order are not all there is.
void ProbeImpulses::add_impulses(std::size_t island, const model::Selected& selected) {
  const model::Details& details = *selected.details;
  for (const Share& share : shares_[island]) {
    const model::OutputRow& row = *share.row;
    if (!may_act(islands_[island].extraction.system, row, details.order)) continue;
    const double value = details.higher_order ? std::numeric_limits<double>::quiet_NaN() : row.input.dot(details.impulse);
    add(share.probe, value, row.input.cwiseAbs().dot(details.impulse.cwiseAbs()));
  }
}

void ProbeImpulses::pass_on(double time, bool impulses_count) {
  for (std::size_t probe = 0; probe < values_.size(); ++probe)
    if (std::abs(values_[probe]) <= tolerance::probe_impulse * terms_[probe]) values_[probe] = 0.0;
  if (impulses_count) probes_.sink->impulse(time, values_);
  std::fill(values_.begin(), values_.end(), 0.0);
  std::fill(terms_.begin(), terms_.end(), 0.0);
  any_ = false;
}

}  // namespace pwlsim::engine
