#pragma once
/// Eigenvalues of a matrix that is zero below its first subdiagonal, without vectors.

#include <complex>
#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// Empty where they do not converge.
[[nodiscard]] std::vector<std::complex<double>> hessenberg_eigenvalues(const Matrix& h);

}  // namespace pwlsim::linalg
