#pragma once
/// Solvers of the linear complementarity problem in turn, each answer assessed by its residuals.

#include "lcp/monotone.hpp"
#include "lcp/problem.hpp"

namespace pwlsim::lcp {

/// In the order in which they are tried.
enum class Method {
  none,        ///< no solver answered
  warm_lemke,  ///< principal pivot transform to the previous active set, then Lemke; only with such a set
  lemke,
  newton_min,
  least_index,
  regularised,  ///< Lemke for M + 10⁻⁸, its basis then solved with M: where rounding left a singular problem without a solution
  enumeration   ///< of all bases, smaller ones first; only of up to ten ports that nothing is known of
};

/// What is known of M beforehand.
enum class Class {
  general,
  monotone  ///< positive semidefinite: the answer is the least-norm one, with what is indeterminate in it
};

struct Answer {
  Status status = Status::solved;  ///< of no solver: `ray` where Lemke ended so, for a monotone problem: none exists
  Method method = Method::none;
  linalg::Vector z, w;                           ///< w_i or z_i is exactly zero at every port
  std::vector<int> basis;                        ///< of the solver that answered; z may have been moved to the least norm after it
  int pivots = 0;                                ///< of all solvers tried
  Assessment assessment;                         ///< of the diagonally scaled problem, by recomputation from z
  bool least_norm = false;                       ///< z, w is the solution of least |z|² + |w|² (or the only one)
  bool determined = true;                        ///< false: solutions differ; only ever false for Class::monotone, where it was examined
  std::vector<char> z_determined, w_determined;  ///< Class::monotone: port by port (a branch current, a floating voltage)
};

/// Residuals (Assessment::worst of the diagonally scaled problem) above this are no solution.
inline constexpr double acceptable_residual = 1e-10;  ///< Of: the scaled data. Why: answers in double have residuals near 1e-15.

/// `previous`: active set of an earlier, similar problem (ascending), or none.
[[nodiscard]] Answer solve(const linalg::Matrix& m, const linalg::Vector& q, Class problem_class = Class::general,
                           const std::vector<int>* previous = nullptr);

}  // namespace pwlsim::lcp
