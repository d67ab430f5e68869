#include "lcp/enumeration.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace pwlsim::test {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double sign_slack = 1e-9;      ///< below it a component counts as zero
constexpr double equation_slack = 1e-9;  ///< of linear equations that have a solution
constexpr double rank_tolerance = 1e-10;

std::vector<int> members(unsigned mask, int k) {
  std::vector<int> j;
  for (int i = 0; i < k; ++i)
    if (mask >> static_cast<unsigned>(i) & 1U) j.push_back(i);
  return j;
}

/// min |v − target| with v_i = 0 for `zero`, w = M z + q, v = (z, w).
Point nearest_on_face(const Matrix& m, const Vector& q, const Vector& target, const std::vector<int>& zero) {
  const auto k = q.size();
  Matrix equations = Matrix::Zero(k + static_cast<Eigen::Index>(zero.size()), 2 * k);
  equations.topLeftCorner(k, k) = m;
  equations.topRightCorner(k, k) = -Matrix::Identity(k, k);
  for (std::size_t i = 0; i < zero.size(); ++i) equations(k + static_cast<Eigen::Index>(i), zero[i]) = 1.0;
  Vector right = Vector::Zero(equations.rows());
  right.head(k) = -q;
  Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
  decomposition.setThreshold(rank_tolerance);
  decomposition.compute(equations);
  const Vector v = target + decomposition.solve(right - equations * target);
  const bool solves = (equations * v - right).norm() <= equation_slack * (1.0 + v.norm());
  return {solves && v.minCoeff() >= -sign_slack, v.head(k), v.tail(k)};
}

}  // namespace

std::vector<int> Problems::subset(int k) {
  std::vector<int> set;
  for (int i = 0; i < k; ++i)
    if (number() > 0.0) set.push_back(i);
  return set;
}

Matrix Problems::semidefinite(int k, int rank) {
  const Matrix g = matrix(k, rank);
  const Matrix s = matrix(k, k);
  return g * g.transpose() + s - s.transpose();
}

std::vector<Vector> enumerate(const Matrix& m, const Vector& q) {
  const auto k = static_cast<int>(q.size());
  std::vector<Vector> solutions;
  for (unsigned mask = 0; mask < (1U << static_cast<unsigned>(k)); ++mask) {
    const std::vector<int> j = members(mask, k);
    Vector z = Vector::Zero(k);
    if (!j.empty()) {
      const Eigen::FullPivLU<Matrix> lu(m(j, j));
      if (!lu.isInvertible()) continue;
      z(j) = -lu.solve(q(j));
    }
    const Vector w = m * z + q;
    if (z.minCoeff() >= -sign_slack && w.minCoeff() >= -sign_slack) solutions.push_back(z);
  }
  return solutions;
}

bool is_among(const Vector& z, const std::vector<Vector>& solutions, double agreement) {
  return std::any_of(solutions.begin(), solutions.end(),
                     [&](const Vector& s) { return (s - z).cwiseAbs().maxCoeff() <= agreement * (1.0 + s.norm()); });
}

Point nearest_solution(const Matrix& m, const Vector& q, const Vector& target_z, const Vector& target_w) {
  const auto k = static_cast<int>(q.size());
  Vector target(2 * k);
  target << target_z, target_w;
  int faces = 1;
  for (int i = 0; i < k; ++i) faces *= 3;
  Point best;
  double least = INFINITY;
  for (int face = 0; face < faces; ++face) {
    std::vector<int> zero;
    for (int i = 0, rest = face; i < k; ++i, rest /= 3) {
      if (rest % 3 != 0) zero.push_back(i);
      if (rest % 3 != 1) zero.push_back(k + i);
    }
    const Point point = nearest_on_face(m, q, target, zero);
    const double distance = (point.z - target_z).squaredNorm() + (point.w - target_w).squaredNorm();
    if (!point.exists || distance >= least) continue;
    least = distance;
    best = point;
  }
  return best;
}

bool is_p_matrix(const Matrix& m) {
  const auto k = static_cast<int>(m.rows());
  for (unsigned mask = 1; mask < (1U << static_cast<unsigned>(k)); ++mask) {
    const std::vector<int> j = members(mask, k);
    if (Matrix(m(j, j)).determinant() <= 0.0) return false;
  }
  return true;
}

}  // namespace pwlsim::test
