#include "model/subspaces.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace pwlsim::model {

namespace {

using linalg::null_space;
using linalg::range_space;

constexpr double rank_tolerance = 1e-10;   ///< of unit vectors and equilibrated rows
constexpr double noise_row = 1e-12;        ///< rows and columns below this, after scaling, are rounding
constexpr double largest_condition = 1e12; ///< of [V T]

/// Rows divided by their largest entry, rows of rounding dropped.
Matrix equilibrated(const Matrix& m, Matrix* companion = nullptr) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    if (m.cols() > 0 && m.row(i).cwiseAbs().maxCoeff() > noise_row) kept.push_back(i);
  Matrix result(static_cast<Eigen::Index>(kept.size()), m.cols());
  Matrix other(static_cast<Eigen::Index>(kept.size()), companion ? companion->cols() : 0);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const double scale = m.row(kept[i]).cwiseAbs().maxCoeff();
    const auto row = static_cast<Eigen::Index>(i);
    result.row(row) = m.row(kept[i]) / scale;
    if (companion) other.row(row) = companion->row(kept[i]) / scale;
  }
  if (companion) *companion = other;
  return result;
}

Matrix complement_rows(const Matrix& v, Eigen::Index size) {
  if (v.cols() == size) return Matrix(0, size);
  if (v.cols() == 0) return Matrix::Identity(size, size);
  return null_space(v.transpose(), rank_tolerance).transpose();
}

Matrix consistent_subspace(const Matrix& a, const Matrix& b, const Matrix& c, const Matrix& d) {
  const auto size = a.rows();
  Matrix v = Matrix::Identity(size, size);
  while (v.cols() > 0) {
    const Matrix q = complement_rows(v, size);
    Matrix block(q.rows() + c.rows(), v.cols() + b.cols());
    block << q * a * v, q * b, c * v, d;
    const Matrix kernel = null_space(equilibrated(block), rank_tolerance);
    const Matrix next = range_space(v * kernel.topRows(v.cols()), rank_tolerance, 1.0);
    if (next.cols() == v.cols()) break;
    v = next;
  }
  return v;
}

Matrix jump_subspace(const Matrix& a, const Matrix& b, const Matrix& c, const Matrix& d) {
  const auto size = a.rows();
  Matrix t(size, 0);
  for (;;) {
    Matrix row(c.rows(), t.cols() + d.cols());
    row << c * t, d;
    const Matrix kernel = null_space(row, rank_tolerance, 1.0);
    Matrix direction(size, t.cols() + b.cols());
    direction << a * t, b;
    const Matrix image = direction * kernel;
    Matrix both(size, t.cols() + image.cols());
    both.leftCols(t.cols()) = t;
    Eigen::Index kept = t.cols();
    for (Eigen::Index j = 0; j < image.cols(); ++j) {
      const double norm = image.col(j).norm();
      if (norm > noise_row) both.col(kept++) = image.col(j) / norm;
    }
    const Matrix next = range_space(both.leftCols(kept), rank_tolerance, 1.0);
    if (next.cols() == t.cols()) return t;
    t = next;
  }
}

double condition_of(const Matrix& m) {
  if (m.size() == 0) return 1.0;
  const Vector values = Eigen::JacobiSVD<Matrix>(m).singularValues();
  return values[values.size() - 1] > 0.0 ? values[0] / values[values.size() - 1] : INFINITY;
}

/// Minimum-norm least squares with one step of refinement in extended precision.
Matrix feedback_on(const Matrix& v, const Matrix& a, const Matrix& b, const Matrix& c, const Matrix& d, double& condition) {
  const auto size = a.rows();
  const Matrix q = complement_rows(v, size);
  Matrix left(q.rows() + d.rows(), b.cols());
  left << q * b, d;
  Matrix right(left.rows(), v.cols());
  right << -q * a * v, -c * v;
  const Matrix scaled = equilibrated(left, &right);
  if (scaled.rows() == 0) return Matrix::Zero(b.cols(), size);
  const Matrix inverse = linalg::pseudo_inverse(scaled, rank_tolerance);
  condition = std::max(condition, linalg::spectral_norm(inverse) * linalg::spectral_norm(scaled));
  Matrix x = inverse * right;
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  for (int round = 0; round < 2; ++round) {
    const Long rest = right.cast<long double>() - scaled.cast<long double>() * x.cast<long double>();
    x += inverse * rest.cast<double>();
  }
  return linalg::cleaned(x * v.transpose(), x.cwiseAbs() * v.cwiseAbs().transpose());
}

bool reaches_sources(const Matrix& v, int n_zeta) {
  if (n_zeta == 0) return true;
  if (v.cols() < n_zeta) return false;
  return range_space(Matrix(v.bottomRows(n_zeta)), rank_tolerance).cols() == n_zeta;
}

}  // namespace

Subspaces find_subspaces(const System& system, const Matrix& b0, const Matrix& c0, const Matrix& d) {
  const auto size = static_cast<Eigen::Index>(system.size());
  Subspaces result;
  double rate = linalg::spectral_norm(system.a);
  if (!(rate > 0.0)) rate = 1.0;
  const double root = std::sqrt(rate);
  const Matrix a = system.a / rate;
  const Matrix b = b0 / root;
  const Matrix c = c0 / root;

  const Matrix v = consistent_subspace(a, b, c, d);
  const Matrix t = jump_subspace(a, b, c, d);
  result.dim_v = static_cast<int>(v.cols());
  result.dim_t = static_cast<int>(t.cols());
  if (v.cols() + t.cols() != size || !reaches_sources(v, system.n_zeta)) return result;
  Matrix both(size, size);
  both << v, t;
  result.condition = condition_of(both);
  if (!(result.condition < largest_condition)) return result;
  const Matrix inverse = size > 0 ? Matrix(both.inverse()) : both;
  result.projector = v * inverse.topRows(v.cols());
  result.feedback = root * feedback_on(v, a, b, c, d, result.condition);
  result.constraints = complement_rows(v, size);
  Matrix effect(size + d.rows(), b.cols());
  effect << b, d;
  result.free_inputs = null_space(effect, rank_tolerance);
  result.regular = true;
  return result;
}

}  // namespace pwlsim::model
