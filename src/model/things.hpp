#pragma once
/// One numbering of all nodes and elements of a network.

#include <vector>

#include "model/network.hpp"

namespace pwlsim::model {

/// Every node and element of the network as one numbered thing.
class Things {
 public:
  explicit Things(const Network& n) {
    int next = 0;
    const auto take = [&next](std::size_t many) {
      const int first = next;
      next += static_cast<int>(many);
      return first;
    };
    node = take(n.nodes.size());
    resistor = take(n.resistors.size());
    capacitor = take(n.capacitors.size());
    inductor = take(n.inductors.size());
    branch = take(n.branches.size());
    injection = take(n.injections.size());
    diode = take(n.diodes.size());
    complementarity = take(n.complementarities.size());
    switch_ = take(n.switches.size());
    source = take(n.sources.size());
    count = next;
  }
  /// The thing a term reads; −1 for constants, sources (they belong to whoever uses them) and ground.
  [[nodiscard]] int of(const Term& term) const {
    switch (term.kind) {
      case Term::Kind::one:
      case Term::Kind::source:
        return -1;
      case Term::Kind::node_voltage:
        return term.index == ground ? -1 : node + term.index;
      case Term::Kind::resistor_current:
        return resistor + term.index;
      case Term::Kind::capacitor_current:
        return capacitor + term.index;
      case Term::Kind::inductor_current:
        return inductor + term.index;
      case Term::Kind::branch_current:
        return branch + term.index;
      case Term::Kind::diode_current:
        return diode + term.index;
      case Term::Kind::switch_current:
        return switch_ + term.index;
      case Term::Kind::slack_input:
        return complementarity + term.index;
    }
    return -1;
  }
  int node, resistor, capacitor, inductor, branch, injection, diode, complementarity, switch_, source, count;
};

/// `visit(element, node)` for each terminal of elements of one kind, the first of which is the thing `first`.
template <class Element, class Visit>
void for_each_terminal(const std::vector<Element>& elements, int first, const Visit& visit) {
  for (std::size_t i = 0; i < elements.size(); ++i)
    for (const NodeIndex node : {elements[i].p, elements[i].n}) visit(first + static_cast<int>(i), node);
}

/// Of all elements but branches.
template <class Visit>
void for_each_terminal(const Network& network, const Things& things, const Visit& visit) {
  for_each_terminal(network.resistors, things.resistor, visit);
  for_each_terminal(network.capacitors, things.capacitor, visit);
  for_each_terminal(network.inductors, things.inductor, visit);
  for_each_terminal(network.injections, things.injection, visit);
  for_each_terminal(network.diodes, things.diode, visit);
  for_each_terminal(network.switches, things.switch_, visit);
}

}  // namespace pwlsim::model
