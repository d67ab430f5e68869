#include "engine/sparse/krylov_bound.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "linalg/factorisations.hpp"

namespace pwlsim::engine::sparse {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr int piece_steps = 8;
constexpr double least_pieces = 4.0;     ///< that a time is divided into
constexpr double resolved_share = 0.05;  ///< of a piece: its last coefficients
constexpr int most_halvings = 60;
constexpr double same_sources = 1e-6;  ///< of a direction: by so little of itself a combination may miss it

/// Coefficients of Legendre's polynomials from nine values at equal distances.
const Matrix& series_of_values() {
  static const Matrix matrix = [] {
    Matrix values(piece_steps + 1, piece_steps + 1);
    for (Eigen::Index i = 0; i <= piece_steps; ++i) {
      const double x = 2.0 * static_cast<double>(i) / piece_steps - 1.0;
      values(i, 0) = 1.0;
      values(i, 1) = x;
      for (Eigen::Index k = 1; k < piece_steps; ++k) {
        const auto degree = static_cast<double>(k);
        values(i, k + 1) = ((2.0 * degree + 1.0) * x * values(i, k) - degree * values(i, k - 1)) / (degree + 1.0);
      }
    }
    return Matrix(Eigen::PartialPivLU<Matrix>(values).inverse());
  }();
  return matrix;
}

struct Mean {
  double size = 0.0, unresolved = 0.0;
};

/// A bound of the mean of |p|, and the last two coefficients of p.
Mean mean_of(const Vector& values) {
  const Vector c = series_of_values() * values;
  double square = 0.0;
  for (Eigen::Index k = 0; k < c.size(); ++k) square += c[k] * c[k] / (2.0 * static_cast<double>(k) + 1.0);
  return {std::sqrt(square), std::abs(c[piece_steps]) + std::abs(c[piece_steps - 1])};
}

/// ∫ of what a motion misses, over γ.
class Integral {
 public:
  Integral(const KrylovSpace::Relation& relation, double counts)
      : relation_(relation), square_(relation.k * relation.k), counts_(counts), work_(static_cast<std::size_t>(2 * square_.rows())) {}

  struct Sum {
    double last = 0.0;      ///< of |f_m|
    double rounding = 0.0;  ///< of Σ δ_i |f_i|
  };
  [[nodiscard]] Sum until(double tau) {
    sum_ = {};
    const int exponent = static_cast<int>(std::ceil(std::log2(tau / least_pieces)));
    Vector y = relation_.first;
    for (double reached = 0.0; reached < tau; reached += std::ldexp(1.0, exponent)) add(y, exponent, 0);
    return sum_;
  }

 private:
  /// A piece of that power of two, halved until it is resolved or nothing.
  void add(Vector& y, int exponent, int halved) {
    const Vector before = y;
    const Eigen::Index last = square_.rows() - 1;
    const double step = std::ldexp(1.0, exponent) / piece_steps;
    Vector values(piece_steps + 1);
    double rounding = 0.0;
    for (Eigen::Index i = 0; i <= piece_steps; ++i) {
      if (i > 0) relation_.flow.apply_once(step, y.data(), work_.data());
      const Vector f = square_ * y;
      values[i] = relation_.shift * f[last];
      rounding += relation_.shift * relation_.delta.dot(f.cwiseAbs()) / (piece_steps + 1);
    }
    const Mean mean = mean_of(values);
    const double length = std::ldexp(1.0, exponent), least = counts_ / length;
    if (mean.unresolved > resolved_share * mean.size && mean.size + rounding > least && halved < most_halvings) {
      y = before;
      add(y, exponent - 1, halved + 1);
      add(y, exponent - 1, halved + 1);
      return;
    }
    sum_.last += length * (mean.size + mean.unresolved);
    sum_.rounding += length * rounding;
  }

  const KrylovSpace::Relation& relation_;
  Matrix square_;  ///< K²
  double counts_;
  std::vector<double> work_;
  Sum sum_;
};

/// X: of all combinations of the basis that have these directions, the one for which it and τ times its change are least. Nothing where there is none.
std::optional<Matrix> combination(const Matrix& basis, const Matrix& change, const Matrix& of_sources) {
  const Eigen::Index m = basis.cols(), p = of_sources.rows();
  if (m < p) return {};
  Matrix both(basis.rows() + change.rows(), m);
  both << basis, change;
  const Eigen::ColPivHouseholderQR<Matrix> qr(both);
  const auto triangle = qr.matrixQR().topRows(m).triangularView<Eigen::Upper>();
  Matrix rows = of_sources * qr.colsPermutation();
  rows = triangle.transpose().solve(rows.transpose()).transpose();
  const Vector size = rows.rowwise().norm();
  if (!(size.minCoeff() > 0.0)) return {};
  rows = size.cwiseInverse().asDiagonal() * rows;
  const Eigen::CompleteOrthogonalDecomposition<Matrix> inverse(rows);
  Matrix result(m, p);
  for (Eigen::Index k = 0; k < p; ++k) {
    const Vector wanted = Vector::Unit(p, k) / size[k];
    result.col(k) = inverse.solve(wanted);
  }
  result = qr.colsPermutation() * triangle.solve(result);
  const double missed = (of_sources * result - Matrix::Identity(p, p)).cwiseAbs().maxCoeff();
  if (!(missed <= same_sources)) return {};
  return result;
}

Vector column_norms(const Matrix& m) { return m.colwise().norm().transpose(); }

}  // namespace

ErrorGrowth error_growth(const KrylovSpace::Relation& relation, const SourceDirections& directions, double tau, double counts) {
  const Eigen::Index m = relation.k.rows(), rows = m + (relation.has_next ? 1 : 0);
  const double h = relation.has_next ? relation.h(m, m - 1) : 0.0;
  const Integral::Sum sum = Integral(relation, counts).until(tau);
  const Matrix change = relation.h.topRows(rows);  // T Z in vectors
  Matrix basis = change;                           // W
  basis.topRows(m) += Matrix::Identity(m, m);
  const Matrix of_vectors = directions.coordinates(relation.zetas.leftCols(rows)), of_basis = of_vectors * basis;
  ErrorGrowth growth{h * sum.last, sum.rounding};
  const auto coefficients = combination(basis, tau * relation.shift * change, of_basis);
  growth.holds = coefficients.has_value();
  if (!growth.holds || directions.size() == 0) return growth;
  const Matrix x = basis * *coefficients, missed = relation.shift * (change * *coefficients) - x * directions.rates();
  Vector next = Vector::Zero(directions.size());
  if (relation.has_next) next = of_vectors.col(m);
  const Vector of_next = (relation.has_next ? Vector(Vector::Unit(rows, m)) : Vector(Vector::Zero(rows))) - x * next;
  const Vector at_start = (directions.own() - of_basis * (relation.k * relation.first)).cwiseAbs();
  const Vector off = directions.reach(at_start + h * sum.last * next.cwiseAbs(), tau);
  growth.error = h * sum.last * of_next.norm() + column_norms(x).dot(at_start + off) + tau * column_norms(missed).dot(off);
  return growth;
}

}  // namespace pwlsim::engine::sparse
