#include "linalg/balance.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::linalg {

namespace {

constexpr int most_rounds = 12;
constexpr double largest_exponent = 30.0;  ///< of a scale
constexpr double worthwhile = 0.5;         ///< part of the logarithmic norm that may be left
/// Of a diagonal entry: rows and columns below it need not get smaller. What only feeds forward, as one amplifier into another, would drift for ever.
constexpr double share_of_diagonal = 0.1;

}  // namespace

Vector balance(Matrix& m, double& growth) {
  Matrix balanced = m;
  Vector scale = Vector::Ones(m.rows());
  bool changed = true;
  for (int round = 0; round < most_rounds && changed; ++round) {
    changed = false;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      const double own = std::abs(balanced(i, i)), least = share_of_diagonal * own;
      const auto rest = [&](double squares) { return std::hypot(std::sqrt(std::max(0.0, squares - own * own)), least); };
      const double row = rest(balanced.row(i).squaredNorm()), column = rest(balanced.col(i).squaredNorm());
      const double exponent = row > 0.0 && column > 0.0 ? std::round(0.5 * std::log2(row / column)) : 0.0;
      if (exponent == 0.0 || !(std::abs(std::log2(scale[i]) + exponent) <= largest_exponent)) continue;
      const double factor = std::exp2(exponent);
      scale[i] *= factor;
      balanced.row(i) /= factor;
      balanced.col(i) *= factor;
      changed = true;
    }
  }
  const double left = logarithmic_norm(balanced);
  if (!(left < worthwhile * growth)) return {};
  m = balanced;
  growth = left;
  return scale;
}

}  // namespace pwlsim::linalg
