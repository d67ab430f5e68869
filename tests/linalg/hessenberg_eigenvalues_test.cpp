#include "linalg/hessenberg_eigenvalues.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace pwlsim::linalg;

namespace {

using Values = std::vector<std::complex<double>>;

/// The companion matrix of Π (x − root), whose eigenvalues these roots are.
Matrix companion(const Values& roots) {
  Values polynomial{1.0};
  for (const auto& root : roots) {
    polynomial.insert(polynomial.begin(), 0.0);
    for (std::size_t k = 0; k + 1 < polynomial.size(); ++k) polynomial[k] -= root * polynomial[k + 1];
  }
  const auto n = static_cast<Eigen::Index>(roots.size());
  Matrix m = Matrix::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) m(i, n - 1) = -polynomial[static_cast<std::size_t>(i)].real();
  for (Eigen::Index i = 1; i < n; ++i) m(i, i - 1) = 1.0;
  return m;
}

void check_roots(const Values& roots) {
  const Values found = hessenberg_eigenvalues(companion(roots));
  REQUIRE(found.size() == roots.size());
  constexpr double close = 1e-10;  // the condition of such roots is below 1e5
  for (const auto& root : roots)
    CHECK(std::any_of(found.begin(), found.end(), [&](const auto& value) { return std::abs(value - root) < close; }));
}

}  // namespace

TEST_CASE("eigenvalues of companion matrices are the roots", "[unit]") {
  check_roots({3.0});
  check_roots({2.0, -1.0});
  check_roots({{1.0, 2.0}, {1.0, -2.0}});
  check_roots({-1.0, -2.0, -3.0, -4.0, 0.5});
  check_roots({{0.0, 1.0}, {0.0, -1.0}, {-1.0, 3.0}, {-1.0, -3.0}, 2.0});
}

// All on the unit circle: steps without other shifts now and then would turn in a circle, too.
TEST_CASE("a cyclic permutation has the roots of one", "[unit]") {
  for (const int n : {3, 4, 8}) {
    Values roots;
    for (int k = 0; k < n; ++k) roots.push_back(std::polar(1.0, 2.0 * std::numbers::pi * k / n));
    check_roots(roots);
  }
}

TEST_CASE("what is no number has no eigenvalues", "[unit]") {
  CHECK(hessenberg_eigenvalues(Matrix::Constant(3, 3, NAN)).empty());
  CHECK(hessenberg_eigenvalues(Matrix(0, 0)).empty());
}
