#pragma once
/// Dense vectors and matrices, and the few operations that the small systems of a mode need in inner loops.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace pwlsim::linalg {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// Extended precision (64 bits of fraction) for results that are computed once and decide ranks: cancellation must be visible there.
using Wide = long double;
using WideMatrix = Eigen::Matrix<Wide, Eigen::Dynamic, Eigen::Dynamic>;
using WideVector = Eigen::Matrix<Wide, Eigen::Dynamic, 1>;

/// y = M x, without allocation and without the dispatch cost that Eigen has for the sizes at hand (2 to 12). y must not alias x.
void multiply(const Matrix& m, const double* x, double* y);

/// The first rows.size() rows of M x, where most of x is zero.
void multiply_sparse(const Matrix& m, const double* x, Vector& rows);

/// z = M x + N y; z must not alias x or y.
void multiply_two(const Matrix& m, const double* x, const Matrix& n, const double* y, double* z);

/// Writes A x, A² x, … Aᵏ x one after the other after x, with which `powers` begins; A is square.
void multiply_repeatedly(const Matrix& a, int k, double* powers);

/// Row `i` of M times x.
inline double row_times(const Matrix& m, Eigen::Index i, const double* x) {
  const Eigen::Index rows = m.rows();
  const double* a = m.data() + i;
  double sum = 0.0;
  for (Eigen::Index j = 0; j < m.cols(); ++j, a += rows) sum += *a * x[j];
  return sum;
}

/// The same for `count` vectors, the next one `apart` behind each.
template <std::size_t count>
std::array<double, count> row_times_each(const Matrix& m, Eigen::Index i, const double* x, std::size_t apart) {
  const Eigen::Index rows = m.rows();
  const double* a = m.data() + i;
  std::array<double, count> sums{};
  for (Eigen::Index j = 0; j < m.cols(); ++j, a += rows, ++x)
    for (std::size_t k = 0; k < count; ++k) sums[k] += *a * x[k * apart];
  return sums;
}

/// The sum of the magnitudes of its terms.
inline double absolute_row_times(const Matrix& m, Eigen::Index i, const double* x) {
  const Eigen::Index rows = m.rows();
  const double* a = m.data() + i;
  double sum = 0.0;
  for (Eigen::Index j = 0; j < m.cols(); ++j, a += rows) sum += std::abs(*a * x[j]);
  return sum;
}

/// ‖x‖₂².
[[nodiscard]] inline double square(const double* x, Eigen::Index n) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) sum += x[i] * x[i];
  return sum;
}

[[nodiscard]] inline double norm(const double* x, Eigen::Index n) { return std::sqrt(square(x, n)); }

/// y := x.
void copy(const double* x, Eigen::Index n, double* y);

/// ‖x − y‖₂².
[[nodiscard]] inline double square_distance(const double* x, const double* y, Eigen::Index n) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) sum += (x[i] - y[i]) * (x[i] - y[i]);
  return sum;
}

/// The rows, or columns, of M with these numbers, in their order. Loops: Eigen's views by index cost as much as products at the sizes at hand.
[[nodiscard]] WideMatrix rows_of(const WideMatrix& m, const std::vector<int>& numbers);
[[nodiscard]] WideMatrix columns_of(const WideMatrix& m, const std::vector<int>& numbers);

/// A step of Arnoldi's method (Golub & Van Loan, Matrix Computations, §10.5): takes from x what lies in the span of the orthonormal columns (n × j), by Gram and Schmidt's method, twice, and
/// appends to H (j × (j − 1)) the column of what was taken and of ‖x‖ then, which is returned.
double append_to_hessenberg(const Eigen::Ref<const Matrix>& basis, Vector& x, Matrix& h);

/// X·Y and |X||Y|, column by column: at the sizes at hand the cost is that of the arithmetic.
[[nodiscard]] WideMatrix product(const WideMatrix& x, const WideMatrix& y);
[[nodiscard]] WideMatrix absolute_product(const WideMatrix& x, const WideMatrix& y);
/// The same, skipping zeros, if one of the two has few nonzero entries.
[[nodiscard]] WideMatrix sparse_product(const WideMatrix& x, const WideMatrix& y);
[[nodiscard]] WideMatrix sparse_absolute_product(const WideMatrix& x, const WideMatrix& y);

/// X·Y with every entry below `clean_tolerance`·(|X||Y|) set to zero: such an entry is the rounding error of an exact cancellation.
inline constexpr double clean_tolerance = 1e-14;  ///< Of: the sum of the absolute terms of an entry. Why: 45 units of rounding of double.
[[nodiscard]] Matrix clean_product(const Matrix& x, const Matrix& y);
/// B + X·Y with every entry below clean_tolerance·(|B| + |X||Y|) set to zero.
[[nodiscard]] Matrix clean_sum(Matrix base, const Matrix& x, const Matrix& y);

/// M with entries below clean_tolerance·bound set to zero, entry by entry.
[[nodiscard]] Matrix cleaned(Matrix m, const Matrix& bound);

/// The same in extended precision, at its own level.
inline constexpr Wide wide_clean_tolerance = 1e-16L;  ///< Of: the same in extended precision. Why: 900 units of its rounding.
[[nodiscard]] WideMatrix wide_clean_sum(WideMatrix base, const WideMatrix& x, const WideMatrix& y);
[[nodiscard]] WideMatrix wide_clean_product(const WideMatrix& x, const WideMatrix& y);
[[nodiscard]] WideMatrix wide_cleaned(WideMatrix m, const WideMatrix& bound);

/// Orthonormal basis of {x : M x = 0}; singular values below `tolerance`·scale count as zero (scale ≤ 0: the largest one).
[[nodiscard]] Matrix null_space(const Matrix& m, double tolerance, double scale = 0.0);

/// The same in extended precision, with the pivots of a factorisation in place of singular values.
[[nodiscard]] WideMatrix wide_null_space(const WideMatrix& m, double tolerance, double scale = 0.0);

/// Orthonormal basis of the column space, same rule.
[[nodiscard]] WideMatrix wide_range_space(const WideMatrix& m, double tolerance, double scale = 0.0);

/// The x of the least |M x − b|, for independent columns.
[[nodiscard]] WideVector wide_least_squares(const WideMatrix& m, const WideVector& b);

/// Moore–Penrose pseudoinverse, same rule with the largest pivot as scale.
[[nodiscard]] WideMatrix wide_pseudo_inverse(const WideMatrix& m, double tolerance);

/// Largest singular value; 0 for an empty matrix.
[[nodiscard]] double spectral_norm(const Matrix& m);

/// Rate of the system x' = A x: ‖A‖₂, or 1 if A is zero. With its inverse as the unit of time A is of order one.
[[nodiscard]] double rate_of(const Matrix& a);

/// Largest eigenvalue of (M + Mᵀ)/2; 0 for an empty matrix.
[[nodiscard]] double logarithmic_norm(const Matrix& m);

}  // namespace pwlsim::linalg
