#pragma once
/// Solvers of the linear complementarity problem in turn, each answer assessed by its residuals.

#include "lcp/problem.hpp"

namespace pwlsim::lcp {

/// In the order in which they are tried.
enum class Method {
  none,  ///< no solver answered
  lemke,
  newton_min,
  least_index,
  regularised,  ///< Lemke for M + 10⁻⁸, its basis then solved with M: where rounding left a singular problem without a solution
  enumeration   ///< of all bases, smaller ones first; only of up to ten ports that nothing is known of
};

struct Answer {
  Status status = Status::solved;  ///< of no solver: `ray` where Lemke ended so
  Method method = Method::none;
  linalg::Vector z, w;     ///< w_i or z_i is exactly zero at every port
  std::vector<int> basis;  ///< of the solver that answered
  int pivots = 0;          ///< of all solvers tried
  Assessment assessment;   ///< of the diagonally scaled problem, by recomputation from z
};

/// Residuals (Assessment::worst of the diagonally scaled problem) above this are no solution.
inline constexpr double acceptable_residual = 1e-10;  ///< Of: the scaled data. Why: answers in double have residuals near 1e-15.

[[nodiscard]] Answer solve(const linalg::Matrix& m, const linalg::Vector& q);

}  // namespace pwlsim::lcp
