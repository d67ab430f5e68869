#pragma once
/// Condition of a factorised matrix.

#include "linalg/dense.hpp"
#include "linalg/factorisations.hpp"

namespace pwlsim::lcp {

/// Estimated reciprocal condition number in the 1-norm. A pivot of exactly zero, on which Eigen's estimate is not a number, gives 0.
[[nodiscard]] inline double reciprocal_condition(const Eigen::PartialPivLU<linalg::Matrix>& lu) {
  return lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0.0 ? lu.rcond() : 0.0;
}

}  // namespace pwlsim::lcp
