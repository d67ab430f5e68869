#pragma once
/// The rational complementarity problem solved by enumeration of all modes in exact integers: for each J the Laplace transforms of
///
///     x' = A x + B u,  y = C x + D u,  y_J = 0,  u_i = 0 elsewhere
///
/// are ratios of determinants (Cramer), polynomials in s found from their values at n + 1 integers by finite differences. The sign of a ratio for
/// large s is that of its leading coefficients. Nothing here rounds, and nothing is shared with the program.

#include <boost/multiprecision/cpp_int.hpp>
#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::test {

using Integer = boost::multiprecision::checked_int512_t;

struct IntegerSystem {
  linalg::Matrix a, b, c, d;  ///< of integers
  [[nodiscard]] int n() const { return static_cast<int>(a.rows()); }
  [[nodiscard]] int k() const { return static_cast<int>(d.rows()); }
};

struct ExactSolution {
  unsigned active = 0, inactive = 0;  ///< bits: u_i > 0 and y_i > 0 for large s; neither: indeterminate
  bool jumps = false;                 ///< u has a polynomial part
  std::vector<Integer> after;         ///< a positive multiple of the state after the jump
  linalg::Vector state_after;
};

struct ExactOutcome {
  bool all_regular = true;  ///< every mode has one solution; else there may be solutions beyond those listed
  std::vector<ExactSolution> solutions;
};

/// `x`: a positive multiple of the state; `scale`: which.
[[nodiscard]] ExactOutcome solve_exactly(const IntegerSystem& system, const std::vector<Integer>& x, double scale = 1.0);

}  // namespace pwlsim::test
