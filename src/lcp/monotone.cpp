#include "lcp/monotone.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lcp/lemke.hpp"
#include "lcp/tolerances.hpp"

namespace pwlsim::lcp {

namespace {

using linalg::Matrix;
using linalg::Vector;

enum class Side : char { undecided, z, w, neither };

/// Orthonormal basis of {d : rows·d = 0}.
Matrix kernel_of(const Matrix& rows) {
  const Eigen::ColPivHouseholderQR<Matrix> qr(rows.transpose());
  Eigen::Index rank = 0;
  while (rank < rows.cols() && std::abs(qr.matrixQR()(rank, rank)) > tolerance::kernel) ++rank;
  return (qr.householderQ() * Matrix::Identity(rows.cols(), rows.cols())).rightCols(rows.cols() - rank);
}

/// Works in the diagonally scaled problem, ẑ = S⁻¹ z, ŵ = S w.
class Polyhedron {
 public:
  Polyhedron(const Matrix& m, const Vector& q, const Vector& z) : k_(q.size()), scale_(diagonal_scale(m)) {
    m_ = scale_.asDiagonal() * m * scale_.asDiagonal();
    z_ = z.cwiseQuotient(scale_).cwiseMax(0.0);
    w_ = m_ * z_ + scale_.cwiseProduct(q);
    size_z_ = z_.cwiseAbs().maxCoeff();
    size_w_ = std::max(scale_.cwiseProduct(q).cwiseAbs().maxCoeff(), (m_.cwiseAbs() * z_).maxCoeff());
    norm_ = std::max(1.0, m_.cwiseAbs().maxCoeff());
    read_sides();
  }

  void grow() {
    for (find_directions(); directions_.cols() > 0; find_directions()) {
      const Vector d = one_sided_direction();
      if (d.size() == 0) break;
      advance(d);
    }
    for (Side& side : side_)
      if (side == Side::undecided) side = Side::neither;
    find_directions();
  }

  /// Moves the point from inside the polyhedron to its least |z|² + |w|².
  void move_to_least_norm();
  [[nodiscard]] SolutionSet result() const;

 private:
  void read_sides();
  void find_directions();
  [[nodiscard]] Vector one_sided_direction() const;
  void advance(const Vector& d);

  Eigen::Index k_;
  Vector scale_;
  Matrix m_;
  Vector z_, w_;
  double size_z_ = 0.0, size_w_ = 0.0, norm_ = 1.0;
  bool least_ = true;
  std::vector<Side> side_;
  Matrix directions_;  ///< orthonormal basis of the d that no equation forbids
};

void Polyhedron::read_sides() {
  for (Eigen::Index i = 0; i < k_; ++i) {
    const bool z = z_[i] > tolerance::zero_component * size_z_;
    const bool w = w_[i] > tolerance::zero_component * size_w_;
    side_.push_back(z ? Side::z : w ? Side::w : Side::undecided);
    if (side_.back() != Side::z) z_[i] = 0.0;
    if (side_.back() != Side::w) w_[i] = 0.0;
  }
}

void Polyhedron::find_directions() {
  Matrix equations(3 * k_, k_);
  equations.topRows(k_) = (m_ + m_.transpose()) / norm_;
  Eigen::Index rows = k_;
  for (Eigen::Index i = 0; i < k_; ++i) {
    const Side side = side_[static_cast<std::size_t>(i)];
    if (side == Side::z || side == Side::neither) equations.row(rows++) = m_.row(i) / norm_;
    if (side == Side::w || side == Side::neither) equations.row(rows++) = Vector::Unit(k_, i).transpose();
  }
  directions_ = kernel_of(equations.topRows(rows));
}

/// d ≠ 0 that keeps z_i, w_i ≥ 0 at undecided indices and raises one of them; empty: none.
Vector Polyhedron::one_sided_direction() const {
  const Matrix change = m_ * directions_ / norm_;
  Matrix g(2 * k_, directions_.cols());
  Eigen::Index rows = 0;
  for (Eigen::Index i = 0; i < k_; ++i) {
    if (side_[static_cast<std::size_t>(i)] != Side::undecided) continue;
    for (const Matrix* of : {&directions_, &change})
      if (const double norm = of->row(i).norm(); norm > tolerance::kernel) g.row(rows++) = of->row(i) / norm;
  }
  if (rows == 0) return {};
  g.conservativeResize(rows, Eigen::NoChange);
  const Matrix gram = g * g.transpose();
  const Solution excess = lemke(gram, gram.rowwise().sum());
  if (excess.status != Status::solved) return {};
  const Vector lambda = Vector::Ones(rows) + excess.z;
  const Vector t = g.transpose() * lambda;
  if (t.norm() <= tolerance::kernel * lambda.norm()) return {};
  return directions_ * t.normalized();
}

/// Half of the way to where a positive component becomes zero.
void Polyhedron::advance(const Vector& d) {
  const Vector dw = m_ * d;
  double step = size_z_ > 0.0 ? size_z_ : size_w_ > 0.0 ? size_w_ / norm_ : 1.0;
  for (Eigen::Index i = 0; i < k_; ++i) {
    if (side_[static_cast<std::size_t>(i)] == Side::z && d[i] < 0.0) step = std::min(step, -0.5 * z_[i] / d[i]);
    if (side_[static_cast<std::size_t>(i)] == Side::w && dw[i] < 0.0) step = std::min(step, -0.5 * w_[i] / dw[i]);
  }
  z_ += step * d;
  w_ += step * dw;
  for (Eigen::Index i = 0; i < k_; ++i) {
    Side& side = side_[static_cast<std::size_t>(i)];
    if (side != Side::undecided) continue;
    if (d[i] > tolerance::kernel)
      side = Side::z;
    else if (dw[i] > tolerance::kernel * norm_)
      side = Side::w;
  }
}

/// A projection, whose multipliers are a small complementarity problem; what has one lies on its bound.
void Polyhedron::move_to_least_norm() {
  const auto dimension = directions_.cols();
  if (dimension == 0) return;
  Matrix effect(2 * k_, dimension);
  effect << scale_.asDiagonal() * directions_, scale_.cwiseInverse().asDiagonal() * (m_ * directions_);
  Vector inside(2 * k_);
  inside << scale_.cwiseProduct(z_), w_.cwiseQuotient(scale_);
  const Eigen::HouseholderQR<Matrix> qr(effect);
  const Matrix basis = qr.householderQ() * Matrix::Identity(2 * k_, dimension);
  Vector t = -(basis.transpose() * inside);
  std::vector<Eigen::Index> bounded;
  for (Eigen::Index i = 0; i < k_; ++i) {
    if (side_[static_cast<std::size_t>(i)] == Side::z) bounded.push_back(i);
    if (side_[static_cast<std::size_t>(i)] == Side::w) bounded.push_back(k_ + i);
  }
  const Matrix g = basis(bounded, Eigen::all);
  const Solution multipliers = lemke(g * g.transpose(), inside(bounded) + g * t);
  least_ = multipliers.status == Status::solved;
  if (!least_) return;
  t += g.transpose() * multipliers.z;
  const Matrix r = qr.matrixQR().topRows(dimension);
  const Vector change = directions_ * r.triangularView<Eigen::Upper>().solve(t);
  z_ += change;
  w_ += m_ * change;
  for (const int at : multipliers.basis) {
    const Eigen::Index i = bounded[static_cast<std::size_t>(at)];
    (i < k_ ? z_[i] : w_[i - k_]) = 0.0;
  }
}

SolutionSet Polyhedron::result() const {
  SolutionSet set{static_cast<int>(directions_.cols()), Vector::Zero(k_), Vector::Zero(k_), least_, {}, {}};
  const Matrix of_w = m_ * directions_ / norm_;
  for (Eigen::Index i = 0; i < k_; ++i) {
    const Side side = side_[static_cast<std::size_t>(i)];
    if (side == Side::z) set.z[i] = scale_[i] * std::max(z_[i], 0.0);
    if (side == Side::w) set.w[i] = std::max(w_[i], 0.0) / scale_[i];
    set.z_determined.push_back(side != Side::z || directions_.row(i).norm() <= tolerance::kernel);
    set.w_determined.push_back(side != Side::w || of_w.row(i).norm() <= tolerance::kernel);
  }
  return set;
}

}  // namespace

SolutionSet all_solutions(const Matrix& m, const Vector& q, const Vector& z) {
  if (q.size() == 0) return {0, z, q, true, {}, {}};
  Polyhedron polyhedron(m, q, z);
  polyhedron.grow();
  polyhedron.move_to_least_norm();
  return polyhedron.result();
}

bool is_monotone(const Matrix& m) {
  if (m.size() == 0) return true;
  const Vector scale = diagonal_scale(m);
  const Matrix scaled = scale.asDiagonal() * m * scale.asDiagonal();
  return -linalg::logarithmic_norm(-scaled) >= -tolerance::monotone * static_cast<double>(m.rows());
}

}  // namespace pwlsim::lcp
