#pragma once
/// The linear complementarity problem of diodes beside switches whose positions are given: y = M u + q with 0 ≤ u ⊥ y ≥ 0 at the diodes, which
/// come first, u = 0 at open switch ports, y = 0 with u free at active ones.

#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::model {

struct PortProblem {
  linalg::Matrix m;
  linalg::Vector q;
};

/// The problem of the first `diodes` ports once the switch ports `active` have been solved out, where their own block allows it. Else each stays
/// as u = u⁺ − u⁻ with ±y ≥ 0, behind the diodes, which keeps the problem complementary (and monotone when it was).
[[nodiscard]] PortProblem without_switches(const PortProblem& problem, int diodes, const std::vector<int>& active);

}  // namespace pwlsim::model
