#pragma once
/// Solves linear equations to the last place of extended precision, also if they are badly conditioned.

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// X (m × columns of `right`) with (G + G_rest) X = right, regular (m × m): G_rest are the rounding errors of the entries of G, and `inverse` is an
/// approximate inverse. Residuals are summed in twice the digits, so that refinement ends at the rounding of X itself as long as cond(G) is
/// well below the reciprocal rounding of extended precision (Higham 2002, Accuracy and Stability of Numerical Algorithms, §12.1). An entry that
/// the last refinement may still change entirely is zero in exact arithmetic, and zero here.
[[nodiscard]] WideMatrix refined_solution(const WideMatrix& g, const WideMatrix& g_rest, const WideMatrix& inverse,
                                          const WideMatrix& right);

}  // namespace pwlsim::linalg
