#pragma once
/// Groups of nodes, ground among them.

#include "base/disjoint_sets.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

class NodeGroups {
 public:
  explicit NodeGroups(std::size_t nodes) : sets_(static_cast<int>(nodes) + 1) {}

  /// A number for the group; that of ground is 0.
  [[nodiscard]] int root(model::NodeIndex node) { return sets_.find(node + 1); }
  void join(model::NodeIndex a, model::NodeIndex b) { sets_.join(a + 1, b + 1); }

 private:
  DisjointSets sets_;
};

}  // namespace pwlsim::circuit
