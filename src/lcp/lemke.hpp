#pragma once
/// The linear complementarity problem: find z with  w = M z + q,  0 ≤ w ⊥ z ≥ 0.

#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::lcp {

enum class Status {
  solved,
  ray,          ///< no solution along Lemke's path; for positive semidefinite M: none exists
  pivot_limit   ///< gave up; the path is longer than any seen for the classes in use
};

struct Solution {
  Status status = Status::solved;
  linalg::Vector z, w;
  std::vector<int> basis;  ///< indices j with z_j basic in the final tableau (M_basis nonsingular), ascending
  int pivots = 0;
};

/// Lexicographic Lemke (Cottle–Pang–Stone, Algorithms 4.4.5 and 4.9.3), covering vector of ones. M: k×k, q: k.
/// Terminates with a solution for P and for feasible positive semidefinite M (no cycling: ties are broken
/// lexicographically). Pivots below 1e-11 of the scaled tableau count as zero.
[[nodiscard]] Solution lemke(const linalg::Matrix& m, const linalg::Vector& q);

/// Independent residual of a claimed solution: max_i of |min(z_i, w_i)|, w recomputed as M z + q,
/// relative to max(|q|, |M||z|).
[[nodiscard]] double residual(const linalg::Matrix& m, const linalg::Vector& q, const linalg::Vector& z);

}  // namespace pwlsim::lcp
