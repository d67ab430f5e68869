#pragma once
/// Classes of linear complementarity problems, and what is known of methods on them.

#include <functional>
#include <string>
#include <vector>

#include "lcp/enumeration.hpp"

namespace pwlsim::test {

enum Promise : unsigned {
  by_lemke = 1,       ///< Lemke's method solves every problem of the class that has a solution
  by_newton = 2,      ///< so does Newton's
  by_least_index = 4  ///< so does the least index (P-matrices)
};

struct ProblemClass {
  std::string name;
  unsigned promised;
  std::function<linalg::Matrix(Problems&, int)> matrix;
  std::function<linalg::Vector(Problems&, const linalg::Matrix&)> right;
};

[[nodiscard]] const std::vector<ProblemClass>& problem_classes();

/// q with which some z ≥ 0 gives w ≥ 0.
[[nodiscard]] linalg::Vector feasible_right(Problems& random, const linalg::Matrix& m);

}  // namespace pwlsim::test
