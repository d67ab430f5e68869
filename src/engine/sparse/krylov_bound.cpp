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
/// The same, of one that is half of a resolved piece: they fall as the eighth power of its length.
constexpr double smooth_share = resolved_share / 256.0;
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

/// ∫ of what a motion misses, over γ: of f = K² y, which moves as y does, since K is a function of its matrix.
class Integral {
 public:
  Integral(const KrylovSpace::Relation& relation, double counts)
      : relation_(relation),
        counts_(counts),
        f_(relation.k * (relation.k * relation.first)),
        end_(f_.size()),
        work_(static_cast<std::size_t>(2 * f_.size())) {}

  struct Sum {
    double last = 0.0;      ///< of |f_m|
    double rounding = 0.0;  ///< of Σ δ_i |f_i|
  };
  /// By pieces that are powers of two: half as long where one is not resolved, twice as long where one shows that those would be.
  [[nodiscard]] Sum until(double tau) {
    Sum sum;
    const int longest = static_cast<int>(std::ceil(std::log2(tau / least_pieces)));
    int exponent = longest;
    for (double reached = 0.0; reached < tau;) {
      const double length = std::ldexp(1.0, exponent);
      const Piece piece = piece_of(length);
      const bool counts = piece.mean.size + piece.rounding > counts_ / length;
      if (counts && piece.mean.unresolved > resolved_share * piece.mean.size && exponent > longest - most_halvings) {
        --exponent;
        continue;
      }
      sum.last += length * (piece.mean.size + piece.mean.unresolved);
      sum.rounding += length * piece.rounding;
      f_.swap(end_);
      reached += length;
      if (exponent < longest && (!counts || piece.mean.unresolved < smooth_share * piece.mean.size)) ++exponent;
    }
    return sum;
  }

 private:
  struct Piece {
    Mean mean;
    double rounding = 0.0;
  };
  /// Of the next piece, at whose end end_ is.
  Piece piece_of(double length) {
    const Eigen::Index last = f_.size() - 1;
    Vector values(piece_steps + 1);
    double rounding = 0.0;
    end_ = f_;
    for (Eigen::Index i = 0; i <= piece_steps; ++i) {
      if (i > 0) relation_.flow.apply_once(length / piece_steps, end_.data(), work_.data());
      values[i] = relation_.shift * end_[last];
      rounding += relation_.shift * relation_.delta.dot(end_.cwiseAbs()) / (piece_steps + 1);
    }
    return {mean_of(values), rounding};
  }

  const KrylovSpace::Relation& relation_;
  double counts_;
  Vector f_, end_;  ///< where the next piece begins and ends
  std::vector<double> work_;
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
