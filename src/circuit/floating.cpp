#include "circuit/floating.hpp"

#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "circuit/names.hpp"
#include "circuit/node_groups.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Instance;
using model::NodeIndex;

bool ties(const Instance& instance) { return instance.kind->joins_terminals == nullptr || instance.kind->joins_terminals(instance); }

/// A controlled current whose control spans two groups feels their difference of potential, so it may fix it; the rank of the model
/// decides in the end.
bool feels_difference(const Instance& instance, NodeGroups& groups) {
  for (const elements::NodePair& pair : instance.control_nodes) {
    if (groups.root(pair.p) != groups.root(pair.n)) return true;
  }
  return false;
}

void join_many(const Instance& instance, NodeGroups& groups) {
  for (const int terminal : instance.kind->tied_terminals) {
    const auto k = static_cast<std::size_t>(terminal);
    if (k < instance.nodes.size()) groups.join(instance.nodes[0], instance.nodes[k]);
  }
}

void join(const FlatCircuit& circuit, NodeGroups& groups) {
  for (const Instance& instance : circuit.instances) {
    if (instance.nodes.size() == 2 && ties(instance)) groups.join(instance.nodes[0], instance.nodes[1]);
    if (instance.nodes.size() > 2 && instance.kind != nullptr) join_many(instance, groups);
  }
  for (const Instance& instance : circuit.instances) {
    for (const elements::BlockInput& input : instance.inputs)
      if (input.is_current && input.reference < 0) groups.join(input.nodes.p, input.nodes.n);
  }
  for (const Instance& instance : circuit.instances) {
    if (instance.nodes.size() == 2 && !ties(instance) && feels_difference(instance, groups))
      groups.join(instance.nodes[0], instance.nodes[1]);
  }
}

std::string some_names(const FlatCircuit& circuit, const std::vector<std::size_t>& group) {
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t k = 0; k < group.size() && k < most; ++k) text += (k == 0 ? "" : ", ") + circuit.nodes()[group[k]].name;
  if (group.size() > most) text += fmt::format(" and {} more", group.size() - most);
  return text;
}

/// A current that an element does not tie enters or leaves the group.
bool is_fed(const FlatCircuit& circuit, NodeGroups& groups, int root) {
  for (const Instance& instance : circuit.instances) {
    if (instance.nodes.size() != 2 || ties(instance)) continue;
    const int a = groups.root(instance.nodes[0]), b = groups.root(instance.nodes[1]);
    if (a != b && (a == root || b == root)) return true;
  }
  return false;
}

/// By node: whether some element has a terminal there. The others are only read, by a switch or an expression.
std::vector<char> touched_nodes(const FlatCircuit& circuit) {
  std::vector<char> touched(circuit.nodes().size(), 0);
  const auto touch = [&](NodeIndex node) {
    if (node != model::ground) touched[static_cast<std::size_t>(node)] = 1;
  };
  for (const Instance& instance : circuit.instances) {
    for (const NodeIndex node : instance.nodes) touch(node);
    for (const elements::BlockInput& input : instance.inputs) {
      if (!input.is_current) continue;
      touch(input.nodes.p);
      touch(input.nodes.n);
    }
  }
  return touched;
}

void report_untouched(const FlatCircuit& circuit, const std::vector<char>& touched, std::size_t node, Reporter& reporter) {
  const model::Label& label = circuit.nodes()[node];
  std::vector<std::string> others;
  for (const std::string& name : NameIndex(circuit).node_names())
    if (const auto index = circuit.find_node(name); index && *index != model::ground && touched[static_cast<std::size_t>(*index)] != 0)
      others.push_back(name);
  const std::string nearest = suggestion(label.name, others);
  reporter.error("E-floating", label.span,
                 fmt::format("the node {} is only read: no element connects to it{}", label.name,
                             nearest.empty() ? "; try the name of another node, or a source from it to 0" : nearest));
}

}  // namespace

std::vector<NodeIndex> report_floating(const FlatCircuit& circuit, Reporter& reporter) {
  std::vector<NodeIndex> to_tie;
  NodeGroups groups(circuit.nodes().size());
  join(circuit, groups);
  std::map<int, std::vector<std::size_t>> floating;
  for (std::size_t k = 0; k < circuit.nodes().size(); ++k) {
    if (const int root = groups.root(static_cast<NodeIndex>(k)); root != 0) floating[root].push_back(k);
  }
  const std::vector<char> touched = touched_nodes(circuit);
  for (const auto& [root, group] : floating) {
    if (!circuit.written_by_ltspice && group.size() == 1 && touched[group[0]] == 0) {
      report_untouched(circuit, touched, group[0], reporter);
      continue;
    }
    const model::Label& first = circuit.nodes()[group[0]];
    const std::string who =
        group.size() == 1 ? fmt::format("the node {} has", first.name) : fmt::format("the nodes {} have", some_names(circuit, group));
    if (circuit.written_by_ltspice && !is_fed(circuit, groups, root)) {
      reporter.warning(
          "W-floating", first.span,
          fmt::format("{0} no path to ground, and {1} is tied to it, as LTspice's smallest conductances do; try a resistor from {1} to 0",
                      who, first.name));
      to_tie.push_back(static_cast<NodeIndex>(group[0]));
    } else {
      reporter.error("E-floating", first.span, fmt::format("{} no path to ground; try a resistor from {} to 0", who, first.name));
    }
  }
  return to_tie;
}

}  // namespace pwlsim::circuit
