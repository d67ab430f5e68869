#pragma once
/// Newton's method for min(z, w) = 0, w = M z + q: the active set changes at all indices with a wrong sign at once.
///
/// Converges in at most k + 1 steps for M-matrices (Aganagić 1984), mostly in fewer than ten; on P-matrices with k ≥ 3 it can cycle
/// (Ben Gharbia and Gilbert, INRIA RR-7160), which the set of visited bases detects.

#include "lcp/problem.hpp"

namespace pwlsim::lcp {

/// Starts from the active set `start`. Status: solved, cycle, singular (a basis met), pivot_limit (k + 10 steps).
[[nodiscard]] Solution newton_min(const linalg::Matrix& m, const linalg::Vector& q, const std::vector<int>& start = {});

}  // namespace pwlsim::lcp
