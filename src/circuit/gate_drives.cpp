#include "circuit/gate_drives.hpp"

#include <map>
#include <set>
#include <vector>

#include "circuit/node_groups.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Instance;
using model::NodeIndex;

bool is_letter(const Instance& instance, char letter) { return instance.kind != nullptr && instance.kind->letter == letter; }

/// Its voltage is its own: no current changes it.
bool is_voltage(const Instance& instance) {
  if (instance.nodes.size() != 2) return false;
  return is_letter(instance, 'V') || is_letter(instance, 'E') || is_letter(instance, 'H') ||
         (is_letter(instance, 'B') && !instance.formula_is_current);
}

/// Nodes that voltage sources tie together, and the resistors between such groups.
class Drives {
 public:
  explicit Drives(const FlatCircuit& circuit) : groups_(circuit.nodes().size()) {
    for (const Instance& instance : circuit.instances)
      if (is_voltage(instance)) groups_.join(instance.nodes[0], instance.nodes[1]);
    for (const Instance& instance : circuit.instances) {
      if (instance.nodes.size() < 2) continue;
      const NodeIndex a = instance.nodes[0], b = instance.nodes[1];
      const bool is_resistor = is_letter(instance, 'R');
      if (is_resistor) join(links_, group(a), group(b));
      const bool is_contact = is_letter(instance, 'S') || is_letter(instance, 'W');
      if (is_resistor || is_letter(instance, 'D') || is_letter(instance, 'C')) join(ties_, group(a), group(b));
      if (is_resistor || is_letter(instance, 'D') || is_contact) join(biases_, group(a), group(b));
      if (is_resistor && a != model::ground && group(a) == 0) pulled_up_.insert(group(b));
      if (is_resistor && b != model::ground && group(b) == 0) pulled_up_.insert(group(a));
    }
  }

  int group(NodeIndex node) { return groups_.root(node); }

  /// Whether resistors lead from one group to the other, and none to ground.
  bool leads_only_to(int to, int from) const {
    std::set<int> seen{from, to};
    std::vector<int> waiting{from};
    bool found = from == to;
    while (!waiting.empty()) {
      const int here = waiting.back();
      waiting.pop_back();
      if (here == 0) return false;
      const auto links = links_.find(here);
      if (links == links_.end()) continue;
      for (const int next : links->second) {
        found = found || next == to;
        if (seen.insert(next).second) waiting.push_back(next);
      }
    }
    return found;
  }

  /// Whether a resistor leads from it to a supply.
  [[nodiscard]] bool is_pulled_up(int at) const { return at != 0 && pulled_up_.contains(at); }

  /// Whether resistors, diodes and capacitors lead from one group to the other, not over ground or a supply.
  [[nodiscard]] bool reaches(int from, int to) const { return leads(ties_, from, to); }
  /// Likewise resistors, diodes and switches.
  [[nodiscard]] bool biases(int from, int to) const { return from != 0 && to != 0 && leads(biases_, from, to); }

 private:
  using Links = std::map<int, std::vector<int>>;

  static bool leads(const Links& links, int from, int to) {
    std::set<int> seen{from, 0};
    std::vector<int> waiting{from};
    while (!waiting.empty()) {
      const int here = waiting.back();
      waiting.pop_back();
      if (here == to) return true;
      const auto next_ones = links.find(here);
      if (next_ones == links.end()) continue;
      for (const int next : next_ones->second)
        if (seen.insert(next).second) waiting.push_back(next);
    }
    return false;
  }

  static void join(Links& links, int a, int b) {
    links[a].push_back(b);
    links[b].push_back(a);
  }

  NodeGroups groups_;
  Links links_, ties_, biases_;
  std::set<int> pulled_up_;
};

/// Two MOSFETs whose gates are pulled up to a supply and held down by one another's drain (a ZVS driver, an astable multivibrator) go through their linear
/// region: as switches both would toggle from rest.
void mark_crossed_pairs(FlatCircuit& circuit, Drives& drives) {
  constexpr std::size_t drain = 0, gate = 1, source = 2;
  std::vector<Instance*> pulled_up;
  for (Instance& instance : circuit.instances)
    if (is_letter(instance, 'M') && instance.nodes.size() > source && drives.is_pulled_up(drives.group(instance.nodes[gate])))
      pulled_up.push_back(&instance);
  const auto holds = [&](const Instance& one, const Instance& other) {
    return drives.reaches(drives.group(other.nodes[gate]), drives.group(one.nodes[drain]));
  };
  for (Instance* one : pulled_up)
    for (Instance* other : pulled_up)
      if (one != other && holds(*one, *other) && holds(*other, *one)) one->drive_is_apart = true;
}

/// A MOSFET that gives its gate the voltage of its own drain (as a diode, or over a resistance) settles in its linear region, and those with the same gate
/// with it, as in a mirror.
void mark_self_biased_ones(FlatCircuit& circuit, Drives& drives) {
  constexpr std::size_t drain = 0, gate = 1, source = 2;
  std::set<int> gates;
  const auto is_transistor = [&](const Instance& instance) { return is_letter(instance, 'M') && instance.nodes.size() > source; };
  for (const Instance& instance : circuit.instances) {
    if (!is_transistor(instance)) continue;
    const int at_gate = drives.group(instance.nodes[gate]);
    if (drives.biases(drives.group(instance.nodes[drain]), at_gate)) gates.insert(at_gate);
  }
  for (Instance& instance : circuit.instances)
    if (is_transistor(instance) && gates.contains(drives.group(instance.nodes[gate]))) instance.drive_is_apart = true;
}

}  // namespace

void mark_gate_drives(FlatCircuit& circuit) {
  constexpr std::size_t gate = 1, source = 2;
  Drives drives(circuit);
  for (Instance& instance : circuit.instances) {
    if (!(is_letter(instance, 'M') || is_letter(instance, 'J')) || instance.nodes.size() <= source) continue;
    const int at_gate = drives.group(instance.nodes[gate]), at_source = drives.group(instance.nodes[source]);
    instance.drive_is_apart = at_source != 0 && at_gate != at_source && !drives.leads_only_to(at_source, at_gate);
  }
  mark_crossed_pairs(circuit, drives);
  mark_self_biased_ones(circuit, drives);
}

}  // namespace pwlsim::circuit
