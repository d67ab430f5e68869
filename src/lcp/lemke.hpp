#pragma once
/// Lemke's method for the linear complementarity problem.

#include "lcp/problem.hpp"

namespace pwlsim::lcp {

/// Lexicographic Lemke (Cottle–Pang–Stone, Algorithms 4.4.5 and 4.9.3), covering vector of ones. M: k×k, q: k.
/// Terminates with a solution for P and for feasible positive semidefinite M (no cycling: ties are broken
/// lexicographically). Pivots below 1e-11 of the scaled tableau count as zero.
[[nodiscard]] Solution lemke(const linalg::Matrix& m, const linalg::Vector& q);

/// The same in extended precision: pivots below 1e-15.
[[nodiscard]] Solution lemke_wide(const linalg::WideMatrix& m, const linalg::WideVector& q);

}  // namespace pwlsim::lcp
