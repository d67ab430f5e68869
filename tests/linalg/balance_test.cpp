#include "linalg/balance.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace pwlsim::linalg;

namespace {

/// S⁻¹MS is what `balance` leaves, with powers of two.
void check_similar(const Matrix& original, const Matrix& balanced, const Vector& scale) {
  REQUIRE(scale.size() == original.rows());
  for (Eigen::Index i = 0; i < original.rows(); ++i) {
    CHECK(std::log2(scale[i]) == std::round(std::log2(scale[i])));
    for (Eigen::Index j = 0; j < original.rows(); ++j) CHECK(balanced(i, j) == original(i, j) / scale[i] * scale[j]);
  }
}

}  // namespace

// Two poles at -1 and -2: without the gain of 1e5 between them nothing grows.
TEST_CASE("a gain that only feeds forward is scaled away", "[unit]") {
  Matrix m(2, 2);
  m << -1.0, 0.0, 1e5, -2.0;
  Matrix balanced = m;
  check_similar(m, balanced, Vector::Ones(2));
  double growth = logarithmic_norm(m);
  const Vector scale = balance(balanced, growth);
  CHECK(growth == logarithmic_norm(balanced));
  check_similar(m, balanced, scale);
  CHECK(logarithmic_norm(m) > 1e4);
  CHECK(logarithmic_norm(balanced) < 0.0);
}

// Amplifiers behind one another, 1e10 together: scales of that size and not much more.
TEST_CASE("a chain of gains does not drift", "[unit]") {
  Matrix m = Matrix::Zero(4, 4);
  m.diagonal() << -1.0, -1e3, -1.0, -10.0;
  m(1, 0) = 1e5;
  m(2, 1) = 1e2;
  m(3, 2) = 1e3;
  Matrix balanced = m;
  double growth = logarithmic_norm(m);
  const Vector scale = balance(balanced, growth);
  CHECK(growth == logarithmic_norm(balanced));
  check_similar(m, balanced, scale);
  CHECK(logarithmic_norm(balanced) < 0.0);
  CHECK(scale.maxCoeff() / scale.minCoeff() < 1e13);
}

// x'' = -x in units that differ by 2^20: growth in the one, none in the other.
TEST_CASE("a ring whose units differ gets its own back", "[unit]") {
  const double unit = 1048576.0;
  Matrix m(2, 2);
  m << 0.0, unit, -1.0 / unit, 0.0;
  Matrix balanced = m;
  double growth = logarithmic_norm(m);
  const Vector scale = balance(balanced, growth);
  CHECK(growth == logarithmic_norm(balanced));
  check_similar(m, balanced, scale);
  CHECK(logarithmic_norm(balanced) == Approx(0.0).margin(1e-12));
}

TEST_CASE("what is balanced stays as it is", "[unit]") {
  Matrix m(2, 2);
  m << -1.0, 3.0, 2.0, -1.0;
  Matrix balanced = m;
  double growth = logarithmic_norm(balanced);
  CHECK(balance(balanced, growth).size() == 0);
  CHECK(balanced == m);
}
