/// Small dense helpers against matrices whose ranks and norms are known by construction.
#include "linalg/dense.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace pwlsim::linalg;

namespace {
constexpr double matrix_rounding = 1e-14;
constexpr double rank_tolerance = 1e-9;

/// Rank two: the third row is the sum of the first two.
Matrix rank_two() {
  Matrix m(3, 4);
  m << 1, 2, 0, -1, 0, 1, 1, 1, 1, 3, 1, 0;
  return m;
}

bool is_orthonormal(const Matrix& m) { return (m.transpose() * m - Matrix::Identity(m.cols(), m.cols())).norm() <= matrix_rounding; }
}  // namespace

TEST_CASE("products of small matrices", "[unit]") {
  Matrix m(2, 3);
  m << 1, 2, 3, 4, 5, 6;
  const double x[] = {1, -1, 2};
  double y[2];
  multiply(m, x, y);
  CHECK(y[0] == 5.0);
  CHECK(y[1] == 11.0);
  CHECK(row_times(m, 1, x) == 11.0);
  const double three_four[] = {3, -4};
  CHECK(norm(three_four, 2) == 5.0);
}

TEST_CASE("null space and range of a matrix of rank two", "[unit]") {
  const Matrix m = rank_two();
  const Matrix null = null_space(m, rank_tolerance);
  CHECK(null.cols() == 2);
  CHECK(is_orthonormal(null));
  CHECK((m * null).norm() <= matrix_rounding);
  const Matrix range = wide_range_space(m.cast<Wide>(), rank_tolerance).cast<double>();
  CHECK(range.cols() == 2);
  CHECK(is_orthonormal(range));
  CHECK((range * (range.transpose() * m) - m).norm() <= matrix_rounding);
}

TEST_CASE("the scale decides what counts as zero", "[unit]") {
  const Matrix tiny = 1e-12 * rank_two();
  CHECK(null_space(tiny, rank_tolerance).cols() == 2);       // relative to its own largest singular value
  CHECK(null_space(tiny, rank_tolerance, 1.0).cols() == 4);  // beside one it is nothing
  CHECK(wide_range_space(tiny.cast<Wide>(), rank_tolerance, 1.0).cols() == 0);
}

TEST_CASE("matrices without rows or columns", "[unit]") {
  CHECK(null_space(Matrix(0, 3), rank_tolerance).isIdentity(0.0));
  CHECK(null_space(Matrix(3, 0), rank_tolerance).cols() == 0);
  CHECK(wide_range_space(WideMatrix(3, 0), rank_tolerance).rows() == 3);
  CHECK(wide_range_space(WideMatrix(0, 3), rank_tolerance).cols() == 0);
  const WideMatrix inverse = wide_pseudo_inverse(WideMatrix(0, 3), rank_tolerance);
  CHECK(inverse.rows() == 3);
  CHECK(inverse.cols() == 0);
  CHECK(null_space(Matrix::Zero(2, 3), rank_tolerance).cols() == 3);
}

TEST_CASE("the pseudoinverse meets Penrose's four conditions", "[unit]") {
  const Matrix m = rank_two();
  const Matrix p = wide_pseudo_inverse(m.cast<Wide>(), rank_tolerance).cast<double>();
  CHECK((m * p * m - m).norm() <= matrix_rounding);
  CHECK((p * m * p - p).norm() <= matrix_rounding);
  CHECK((m * p - (m * p).transpose()).norm() <= matrix_rounding);
  CHECK((p * m - (p * m).transpose()).norm() <= matrix_rounding);
}

// Singular values of [[3, 0], [4, 5]] are √45 and √5.
TEST_CASE("norms", "[unit]") {
  Matrix m(2, 2);
  m << 3, 0, 4, 5;
  CHECK(spectral_norm(m) == Approx(std::sqrt(45.0)));
  CHECK(spectral_norm(m.row(1)) == Approx(std::sqrt(41.0)));
  CHECK(spectral_norm(Matrix(0, 2)) == 0.0);
  m << 0, 1, -1, 0;
  CHECK(std::abs(logarithmic_norm(m)) <= matrix_rounding);
  m << -1, 4, 0, -1;  // symmetric part [[−1, 2], [2, −1]]
  CHECK(logarithmic_norm(m) == Approx(1.0));
  CHECK(logarithmic_norm(Matrix(0, 0)) == 0.0);
}

TEST_CASE("what is left of an exact cancellation becomes zero, what is small by itself stays", "[unit]") {
  Matrix x(1, 3), y(3, 2);
  x << 0.1, 0.2, -0.3;
  y << 1, 1e-20, 1, 0, 1, 0;
  REQUIRE((x * y)(0, 0) != 0.0);  // 0.1 + 0.2 − 0.3 in doubles
  const Matrix product = clean_product(x, y);
  CHECK(product(0, 0) == 0.0);
  CHECK(product(0, 1) == 0.1 * 1e-20);
}
