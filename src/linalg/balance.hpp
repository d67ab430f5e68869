#pragma once
/// Scales that make the rows and columns of a matrix alike (Osborne 1960; Parlett & Reinsch 1969).

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// Powers of two s with which S⁻¹MS has rows and columns of like size; M becomes that. Empty, and M as it was, where its logarithmic norm does not get
/// much smaller by it.
[[nodiscard]] Vector balance(Matrix& m);

}  // namespace pwlsim::linalg
