#pragma once
/// Diodes that conduct only while one of their switches is closed (Diode::enabled_by): otherwise they block at any voltage.
///
/// With its switches open such a port is not a complementarity but an open contact: its current is zero, and no sign condition ends this. In a set of active
/// ports it is on its blocking side; in a mode its guard is identically zero.

#include <vector>

#include "model/index_set.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

/// The ports that block in the position of the switches that the set holds.
[[nodiscard]] std::vector<int> blocked_ports(const System& system, const IndexSet& set);

/// These ports on the side on which they block.
void hold_blocked(const System& system, IndexSet& set);

/// Of M z + q and 0 ≤ z ⊥ M z + q ≥ 0, ports whose z is zero for any values of the others.
template <class Matrix, class Vector>
void take_out(const std::vector<int>& ports, Matrix& m, Vector& q) {
  for (const int i : ports) {
    m.row(i).setZero();
    m.col(i).setZero();
    m(i, i) = 1;
    q[i] = 1;
  }
}

}  // namespace pwlsim::model
