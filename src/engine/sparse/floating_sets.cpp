#include "engine/sparse/floating_sets.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

using model::ground;
using model::NodeIndex;

namespace {

/// What joins two nodes, and how strongly: a capacitance, or a conductance.
struct Join {
  NodeIndex p, n;
  double strength;
};

/// Joins nodes by ever smaller capacitors, and what these join by ever larger resistors; at rest the other way round.
class SetBuilder {
 public:
  SetBuilder(const model::Network& network, double r0, bool at_rest)
      : sets_(static_cast<int>(network.nodes.size()) + 1),
        groups_(network.nodes.size() + 1),
        beyond_(network.nodes.size(), ground),
        at_source_(network.nodes.size(), 0) {
    static_assert(ground == -1);  // the least of all, so that its set is named by it
    for (const auto& branch : network.branches)
      for (const NodeIndex node : {branch.p, branch.n})
        if (node != ground) at_source_[static_cast<std::size_t>(node)] = 1;
    for (NodeIndex node = 0; node < static_cast<NodeIndex>(network.nodes.size()); ++node) group(node).rows = {node};
    if (!at_rest) join_capacitors(network);
    join_others(network, r0);
    if (at_rest) join_capacitors(network);
  }
  [[nodiscard]] std::vector<int> take() { return std::move(beyond_); }

 private:
  /// What is joined so far, with rows of its own; `first` those two that the largest capacitor between them joins.
  struct Group {
    std::vector<int> rows;
    std::pair<int, int> first{ground, ground};
    double largest = 0.0;
  };
  void join_capacitors(const model::Network& network) {
    std::vector<Join> joins;
    for (const auto& c : network.capacitors) joins.push_back({c.p, c.n, std::abs(c.capacitance)});
    join_strongest_first(joins, tolerance::small_capacitor);
    close_all();
  }

  void join_others(const model::Network& network, double r0) {
    std::vector<Join> joins;
    for (const auto& branch : network.branches) joins.push_back({branch.p, branch.n, 1.0 / r0});
    for (const auto& l : network.inductors) joins.push_back({l.p, l.n, 1.0 / r0});
    for (const auto& r : network.resistors) joins.push_back({r.p, r.n, 1.0 / std::abs(r.resistance)});
    join_strongest_first(joins, tolerance::small_conductance);
    close_all();
  }

  [[nodiscard]] Group& group(NodeIndex node) { return groups_[static_cast<std::size_t>(sets_.find(node + 1))]; }

  /// `small`: of the strongest that joins a set, the part below which it is closed first.
  void join_strongest_first(std::vector<Join>& joins, double small) {
    std::stable_sort(joins.begin(), joins.end(), [](const Join& a, const Join& b) { return a.strength > b.strength; });
    for (const auto& [p, n, strength] : joins) {
      if (sets_.find(p + 1) != sets_.find(n + 1))
        for (const NodeIndex node : {p, n})
          if (strength < small * group(node).largest) close(group(node));
      const std::pair<int, int> rows{outermost(p), outermost(n)};
      Group& both = join(p, n);
      if (both.largest > 0.0) continue;
      both.largest = strength;
      both.first = rows;
    }
  }

  Group& join(NodeIndex p, NodeIndex n) {
    if (sets_.find(p + 1) == sets_.find(n + 1)) return group(p);
    Group a = std::move(group(p)), b = std::move(group(n));
    sets_.join(p + 1, n + 1);
    Group& both = group(p);
    if (a.largest < b.largest) std::swap(a, b);
    both = std::move(a);
    both.rows.insert(both.rows.end(), b.rows.begin(), b.rows.end());
    return both;
  }

  void close_all() {
    for (NodeIndex node = 0; node < static_cast<NodeIndex>(beyond_.size()); ++node)
      if (sets_.find(node + 1) == node + 1) close(group(node));
  }

  /// The row of the largest set around a node so far.
  [[nodiscard]] int outermost(int row) const {
    while (row != ground && beyond_[static_cast<std::size_t>(row)] != ground) row = beyond_[static_cast<std::size_t>(row)];
    return row;
  }

  /// From now on one row stands for all of it. Ground has none, and the others keep theirs.
  void close(Group& closed) {
    const bool is_grounded = &closed == &groups_.front();
    if (!is_grounded && closed.rows.size() > 1) {
      const auto source =
          std::find_if(closed.rows.begin(), closed.rows.end(), [&](int row) { return at_source_[static_cast<std::size_t>(row)] != 0; });
      const int whole = source != closed.rows.end() ? *source : std::min(closed.first.first, closed.first.second);
      for (const int row : closed.rows)
        if (row != whole) beyond_[static_cast<std::size_t>(row)] = whole;
      closed.rows = {whole};
    }
    closed.largest = 0.0;
  }

  DisjointSets sets_;  ///< of nodes + 1
  std::vector<Group> groups_;
  std::vector<int> beyond_;
  std::vector<char> at_source_;  ///< row -> whether its set has a node at a voltage source
};

}  // namespace

FloatingSets::FloatingSets(const model::Network& network, double r0, bool at_rest) : beyond_(SetBuilder(network, r0, at_rest).take()) {}

std::vector<FloatingSets::Cut> FloatingSets::cuts(NodeIndex p, NodeIndex n) const {
  std::vector<Cut> result;
  const auto holds = [&](NodeIndex node, int row) {
    while (node != ground && node != row) node = beyond(node);
    return node == row;
  };
  for (int row = p; row != ground; row = beyond(row))
    if (!holds(n, row)) result.push_back({row, 1.0});
  for (int row = n; row != ground; row = beyond(row))
    if (!holds(p, row)) result.push_back({row, -1.0});
  return result;
}

double FloatingSets::weight(const std::vector<double>& a, std::size_t i) const {
  const int set = i < beyond_.size() ? beyond_[i] : ground;
  return set != ground ? a[i] - a[static_cast<std::size_t>(set)] : a[i];
}

}  // namespace pwlsim::engine::sparse
