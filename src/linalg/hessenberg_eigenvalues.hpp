#pragma once
/// Eigenvalues of a matrix that is zero below its first subdiagonal, without vectors: by double steps of QR on what is left of it (Martin, Peters and Wilkinson, Numer. Math. 14 (1970)).

#include <complex>
#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// Empty where they do not converge.
[[nodiscard]] std::vector<std::complex<double>> hessenberg_eigenvalues(Matrix h);

}  // namespace pwlsim::linalg
