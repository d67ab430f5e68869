#include "model/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "model/exosystem.hpp"
#include "model/forms.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

/// Just before t = 0, by source.
std::vector<double> values_before_start(const Network& network) {
  const Exosystem sources(source_functions(network), true);
  linalg::Vector zeta(sources.size());
  sources.evaluate(sources.start(), 0.0, zeta.data());
  const linalg::Vector values = sources.values(zeta);
  return {values.begin(), values.end()};
}

/// Voltages to ground that branches of sources alone hold just before t = 0.
class HeldPotentials {
 public:
  explicit HeldPotentials(const Network& network) : known_(network.nodes.size() + 1) {
    known_[0] = Potential{};
    const std::vector<double> sources = values_before_start(network);
    for (const Branch& branch : network.branches) {
      if (!is_independent(branch.voltage)) continue;
      Potential voltage;
      for (const Term& term : branch.voltage)
        voltage.add(term.coefficient * (term.kind == Term::Kind::one ? 1.0 : sources[static_cast<std::size_t>(term.index)]));
      steps_.push_back({branch.p, branch.n, voltage});
    }
    spread();
  }

  [[nodiscard]] bool holds(NodeIndex node, double voltage) const {
    const auto known = known_[place(node)];
    return known && std::abs(known->value - voltage) <= tolerance::same_potential * std::max(known->size, std::abs(voltage));
  }

  void hold(NodeIndex node, double voltage) {
    if (!known_[place(node)]) known_[place(node)] = Potential{voltage, std::abs(voltage)};
    spread();
  }

 private:
  /// With the sum of the magnitudes of its terms, which its rounding is relative to.
  struct Potential {
    double value = 0.0, size = 0.0;
    void add(double term) {
      value += term;
      size += std::abs(term);
    }
  };
  struct Step {
    NodeIndex p = ground, n = ground;
    Potential voltage;
  };

  static std::size_t place(NodeIndex node) { return static_cast<std::size_t>(node - ground); }

  void spread() {
    const auto is_known = [&](NodeIndex node) { return known_[place(node)].has_value(); };
    spread_voltages(steps_, is_known, [&](const Step& step, bool from_p) {
      auto &p = known_[place(step.p)], &n = known_[place(step.n)];
      if (from_p)
        n = Potential{p->value - step.voltage.value, p->size + step.voltage.size};
      else
        p = Potential{n->value + step.voltage.value, n->size + step.voltage.size};
      return true;
    });
  }

  std::vector<Step> steps_;
  std::vector<std::optional<Potential>> known_;  ///< ground first
};

void hold_nodes(Network& network) {
  if (network.node_conditions.empty()) return;
  HeldPotentials potentials(network);
  for (const auto& c : network.node_conditions) {
    if (potentials.holds(c.node, c.voltage)) continue;
    network.branches.push_back({c.label, c.node, ground, {{Term::Kind::one, 0, c.voltage}}});
    potentials.hold(c.node, c.voltage);
  }
}

}  // namespace

Network with_held_conditions(Network network) {
  hold_nodes(network);
  for (const auto& c : network.current_conditions) {
    Inductor& l = network.inductors[static_cast<std::size_t>(c.inductor)];
    network.nodes.push_back({c.label.name, c.label.span});
    const auto middle = static_cast<NodeIndex>(network.nodes.size()) - 1;
    const NodeIndex end = l.n;
    l.n = middle;
    network.injections.push_back({c.label, middle, end, {{Term::Kind::one, 0, c.current}}});
  }
  return network;
}

Network with_resting_sources(Network network) {
  const std::vector<double> values = values_before_start(network);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::holds_alternative<Held>(network.sources[i].function)) network.sources[i].function = Dc{values[i]};
  return network;
}

Network without_initial_values(Network network) {
  for (auto& c : network.capacitors) {
    if (c.starts_there) continue;
    c.has_initial = false;
    c.initial_voltage = 0.0;
  }
  for (auto& l : network.inductors) {
    l.has_initial = false;
    l.initial_current = 0.0;
  }
  return network;
}

Network with_initial_values(Network network) {
  std::map<NodeIndex, double> voltage;
  for (const auto& c : network.node_conditions) voltage[c.node] = c.voltage;
  const auto at = [&](NodeIndex node) { return voltage.contains(node) ? voltage.at(node) : 0.0; };
  for (auto& c : network.capacitors)
    if (!c.has_initial) c.initial_voltage = at(c.p) - at(c.n);
  for (const auto& c : network.current_conditions) {
    auto& l = network.inductors[static_cast<std::size_t>(c.inductor)];
    if (!l.has_initial) l.initial_current = c.current;
  }
  return network;
}

}  // namespace pwlsim::model
