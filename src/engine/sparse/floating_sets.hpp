#pragma once
/// Sets of nodes that capacitors join, with little or nothing of them to what is outside: what leaves such a set drowns beside C/h in each node's own equation, in the
/// rounding of charges. One row of the set holds Kirchhoff's current law of the whole set instead, in which the capacitors between its nodes do not count. Sets are nested: the
/// larger capacitors join a set, far smaller ones join such sets. All else that joins nodes does the same with these sets, but for resistors that are far larger than those within: in the equations
/// of the nodes such a leak, which alone may hold their potential, drowns in the rounding of what flows between them. Where capacitors are nearly open, in the long steps to an operating point, all
/// else joins sets first: a leak alone charges a capacitor then, through its series resistance.
///
/// The law that is left out, of one node or one set within, follows from the others, so that their rounding ends there: it is that of the largest capacitor, or of the smallest resistor.
/// The row has an entry for all that leaves the set, and must not become a pivot early. So it is that of a node at a voltage source, if there is one: the source's
/// current is in no other row of the set, so that the row is eliminated with it (a block of its own where the source's other end is ground).

#include <cstddef>
#include <vector>

#include "model/network.hpp"

namespace pwlsim::engine::sparse {

class FloatingSets {
 public:
  /// `r0`: a typical resistance, ohms; what has a current of its own joins as much. `at_rest`: capacitors are nearly open.
  FloatingSets(const model::Network& network, double r0, bool at_rest);

  /// A row of Kirchhoff's current law in which a current from node p to node n counts, and its sign there.
  struct Cut {
    int row;
    double sign;
  };
  [[nodiscard]] std::vector<Cut> cuts(model::NodeIndex p, model::NodeIndex n) const;
  /// What y_i counts with in aᵀ y, y in rows as these, as if no row were that of a set.
  [[nodiscard]] double weight(const std::vector<double>& a, std::size_t i) const;

 private:
  [[nodiscard]] int beyond(int row) const { return row < 0 ? row : beyond_[static_cast<std::size_t>(row)]; }

  /// Row -> the row of the next larger set around its node or set; ground: none. A node is in the sets of its own row, of the next, and so on.
  std::vector<int> beyond_;
};

}  // namespace pwlsim::engine::sparse
