#pragma once
/// Linear equations solved to the last place of extended precision, however badly conditioned they are within reason.

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// X (m × columns of `right`) with (G + G_rest) X = right, regular (m × m): G_rest is what rounding left of the entries of G, and `inverse` an
/// approximate inverse. Residuals are summed in twice the digits, so that refinement ends at the rounding of X itself as long as cond(G) is
/// well below the reciprocal rounding of extended precision (Higham 2002, Accuracy and Stability of Numerical Algorithms, §12.1). An entry that
/// the last refinement may still change as a whole is zero in exact arithmetic, and zero here.
[[nodiscard]] WideMatrix refined_solution(const WideMatrix& g, const WideMatrix& g_rest, const WideMatrix& inverse,
                                          const WideMatrix& right);

}  // namespace pwlsim::linalg
