#include "engine/sparse/fastest.hpp"
#include "engine/sparse/tolerances.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/disjoint_sets.hpp"
#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

namespace {

using model::NodeIndex;

/// Nodes that sources of voltage and parts without resistance may join; what sources join to ground is held.
class Clusters {
 public:
  explicit Clusters(const model::Network& network)
      : held_(static_cast<int>(network.nodes.size()) + 1), sets_(held_), conductance_(network.nodes.size() + 1, 0.0) {
    for (const auto& branch : network.branches) {
      if (model::is_independent(branch.voltage)) held_.join(branch.p + 1, branch.n + 1);
      sets_.join(branch.p + 1, branch.n + 1);
    }
    for (const auto& d : network.diodes) join_if_short(d.p, d.n, d.resistance);
    for (const auto& s : network.switches) join_if_short(s.p, s.n, s.resistance);
    for (const auto& r : network.resistors) add(r.p, r.n, r.resistance);
    for (const auto& d : network.diodes) add(d.p, d.n, d.resistance);
    for (const auto& s : network.switches) add(s.p, s.n, s.resistance);
  }
  /// All that meets there; zero where it is held.
  [[nodiscard]] double conductance(NodeIndex node) {
    if (held_.find(node + 1) == held_.find(model::ground + 1)) return 0.0;
    return conductance_[static_cast<std::size_t>(sets_.find(node + 1))];
  }

 private:
  void join_if_short(NodeIndex p, NodeIndex n, double resistance) {
    if (resistance == 0.0) sets_.join(p + 1, n + 1);
  }
  void add(NodeIndex p, NodeIndex n, double resistance) {
    if (resistance == 0.0) return;
    for (const NodeIndex node : {p, n}) conductance_[static_cast<std::size_t>(sets_.find(node + 1))] += 1.0 / std::abs(resistance);
  }
  DisjointSets held_, sets_;
  std::vector<double> conductance_;
};

/// Of each inductor what its closest coupling leaves of it; of perfectly coupled ones all.
std::vector<double> leakages(const model::Network& network) {
  std::vector<double> result;
  for (const auto& l : network.inductors) result.push_back(std::abs(l.inductance));
  for (const auto& k : network.couplings) {
    if (std::abs(k.coefficient) > tolerance::perfect_coupling) continue;
    for (const int i : {k.inductor_a, k.inductor_b}) {
      const double whole = std::abs(network.inductors[static_cast<std::size_t>(i)].inductance);
      double& left = result[static_cast<std::size_t>(i)];
      left = std::min(left, (1.0 - std::abs(k.coefficient)) * whole);
    }
  }
  return result;
}

}  // namespace

double fastest_time(const model::Network& network) {
  double fastest = model::forever, least_capacitance = model::forever, most_resistance = 0.0;
  Clusters clusters(network);
  for (const auto& c : network.capacitors) {
    const double capacitance = std::abs(c.capacitance);
    least_capacitance = std::min(least_capacitance, capacitance);
    const double conductance = std::max(clusters.conductance(c.p), clusters.conductance(c.n));
    if (conductance > 0.0) fastest = std::min(fastest, capacitance / conductance);
  }
  for (const auto& r : network.resistors) most_resistance = std::max(most_resistance, std::abs(r.resistance));
  for (const double inductance : leakages(network)) {
    if (most_resistance > 0.0) fastest = std::min(fastest, inductance / most_resistance);
    fastest = std::min(fastest, std::sqrt(inductance * least_capacitance));
  }
  return fastest;
}

}  // namespace pwlsim::engine::sparse
