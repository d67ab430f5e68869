#include "lcp/problem.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/condition.hpp"
#include "lcp/tolerances.hpp"
#include "linalg/factorisations.hpp"

namespace pwlsim::lcp {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double share_of_row = 1e-2;  ///< of a row's largest entry, where the diagonal is smaller

double largest(const Vector& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; }
double share(double part, double whole) { return part > 0.0 ? part / whole : 0.0; }

}  // namespace

Vector diagonal_scale(const Matrix& m) {
  Vector scale = Vector::Ones(m.rows());
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    const double size = std::max(std::abs(m(i, i)), share_of_row * m.row(i).cwiseAbs().maxCoeff());
    if (size > 0.0 && std::isfinite(size)) scale[i] = std::exp2(-std::round(0.5 * std::log2(size)));
  }
  return scale;
}

Solution at_basis(const Matrix& m, const Vector& q, std::vector<int> basis) {
  const auto k = q.size();
  Solution solution{Status::solved, Vector::Zero(k), q, std::move(basis), 0};
  const auto& b = solution.basis;
  if (b.empty()) return solution;
  const Matrix block = m(b, b);
  const Vector right = -q(b);
  const Eigen::PartialPivLU<Matrix> lu(block);
  if (reciprocal_condition(lu) > tolerance::singular_condition) {
    Vector z = lu.solve(right);
    z += lu.solve(right - block * z);
    solution.z(b) = z;
  } else {
    Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
    decomposition.setThreshold(tolerance::singular_condition);  // before compute(), which leaves undone what its rank does not call for
    decomposition.compute(block);
    const Vector z = decomposition.solve(right);
    solution.z(b) = z;
    solution.status = Status::singular;
  }
  const double rounding = tolerance::rounding_of_largest * largest(solution.z);
  for (double& z : solution.z)
    if (z < 0.0 && z >= -rounding) z = 0.0;
  solution.w = m * solution.z + q;
  solution.w(b).setZero();
  return solution;
}

double Assessment::worst() const { return std::max({negative_z, negative_w, complementarity, power}); }

Assessment assess(const Matrix& m, const Vector& q, const Vector& z) {
  Assessment a;
  const auto k = q.size();
  if (k == 0) return a;
  const Vector w = m * z + q;
  if (!w.allFinite()) {
    a.negative_w = INFINITY;
    return a;
  }
  a.scale_z = largest(z);
  a.scale_w = std::max(largest(q), (m.cwiseAbs() * z.cwiseAbs()).maxCoeff());
  a.negative_z = share(-z.minCoeff(), a.scale_z);
  a.negative_w = share(-w.minCoeff(), a.scale_w);
  for (Eigen::Index i = 0; i < k; ++i)
    a.complementarity = std::max(a.complementarity, std::min(share(std::abs(z[i]), a.scale_z), share(std::abs(w[i]), a.scale_w)));
  a.power = share(std::abs(z.dot(w)), static_cast<double>(k) * a.scale_z * a.scale_w);
  return a;
}

double residual(const Matrix& m, const Vector& q, const Vector& z) {
  if (q.size() == 0) return 0.0;
  const Vector w = m * z + q;
  const double scale = std::max(largest(q), (m.cwiseAbs() * z.cwiseAbs()).maxCoeff());
  const double worst = w.cwiseMin(z).cwiseAbs().maxCoeff();
  return scale > 0.0 ? worst / scale : worst;
}

}  // namespace pwlsim::lcp
