#include "linalg/fast_decays.hpp"

#include <catch2/catch.hpp>

using pwlsim::linalg::fast_part;
using pwlsim::linalg::Matrix;
using pwlsim::linalg::rates_by_speed;
using pwlsim::linalg::Vector;

namespace {

/// V diag(−10⁹, −2·10⁹, −3, −5) V⁻¹; V and its inverse have whole numbers.
const Matrix vectors = (Matrix(4, 4) << 1, 2, 0, 1, 0, 1, 3, 0, 0, 0, 1, 2, 0, 0, 0, 1).finished();
const Matrix inverse = (Matrix(4, 4) << 1, -2, 6, -13, 0, 1, -3, 6, 0, 0, 1, -2, 0, 0, 0, 1).finished();

}  // namespace

TEST_CASE("fast decays are told from the slow motion", "[unit]") {
  const Matrix a = vectors * Vector((Vector(4) << -1e9, -2e9, -3.0, -5.0).finished()).asDiagonal() * inverse;
  const auto part = fast_part(a, rates_by_speed(a));
  REQUIRE(part);
  REQUIRE(part->fast.cols() == 2);
  // By eigenvectors: what is fast of x is V diag(1, 1, 0, 0) V⁻¹ x.
  const Matrix expected = vectors.leftCols(2) * inverse.topRows(2);
  CHECK((part->fast * part->coordinates - expected).cwiseAbs().maxCoeff() < 1e-13 * expected.cwiseAbs().maxCoeff());
}

TEST_CASE("a ring is no fast decay, and equal rates have none", "[unit]") {
  const Matrix ring = (Matrix(3, 3) << 0, 1e9, 0, -1e9, 0, 0, 0, 0, -1).finished();
  CHECK_FALSE(fast_part(ring, rates_by_speed(ring)));
  const Matrix alike = -Matrix::Identity(3, 3);
  CHECK_FALSE(fast_part(alike, rates_by_speed(alike)));
}

TEST_CASE("the fastest of several decays are told from the rest in extended precision", "[unit]") {
  using pwlsim::linalg::WideMatrix;
  constexpr double fastest = -1e14;
  const Matrix a = vectors * Vector((Vector(4) << fastest, -1e9, -3.0, -5.0).finished()).asDiagonal() * inverse;
  const auto part = fast_part(a, 1);
  REQUIRE(part);
  REQUIRE(part->fast.cols() == 1);
  // V's first column is e1, and A e1 is exact in double: its direction has the digits of extended precision, and so do the coordinates of an invariant subspace of that A.
  const WideMatrix wide = a.cast<long double>();
  CHECK(static_cast<double>((wide * part->fast - static_cast<long double>(fastest) * part->fast).norm()) <= 1e-18 * -fastest);
  CHECK(static_cast<double>((part->coordinates * part->fast - WideMatrix::Identity(1, 1)).norm()) <= 1e-17);
}

// With a gap of a hundred between rates and a shift of 8 to 16 times the slow one, a turn leaves up to 0.15 of the error: iterations that took more than a tenth for rounding stopped after the fourth.
TEST_CASE("a subspace is found to all its digits where each turn gains little", "[unit]") {
  using pwlsim::linalg::WideMatrix;
  const Matrix s = vectors * Vector((Vector(4) << 1.0, 0.9, 0.15, 0.1).finished()).asDiagonal() * inverse;
  const WideMatrix wide = s.cast<long double>(), basis = pwlsim::linalg::dominant_subspace(wide, wide, 2);
  const WideMatrix image = wide * basis;
  CHECK(static_cast<double>((image - basis * (basis.transpose() * image)).norm()) <= 1e-17 * static_cast<double>(image.norm()));
}
