#pragma once
/// Chooses the given quantity of each port.

#include "linalg/dense.hpp"

namespace pwlsim::model {

/// Θ = diag(±1) such that S + Θ (k × k) is eliminated with large pivots: the largest first, each with the sign of the entry that it is added to. For a
/// passive S every pivot is then one at least. `given`: signs of ports that have them already, 0 elsewhere. Pivots that differ by less than `tie` of
/// themselves count as equal, and the first is taken.
[[nodiscard]] linalg::WideVector causality(linalg::WideMatrix s, const linalg::WideVector& given, double tie = 0.0);

}  // namespace pwlsim::model
