#include "model/subspaces.hpp"

#include <cmath>

#include "linalg/factorisations.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using linalg::wide_null_space;
using linalg::wide_range_space;
using linalg::WideMatrix;
using linalg::WideVector;

/// Rows divided by their largest entry, rows of rounding dropped.
WideMatrix equilibrated(const WideMatrix& m, WideMatrix* companion = nullptr) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    if (m.cols() > 0 && m.row(i).cwiseAbs().maxCoeff() > tolerance::noise_row) kept.push_back(i);
  WideMatrix result(static_cast<Eigen::Index>(kept.size()), m.cols());
  WideMatrix other(static_cast<Eigen::Index>(kept.size()), companion ? companion->cols() : 0);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const linalg::Wide scale = m.row(kept[i]).cwiseAbs().maxCoeff();
    const auto row = static_cast<Eigen::Index>(i);
    result.row(row) = m.row(kept[i]) / scale;
    if (companion) other.row(row) = companion->row(kept[i]) / scale;
  }
  if (companion) *companion = other;
  return result;
}

WideMatrix complement_rows(const WideMatrix& v, Eigen::Index size) {
  if (v.cols() == size) return WideMatrix(0, size);
  if (v.cols() == 0) return WideMatrix::Identity(size, size);
  return wide_null_space(v.transpose(), tolerance::subspace_rank).transpose();
}

WideMatrix consistent_subspace(const WideMatrix& a, const WideMatrix& b, const WideMatrix& c, const WideMatrix& d) {
  const auto size = a.rows();
  WideMatrix v = WideMatrix::Identity(size, size);
  while (v.cols() > 0) {
    const WideMatrix q = complement_rows(v, size);
    WideMatrix block(q.rows() + c.rows(), v.cols() + b.cols());
    block << q * a * v, q * b, c * v, d;
    const WideMatrix kernel = wide_null_space(equilibrated(block), tolerance::subspace_rank);
    const WideMatrix next = wide_range_space(v * kernel.topRows(v.cols()), tolerance::subspace_rank, 1.0);
    if (next.cols() == v.cols()) break;
    v = next;
  }
  return v;
}

WideMatrix jump_subspace(const WideMatrix& a, const WideMatrix& b, const WideMatrix& c, const WideMatrix& d) {
  const auto size = a.rows();
  WideMatrix t(size, 0);
  for (;;) {
    WideMatrix row(c.rows(), t.cols() + d.cols());
    row << c * t, d;
    const WideMatrix kernel = wide_null_space(row, tolerance::subspace_rank, 1.0);
    WideMatrix direction(size, t.cols() + b.cols());
    direction << a * t, b;
    const WideMatrix image = direction * kernel;
    WideMatrix both(size, t.cols() + image.cols());
    both.leftCols(t.cols()) = t;
    Eigen::Index kept = t.cols();
    for (Eigen::Index j = 0; j < image.cols(); ++j) {
      const linalg::Wide norm = image.col(j).norm();
      if (norm > tolerance::noise_row) both.col(kept++) = image.col(j) / norm;
    }
    const WideMatrix next = wide_range_space(both.leftCols(kept), tolerance::subspace_rank, 1.0);
    if (next.cols() == t.cols()) return t;
    t = next;
  }
}

double condition_of(const WideMatrix& m) {
  if (m.size() == 0) return 1.0;
  const linalg::Vector values = Eigen::JacobiSVD<linalg::Matrix>(m.cast<double>()).singularValues();
  return values[values.size() - 1] > 0.0 ? static_cast<double>(values[0] / values[values.size() - 1]) : INFINITY;
}

/// Minimum-norm least squares.
WideMatrix feedback_on(const WideMatrix& v, const WideMatrix& a, const WideMatrix& b, const WideMatrix& c, const WideMatrix& d,
                       double& condition) {
  const auto size = a.rows();
  const WideMatrix q = complement_rows(v, size);
  WideMatrix left(q.rows() + d.rows(), b.cols());
  left << q * b, d;
  WideMatrix right(left.rows(), v.cols());
  right << -q * a * v, -c * v;
  const WideMatrix scaled = equilibrated(left, &right);
  if (scaled.rows() == 0) return WideMatrix::Zero(b.cols(), size);
  const WideMatrix inverse = linalg::wide_pseudo_inverse(scaled, tolerance::subspace_rank);
  condition = std::max(condition, linalg::spectral_norm(inverse.cast<double>()) * linalg::spectral_norm(scaled.cast<double>()));
  const WideMatrix x = inverse * right;
  return linalg::wide_cleaned(x * v.transpose(), x.cwiseAbs() * v.cwiseAbs().transpose());
}

bool reaches_sources(const WideMatrix& v, int n_zeta) {
  if (n_zeta == 0) return true;
  if (v.cols() < n_zeta) return false;
  return wide_range_space(WideMatrix(v.bottomRows(n_zeta)), tolerance::subspace_rank).cols() == n_zeta;
}

}  // namespace

Subspaces find_subspaces(const WideMatrix& a0, const WideMatrix& b0, const WideMatrix& c0, const WideMatrix& d, int n_zeta) {
  const auto size = a0.rows();
  Subspaces result;
  const double rate = linalg::rate_of(a0.cast<double>());
  const linalg::Wide root = std::sqrt(static_cast<linalg::Wide>(rate));
  const WideMatrix a = a0 / rate;
  const WideMatrix b = b0 / root;
  const WideMatrix c = c0 / root;

  const WideMatrix v = consistent_subspace(a, b, c, d);
  const WideMatrix t = jump_subspace(a, b, c, d);
  result.dim_v = static_cast<int>(v.cols());
  result.dim_t = static_cast<int>(t.cols());
  if (v.cols() + t.cols() != size || !reaches_sources(v, n_zeta)) return result;
  WideMatrix both(size, size);
  both << v, t;
  result.condition = condition_of(both);
  if (!(result.condition < tolerance::largest_condition)) return result;
  const WideMatrix inverse = size > 0 ? WideMatrix(both.inverse()) : both;
  result.projector = v * inverse.topRows(v.cols());
  result.feedback = root * feedback_on(v, a, b, c, d, result.condition);
  result.constraints = complement_rows(v, size);
  WideMatrix effect(size + d.rows(), b.cols());
  effect << b, d;
  result.free_inputs = wide_null_space(equilibrated(effect), tolerance::subspace_rank);
  result.free_inputs = linalg::wide_cleaned(result.free_inputs, WideMatrix::Ones(b.cols(), result.free_inputs.cols()));
  result.regular = true;
  return result;
}

Subspaces subspaces_without_sources(const System& system, const IndexSet& active) {
  const auto unrounded = system.unrounded_matrices();
  const Unrounded& m = *unrounded;
  std::vector<Eigen::Index> j;
  for (int i = 0; i < system.ports; ++i)
    if (active.contains(i)) j.push_back(i);
  return find_subspaces(m.a.topLeftCorner(system.n, system.n), m.b.topRows(system.n)(Eigen::all, j), m.c.leftCols(system.n)(j, Eigen::all),
                        m.d(j, j), 0);
}

}  // namespace pwlsim::model
