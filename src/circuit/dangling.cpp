#include "circuit/dangling.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/names.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Instance;
using model::NodeIndex;

constexpr std::size_t least_letters = 3;  ///< of shorter ones each is nearly another

/// How often each node is touched or read. What is saved or measured counts, too.
std::vector<int> uses(const FlatCircuit& circuit) {
  std::vector<int> count(circuit.nodes().size(), 0);
  const auto add = [&](NodeIndex node) {
    if (node != model::ground) ++count[static_cast<std::size_t>(node)];
  };
  for (const Instance& instance : circuit.instances) {
    for (const NodeIndex node : instance.nodes) add(node);
    for (const elements::NodePair& pair : instance.control_nodes) add(pair.p), add(pair.n);
    for (const elements::BlockInput& input : instance.inputs) add(input.nodes.p), add(input.nodes.n);
  }
  for (const auto* requests : {&circuit.saves, &circuit.probes}) {
    for (const SaveRequest& request : *requests)
      for (const std::string& name : {request.first, request.second})
        if (const auto node = circuit.find_node(name)) add(*node);
  }
  return count;
}

/// N001 and N002 are two nodes, whatever else they are.
std::string without_digits(std::string_view name) {
  std::string letters = without_case(name);
  letters.erase(std::remove_if(letters.begin(), letters.end(), [](char c) { return c >= '0' && c <= '9'; }), letters.end());
  return letters;
}

/// "; try 'out'", or "" where no other name is near.
std::string nearest_other(const std::string& name, const std::vector<std::string>& names) {
  std::vector<std::string> others;
  for (const std::string& other : names)
    if (without_digits(other) != without_digits(name)) others.push_back(other);
  return suggestion(name, others);
}

bool may_hang(const Instance& instance) {
  return instance.kind != nullptr && instance.nodes.size() == 2 && instance.name.find('.') == std::string::npos &&
         std::string_view("RCLDS").find(instance.kind->letter) != std::string_view::npos;
}

}  // namespace

void warn_of_dangling(const FlatCircuit& circuit, Reporter& reporter) {
  const std::vector<int> count = uses(circuit);
  std::vector<std::string> connected;
  for (const std::string& name : NameIndex(circuit).node_names())
    if (const auto node = circuit.find_node(name); node && *node != model::ground && count[static_cast<std::size_t>(*node)] > 1)
      connected.push_back(name);
  for (const Instance& instance : circuit.instances) {
    if (!may_hang(instance)) continue;
    for (const NodeIndex node : instance.nodes) {
      if (node == model::ground) continue;
      const model::Label& label = circuit.nodes()[static_cast<std::size_t>(node)];
      const bool hangs = count[static_cast<std::size_t>(node)] == 1 && label.name.size() >= least_letters;
      const std::string nearest = hangs ? nearest_other(label.name, connected) : "";
      if (!nearest.empty())
        reporter.warning("W-dangling", label.span,
                         fmt::format("{} carries no current: nothing else connects to the node {}{}", instance.name, label.name, nearest));
    }
  }
}

bool hangs_alone(const FlatCircuit& circuit, std::string_view node) {
  const auto found = circuit.find_node(node);
  return found && *found != model::ground && uses(circuit)[static_cast<std::size_t>(*found)] == 1;
}

}  // namespace pwlsim::circuit
