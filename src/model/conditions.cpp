#include "model/conditions.hpp"

#include <map>

namespace pwlsim::model {

Network with_held_conditions(Network network) {
  for (const auto& c : network.node_conditions) network.branches.push_back({c.label, c.node, ground, {{Term::Kind::one, 0, c.voltage}}});
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
