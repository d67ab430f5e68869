#include "model/step_loops.hpp"

#include <algorithm>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "model/forms.hpp"
#include "model/things.hpp"

namespace pwlsim::model {
namespace {

struct Holder {
  int branch = 0;
  NodeIndex p = ground, n = ground;
};

/// The branches that can hold a node: those whose voltage reads neither their own current nor their own nodes.
std::vector<Holder> possible_holders(const Network& network) {
  std::vector<Holder> holders;
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const Branch& b = network.branches[i];
    const auto index = static_cast<int>(i);
    const bool reads_itself = std::any_of(b.voltage.begin(), b.voltage.end(), [&](const Term& term) {
      if (term.kind == Term::Kind::branch_current) return term.index == index;
      return term.kind == Term::Kind::node_voltage && term.index != ground && (term.index == b.p || term.index == b.n);
    });
    if (!reads_itself) holders.push_back({index, b.p, b.n});
  }
  return holders;
}

class Influence {
 public:
  explicit Influence(const Network& network)
      : network_(network),
        things_(network),
        sets_(things_.count),
        holder_(network.nodes.size(), -1),
        held_branch_(network.branches.size(), 0) {
    hold_nodes();
    for_each_terminal(network, things_, [&](int element, NodeIndex node) { terminal(node, element); });
    for (const auto& k : network.couplings) sets_.join(things_.inductor + k.inductor_a, things_.inductor + k.inductor_b);
    branches();
    for (std::size_t i = 0; i < network.injections.size(); ++i)
      reads(network.injections[i].current, things_.injection + static_cast<int>(i));
    for (std::size_t i = 0; i < network.complementarities.size(); ++i)
      reads(network.complementarities[i].slack, things_.complementarity + static_cast<int>(i));
  }

  std::vector<char> loops(const std::vector<Step>& steps) {
    build_lists();
    const std::vector<int> component = components();
    std::vector<char> result;
    for (const Step& step : steps) {
      const int own = component[static_cast<std::size_t>(sets_.find(things_.complementarity + step.first))];
      result.push_back(std::any_of(step.argument.begin(), step.argument.end(), [&](const Term& term) {
        const int thing = things_.of(term);
        return thing >= 0 && component[static_cast<std::size_t>(sets_.find(thing))] == own;
      }));
    }
    return result;
  }

 private:
  void edge(int from, int to) { edges_.emplace_back(from, to); }
  void reads(const LinearForm& form, int reader) {
    for (const Term& term : form)
      if (const int thing = things_.of(term); thing >= 0) edge(thing, reader);
  }
  [[nodiscard]] bool is_held(NodeIndex node) const { return node == ground || holder_[static_cast<std::size_t>(node)] >= 0; }

  void hold_nodes() {
    const std::vector<Holder> holders = possible_holders(network_);
    spread_voltages(
        holders, [&](NodeIndex node) { return is_held(node); },
        [&](const Holder& h, bool from_p) {
          holder_[static_cast<std::size_t>(from_p ? h.n : h.p)] = h.branch;
          return held_branch_[static_cast<std::size_t>(h.branch)] = 1;
        });
  }

  /// An element at a held node reads it, and its current is one of those that the holder carries.
  void terminal(NodeIndex node, int element) {
    if (node == ground) return;
    if (!is_held(node)) {
      sets_.join(element, things_.node + node);
      return;
    }
    edge(things_.node + node, element);
    edge(element, things_.branch + holder_[static_cast<std::size_t>(node)]);
  }

  void branches() {
    for (std::size_t i = 0; i < network_.branches.size(); ++i) {
      const Branch& b = network_.branches[i];
      const int thing = things_.branch + static_cast<int>(i);
      if (held_branch_[i] == 0) {
        terminal(b.p, thing);
        terminal(b.n, thing);
        reads(b.voltage, thing);
        continue;
      }
      const bool holds_p = b.p != ground && holder_[static_cast<std::size_t>(b.p)] == static_cast<int>(i);
      const NodeIndex held = holds_p ? b.p : b.n, from = holds_p ? b.n : b.p;
      reads(b.voltage, things_.node + held);
      if (from == ground) continue;
      edge(things_.node + from, things_.node + held);
      edge(thing, things_.branch + holder_[static_cast<std::size_t>(from)]);
    }
  }

  void build_lists() {
    next_.assign(static_cast<std::size_t>(things_.count), {});
    before_.assign(static_cast<std::size_t>(things_.count), {});
    for (const auto& [from, to] : edges_) {
      const int a = sets_.find(from), b = sets_.find(to);
      if (a == b) continue;
      next_[static_cast<std::size_t>(a)].push_back(b);
      before_[static_cast<std::size_t>(b)].push_back(a);
    }
  }

  /// Strongly connected components: two searches in depth, forwards and then backwards in the order in which the first ended (Kosaraju, Sharir).
  std::vector<int> components() {
    std::vector<int> order;
    std::vector<char> seen(next_.size(), 0);
    for (int i = 0; i < things_.count; ++i)
      search(
          i, next_, [&](int v) { return std::exchange(seen[static_cast<std::size_t>(v)], 1) == 0; }, [&](int v) { order.push_back(v); });
    std::vector<int> component(next_.size(), -1);
    for (auto root = order.rbegin(); root != order.rend(); ++root) {
      const auto take = [&](int v) {
        if (component[static_cast<std::size_t>(v)] >= 0) return false;
        component[static_cast<std::size_t>(v)] = *root;
        return true;
      };
      search(*root, before_, take, [](int) {});
    }
    return component;
  }

  template <class Take, class Leave>
  static void search(int root, const std::vector<std::vector<int>>& lists, const Take& take, const Leave& leave) {
    if (!take(root)) return;
    std::vector<std::pair<int, std::size_t>> path{{root, 0}};
    while (!path.empty()) {
      const int v = path.back().first;
      const auto& list = lists[static_cast<std::size_t>(v)];
      if (path.back().second == list.size()) {
        leave(v);
        path.pop_back();
        continue;
      }
      const int w = list[path.back().second++];
      if (take(w)) path.emplace_back(w, 0);
    }
  }

  const Network& network_;
  const Things things_;
  DisjointSets sets_;
  std::vector<int> holder_;  ///< node -> the branch that holds it, −1: none
  std::vector<char> held_branch_;
  std::vector<std::pair<int, int>> edges_;
  std::vector<std::vector<int>> next_, before_;
};

}  // namespace

std::vector<char> steps_in_loops(const Network& network, const std::vector<Step>& steps) { return Influence(network).loops(steps); }

}  // namespace pwlsim::model
