#include "model/leaks.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/arithmetic.hpp"
#include "base/disjoint_sets.hpp"

namespace pwlsim::model {

namespace {

/// Smaller resistors do not count as leaks. Without capacitors the rate R/L decides: beside a wire of 1 µΩ any load is large.
double least_resistance(const Network& network) {
  LogMean capacitance, inductance;
  for (const auto& c : network.capacitors) capacitance.add(std::abs(c.capacitance));
  for (const auto& l : network.inductors) inductance.add(std::abs(l.inductance));
  return capacitance.empty() ? least_rate * inductance.value() : least_leak * std::sqrt(inductance.value() / capacitance.value());
}

class LeakFinder {
 public:
  explicit LeakFinder(const Network& network) : network_(network) {
    const double least = least_resistance(network);
    for (const auto& r : network.resistors)
      if (r.p != r.n) (r.resistance > least ? leaks_ : firm_).push_back(&r);
    std::stable_sort(leaks_.begin(), leaks_.end(), [](const auto* a, const auto* b) { return a->resistance < b->resistance; });
  }

  [[nodiscard]] std::vector<const Resistor*> run() const {
    if (leaks_.empty()) return {};
    DisjointSets parts = firm_parts();
    std::vector<const Resistor*> tree;
    for (const Resistor* leak : leaks_)
      if (parts.join(number(leak->p), number(leak->n))) tree.push_back(leak);
    std::vector<const Resistor*> found;
    for (const Resistor* leak : tree)
      if (is_crossed_by_inductor(*leak, tree)) found.push_back(leak);
    return found;
  }

 private:
  [[nodiscard]] static int number(NodeIndex node) { return node + 1; }

  [[nodiscard]] DisjointSets firm_parts() const {
    DisjointSets parts(number(static_cast<int>(network_.nodes.size())));
    const auto join = [&](const auto& elements) {
      for (const auto& element : elements) parts.join(number(element.p), number(element.n));
    };
    join(network_.capacitors);
    join(network_.branches);
    join(network_.diodes);
    join(network_.switches);
    for (const Resistor* r : firm_) parts.join(number(r->p), number(r->n));
    return parts;
  }

  /// Of the two parts that the tree without this leak consists of.
  [[nodiscard]] bool is_crossed_by_inductor(const Resistor& leak, const std::vector<const Resistor*>& tree) const {
    DisjointSets parts = firm_parts();
    for (const Resistor* other : tree)
      if (other != &leak) parts.join(number(other->p), number(other->n));
    return std::any_of(network_.inductors.begin(), network_.inductors.end(),
                       [&](const Inductor& l) { return parts.find(number(l.p)) != parts.find(number(l.n)); });
  }

  const Network& network_;
  std::vector<const Resistor*> leaks_, firm_;
};

}  // namespace

void put_ports_beside_leaks(Network& network) {
  if (network.inductors.empty()) return;
  for (const Resistor* leak : LeakFinder(network).run())
    network.diodes.push_back({.label = {{}, leak->label.span}, .p = leak->p, .n = leak->n, .blocks = true, .is_of_leak = true});
}

Network without_ports_of_leaks(Network network) {
  std::erase_if(network.diodes, [](const Diode& diode) { return diode.is_of_leak; });
  return network;
}

}  // namespace pwlsim::model
