#pragma once
/// Tries solvers of the linear complementarity problem in turn and assesses each answer by its residuals.

#include "lcp/problem.hpp"

namespace pwlsim::lcp {

/// In the order in which they are tried.
enum class Method {
  none,  ///< no solver answered
  lemke,
  newton_min,
  least_index,
  regularised,  ///< Lemke for M + 10⁻⁸, then its basis with M: for a singular problem that rounding left without a solution
  enumeration   ///< of all bases, smaller ones first; only for up to ten ports without a known class
};

struct AssessedSolution {
  Status status = Status::solved;  ///< if no solver answered: `ray` if Lemke's method ended so
  Method method = Method::none;
  linalg::Vector z, w;     ///< w_i or z_i is exactly zero at every port
  std::vector<int> basis;  ///< of the solver that answered
  int pivots = 0;          ///< of all solvers tried
  Assessment assessment;   ///< of the diagonally scaled problem, by recomputation from z
};

/// An answer with a residual (Assessment::worst of the diagonally scaled problem) above this is not a solution.
inline constexpr double acceptable_residual = 1e-10;  ///< Of: the scaled data. Why: answers in double have residuals near 1e-15.

[[nodiscard]] AssessedSolution solve(const linalg::Matrix& m, const linalg::Vector& q);

}  // namespace pwlsim::lcp
