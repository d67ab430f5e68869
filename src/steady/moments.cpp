#include "steady/moments.hpp"

namespace pwlsim::steady {

using linalg::Matrix;

/// Taylor on h/2^m, then G(2h) = e^{A′h} G + G e^{Y′h}.
Matrix moment_of(const Matrix& a, const Matrix& y, const Matrix& k, double h, double rate) {
  constexpr double reach = 0.5;
  constexpr int terms = 24;  // the rate leaves out what is nilpotent: 2²⁴/24! is below rounding still
  const int doublings = rate * h > reach ? static_cast<int>(std::ceil(std::log2(rate * h / reach))) : 0;
  const double step = std::ldexp(h, -doublings);
  const Matrix at = a.transpose(), yt = y.transpose();
  // Powers of the block matrix (A′ K; 0 Y′).
  Matrix right = k * step, term = right, sum = right;
  for (int j = 2; j <= terms; ++j) {
    right = right * yt * (step / j);
    term = at * term * (step / j) + right;
    sum += term;
  }
  if (doublings == 0) return sum;
  const auto less_identity = [&](const Matrix& m) {
    Matrix power = m * step, x = power;
    for (int j = 2; j <= terms; ++j) {
      power = m * power * (step / j);
      x += power;
    }
    return x;
  };
  Matrix ea = less_identity(at), ey = less_identity(yt);
  for (int d = 0; d < doublings; ++d) {
    sum = Matrix(2.0 * sum + ea * sum + sum * ey);
    ea = Matrix(2.0 * ea + ea * ea);
    ey = Matrix(2.0 * ey + ey * ey);
  }
  return sum;
}

}  // namespace pwlsim::steady
