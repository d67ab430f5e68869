#pragma once
/// Scales that make the rows and columns of a matrix equally large (Osborne 1960; Parlett & Reinsch 1969).

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// Powers of two s for which rows and columns of S⁻¹MS have similar norms; M becomes that matrix, and `growth`, its logarithmic norm, that of it. Empty, with both unchanged, if that does not
/// become much smaller.
[[nodiscard]] Vector balance(Matrix& m, double& growth);

}  // namespace pwlsim::linalg
