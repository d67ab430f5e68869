#pragma once
/// Sets of nodes that only capacitors join, with nothing of them at ground: their leaks drown beside C/h in each node's own equation. The row of one node of such
/// a set holds Kirchhoff's current law of the whole set instead, in which the capacitors between its nodes do not count.
///
/// That row has an entry for all that leaves the set, and must not become a pivot early. It is that of a node at a voltage source, if there is one: the source's
/// current is in no other row of the set, so that the row is eliminated with it (a block of its own where the source's other end is ground).

#include <cstddef>
#include <vector>

#include "model/network.hpp"

namespace pwlsim::engine::sparse {

class FloatingSets {
 public:
  explicit FloatingSets(const model::Network& network);

  /// A row of Kirchhoff's current law in which a current from node p to node n counts, and its sign there.
  struct Cut {
    int row;
    double sign;
  };
  [[nodiscard]] std::vector<Cut> cuts(model::NodeIndex p, model::NodeIndex n) const;
  /// aᵀ y with y in rows as these, as if no row were that of a set.
  [[nodiscard]] double product(const std::vector<double>& a, const std::vector<double>& y) const;
  /// The most it can be where y has any signs.
  [[nodiscard]] double largest_product(const std::vector<double>& a, const std::vector<double>& y) const;

 private:
  /// What y_i counts with.
  [[nodiscard]] double weight(const std::vector<double>& a, std::size_t i) const;

  std::vector<int> set_;  ///< node -> the node whose row holds the law of its set, ground: none
};

}  // namespace pwlsim::engine::sparse
