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
  explicit Drives(const Circuit& circuit) : groups_(circuit.nodes().size()) {
    for (const Instance& instance : circuit.instances)
      if (is_voltage(instance)) groups_.join(instance.nodes[0], instance.nodes[1]);
    for (const Instance& instance : circuit.instances)
      if (is_letter(instance, 'R')) link(group(instance.nodes[0]), group(instance.nodes[1]));
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

 private:
  void link(int a, int b) {
    links_[a].push_back(b);
    links_[b].push_back(a);
  }

  NodeGroups groups_;
  std::map<int, std::vector<int>> links_;
};

}  // namespace

void mark_gate_drives(Circuit& circuit) {
  constexpr std::size_t gate = 1, source = 2;
  Drives drives(circuit);
  for (Instance& instance : circuit.instances) {
    if (!(is_letter(instance, 'M') || is_letter(instance, 'J')) || instance.nodes.size() <= source) continue;
    const int at_gate = drives.group(instance.nodes[gate]), at_source = drives.group(instance.nodes[source]);
    instance.drive_is_apart = at_source != 0 && at_gate != at_source && !drives.leads_only_to(at_source, at_gate);
  }
}

}  // namespace pwlsim::circuit
