#include "model/certificate.hpp"

#include <cmath>

namespace pwlsim::model {

double kyp_residual(const System& system) {
  const int n = system.n;
  const int k = system.ports;
  const Matrix a = system.time_scale * system.a.topLeftCorner(n, n);
  const Matrix b = system.time_scale * system.b.topRows(n);
  const Matrix c = system.c.leftCols(n);
  Matrix kyp(n + k, n + k);
  kyp.topLeftCorner(n, n) = a + a.transpose();
  kyp.topRightCorner(n, k) = b - c.transpose();
  kyp.bottomLeftCorner(k, n) = b.transpose() - c;
  kyp.bottomRightCorner(k, k) = -(system.d + system.d.transpose());
  const double rate = linalg::spectral_norm(a);
  if (rate > 0.0) {
    kyp.topRows(n) /= std::sqrt(rate);
    kyp.leftCols(n) /= std::sqrt(rate);
  }
  return linalg::logarithmic_norm(kyp);
}

}  // namespace pwlsim::model
