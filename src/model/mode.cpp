#include "model/mode.hpp"

namespace pwlsim::model {

void to_mode(const System& system, const Mode& mode, const double* x, double* y) {
  const int n = system.n;
  const int nz = system.n_zeta;
  if (!mode.constrained) {
    linalg::copy(x, n + nz, y);
    return;
  }
  linalg::copy(x + n, nz, y + mode.n1);
  // Nᵀ R = 0, so that c = Nᵀ ξ.
  for (int j = 0; j < mode.n1; ++j) {
    const double* column = mode.basis.data() + static_cast<Eigen::Index>(j) * n;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += column[i] * x[i];
    y[j] = sum;
  }
}

void from_mode(const System& system, const Mode& mode, const double* y, double* x) {
  const int n = system.n;
  const int nz = system.n_zeta;
  if (!mode.constrained) {
    linalg::copy(y, n + nz, x);
    return;
  }
  linalg::multiply_two(mode.basis, y, mode.lift, y + mode.n1, x);
  linalg::copy(y + mode.n1, nz, x + n);
}

}  // namespace pwlsim::model
