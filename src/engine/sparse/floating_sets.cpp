#include "engine/sparse/floating_sets.hpp"

#include <cmath>

#include "base/disjoint_sets.hpp"

namespace pwlsim::engine::sparse {

using model::ground;
using model::NodeIndex;

FloatingSets::FloatingSets(const model::Network& network) {
  const auto nodes = static_cast<int>(network.nodes.size());
  static_assert(ground == -1);  // the least of all, so that its set is named by it
  DisjointSets sets(nodes + 1);
  for (const auto& c : network.capacitors) sets.join(c.p + 1, c.n + 1);
  for (int node = 0; node < nodes; ++node) set_.push_back(sets.find(node + 1) - 1);
  std::vector<NodeIndex> row_of(set_.size(), ground);
  for (const auto& branch : network.branches)
    for (const NodeIndex node : {branch.p, branch.n}) {
      const int set = node == ground ? ground : set_[static_cast<std::size_t>(node)];
      if (set != ground && row_of[static_cast<std::size_t>(set)] == ground) row_of[static_cast<std::size_t>(set)] = node;
    }
  for (int& set : set_)
    if (set != ground && row_of[static_cast<std::size_t>(set)] != ground) set = row_of[static_cast<std::size_t>(set)];
}

std::vector<FloatingSets::Cut> FloatingSets::cuts(NodeIndex p, NodeIndex n) const {
  std::vector<Cut> result;
  const auto set = [&](NodeIndex node) { return node == ground ? ground : set_[static_cast<std::size_t>(node)]; };
  const int set_p = set(p), set_n = set(n);
  if (p != ground && p != set_p) result.push_back({p, 1.0});
  if (n != ground && n != set_n) result.push_back({n, -1.0});
  if (set_p == set_n) return result;
  if (set_p != ground) result.push_back({set_p, 1.0});
  if (set_n != ground) result.push_back({set_n, -1.0});
  return result;
}

double FloatingSets::weight(const std::vector<double>& a, std::size_t i) const {
  const int set = i < set_.size() ? set_[i] : ground;
  const bool is_of_node = set != ground && set != static_cast<int>(i);
  return is_of_node ? a[i] - a[static_cast<std::size_t>(set)] : a[i];
}

double FloatingSets::product(const std::vector<double>& a, const std::vector<double>& y) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) sum += weight(a, i) * y[i];
  return sum;
}

double FloatingSets::largest_product(const std::vector<double>& a, const std::vector<double>& y) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) sum += std::abs(weight(a, i) * y[i]);
  return sum;
}

}  // namespace pwlsim::engine::sparse
