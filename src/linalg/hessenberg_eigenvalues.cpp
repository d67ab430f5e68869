#include "linalg/hessenberg_eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace pwlsim::linalg {

std::vector<std::complex<double>> hessenberg_eigenvalues(const Matrix& h) {
  std::vector<std::complex<double>> values;
  const Eigen::Index n = h.rows();
  if (n == 0 || !h.allFinite()) return values;
  Eigen::RealSchur<Matrix> schur(n);
  schur.computeFromHessenberg(h, Matrix(), false);
  if (schur.info() != Eigen::Success) return values;
  const Matrix& t = schur.matrixT();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i + 1 == n || t(i + 1, i) == 0.0) {
      values.emplace_back(t(i, i));
      continue;
    }
    const double half = 0.5 * (t(i, i) - t(i + 1, i + 1)), middle = t(i + 1, i + 1) + half;
    const std::complex<double> apart = std::sqrt(std::complex<double>(half * half + t(i, i + 1) * t(i + 1, i)));
    values.push_back(middle + apart);
    values.push_back(middle - apart);
    ++i;
  }
  return values;
}

}  // namespace pwlsim::linalg
