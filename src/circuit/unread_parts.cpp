#include "circuit/unread_parts.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "circuit/names.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Instance;
using model::NodeIndex;

/// Nodes that elements join, ground apart.
class Islands {
 public:
  explicit Islands(const FlatCircuit& circuit) : sets_(static_cast<int>(circuit.nodes().size())) {
    for (const Instance& instance : circuit.instances) {
      std::vector<NodeIndex> nodes = instance.nodes;
      for (const elements::BlockInput& input : instance.inputs)
        if (input.is_current) nodes.insert(nodes.end(), {input.nodes.p, input.nodes.n});
      std::erase(nodes, model::ground);
      for (const NodeIndex node : nodes) sets_.join(node, nodes.front());
    }
  }

  [[nodiscard]] int of(NodeIndex node) { return node == model::ground ? -1 : sets_.find(node); }
  /// Of the first terminal that is not ground; -1: none.
  [[nodiscard]] int of(const Instance& instance) {
    for (const NodeIndex node : instance.nodes)
      if (node != model::ground) return of(node);
    return -1;
  }

 private:
  DisjointSets sets_;
};

class UnreadSearch {
 public:
  UnreadSearch(FlatCircuit& circuit, const std::vector<int>& sources)
      : circuit_(circuit), sources_(sources.begin(), sources.end()), islands_(circuit) {}

  std::vector<UnreadPart> run() {
    for (const int source : sources_) unread_.insert(islands_.of(instance(source)));
    unread_.erase(-1);
    keep_what_cards_name();
    for (std::size_t k = 0; k < circuit_.instances.size(); ++k)
      if (!is_plain(static_cast<int>(k))) unread_.erase(islands_.of(circuit_.instances[k]));
    while (keep_what_others_read()) {
    }
    return anything_stays() ? leave_out() : std::vector<UnreadPart>{};
  }

 private:
  Instance& instance(int k) { return circuit_.instances[static_cast<std::size_t>(k)]; }

  /// A part that only shows something holds resistors and capacitors besides its source.
  bool is_plain(int k) {
    const elements::Kind* kind = instance(k).kind;
    return sources_.contains(k) || (kind != nullptr && (kind->letter == 'R' || kind->letter == 'C') && instance(k).nodes.size() == 2);
  }

  void keep_what_cards_name() {
    const NameIndex names(circuit_);
    const auto keep = [&](const std::string& name) {
      if (name.empty()) return;
      if (const auto node = names.node(name)) unread_.erase(islands_.of(*node));
      if (const int element = names.element(name); element >= 0) unread_.erase(islands_.of(instance(element)));
    };
    for (const auto* requests : {&circuit_.saves, &circuit_.probes})
      for (const SaveRequest& request : *requests) keep(request.first), keep(request.second);
    for (const InitialCondition& condition : circuit_.conditions) keep(condition.name);
  }

  bool keep_what_others_read() {
    bool changed = false;
    for (const Instance& each : circuit_.instances) {
      if (unread_.contains(islands_.of(each))) continue;
      const auto keep = [&](int island) { changed |= unread_.erase(island) > 0; };
      for (const elements::NodePair& pair : each.control_nodes) keep(islands_.of(pair.p)), keep(islands_.of(pair.n));
      for (const elements::BlockInput& input : each.inputs) keep(islands_.of(input.nodes.p)), keep(islands_.of(input.nodes.n));
      for (const elements::Reference& reference : each.references)
        if (reference.index >= 0) keep(islands_.of(instance(reference.index)));
    }
    return changed;
  }

  bool anything_stays() {
    return std::any_of(circuit_.instances.begin(), circuit_.instances.end(),
                       [&](const Instance& each) { return !unread_.contains(islands_.of(each)); });
  }

  std::vector<UnreadPart> leave_out() {
    std::vector<UnreadPart> left_out;
    for (const int source : sources_) {
      const int island = islands_.of(instance(source));
      if (!unread_.contains(island)) continue;
      UnreadPart part{source, {}, {}};
      for (std::size_t k = 0; k < circuit_.nodes().size(); ++k) {
        const auto node = static_cast<NodeIndex>(k);
        if (islands_.of(node) != island) continue;
        part.nodes.push_back(circuit_.nodes()[k].name);
        circuit_.unread_nodes.insert(node);
      }
      for (const Instance& each : circuit_.instances)
        if (islands_.of(each) == island && &each != &instance(source)) part.elements.push_back(each.name);
      instance(source).formula = elements::Formula{};
      left_out.push_back(std::move(part));
    }
    return left_out;
  }

  FlatCircuit& circuit_;
  std::set<int> sources_, unread_;
  Islands islands_;
};

}  // namespace

std::vector<UnreadPart> leave_out_unread(FlatCircuit& circuit, const std::vector<int>& sources) {
  return UnreadSearch(circuit, sources).run();
}

}  // namespace pwlsim::circuit
