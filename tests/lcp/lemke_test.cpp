/// Lemke's method against the definition: all 2^k bases tried one by one.
#include "lcp/lemke.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "lcp/enumeration.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using lcp::Status;
using linalg::Matrix;
using linalg::Vector;

namespace {

constexpr double lemke_agreement = 1e-9;  ///< of two ways to solve small random problems of order one

void check_claims(const Matrix& m, const Vector& q, const lcp::Solution& solution) {
  CHECK((m * solution.z + q - solution.w).cwiseAbs().maxCoeff() <= lemke_agreement * (1.0 + solution.w.norm()));
  CHECK(lcp::residual(m, q, solution.z) <= lemke_agreement);
  CHECK(std::is_sorted(solution.basis.begin(), solution.basis.end()));
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (std::find(solution.basis.begin(), solution.basis.end(), static_cast<int>(i)) == solution.basis.end()) CHECK(solution.z[i] == 0.0);
  if (!solution.basis.empty()) CHECK(Eigen::FullPivLU<Matrix>(m(solution.basis, solution.basis)).isInvertible());
}

}  // namespace

TEST_CASE("positive definite problems have the one solution that enumeration finds", "[unit]") {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 1 + static_cast<int>(seed % 6);
    const Matrix m = random.semidefinite(k, k) + 0.05 * Matrix::Identity(k, k);
    const Vector q = random.vector(k);
    const auto expected = enumerate(m, q);
    REQUIRE(expected.size() == 1);
    const lcp::Solution solution = lcp::lemke(m, q);
    REQUIRE(solution.status == Status::solved);
    CHECK((solution.z - expected.front()).norm() <= lemke_agreement * (1.0 + expected.front().norm()));
    check_claims(m, q, solution);
  }
}

TEST_CASE("semidefinite problems are solved exactly when enumeration finds a solution", "[unit]") {
  int solvable = 0, infeasible = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    INFO("seed " << seed);
    Problems random(1000 + seed);
    const int k = 2 + static_cast<int>(seed % 5);
    // Half of them without skew part, so that rank is really lost and solutions may be absent.
    const Matrix g = random.matrix(k, 1 + static_cast<int>(seed % 3 == 0));
    const Matrix m = seed % 2 == 0 ? random.semidefinite(k, 1) : Matrix(g * g.transpose());
    const Vector q = random.vector(k);
    const auto expected = enumerate(m, q);
    const lcp::Solution solution = lcp::lemke(m, q);
    if (expected.empty()) {
      ++infeasible;
      CHECK(solution.status == Status::ray);
      continue;
    }
    ++solvable;
    REQUIRE(solution.status == Status::solved);
    check_claims(m, q, solution);
    CHECK(is_among(solution.z, expected, lemke_agreement));
    // (M + Mᵀ) z is the same for all solutions of a semidefinite problem (Cottle, Pang, Stone, theorem 3.1.7).
    const Matrix symmetric = m + m.transpose();
    CHECK((symmetric * (solution.z - expected.front())).norm() <= lemke_agreement * (1.0 + expected.front().norm()));
  }
  CHECK(solvable > 50);
  CHECK(infeasible > 50);
}

TEST_CASE("without negative q the answer is zero", "[unit]") {
  Problems random(7);
  const Matrix m = random.matrix(4, 4);
  const Vector q = random.vector(4).cwiseAbs();
  const lcp::Solution solution = lcp::lemke(m, q);
  CHECK(solution.status == Status::solved);
  CHECK(solution.z.isZero(0.0));
  CHECK(solution.w == q);
  CHECK(solution.pivots == 0);
  CHECK(lcp::lemke(m, Vector::Zero(4)).z.isZero(0.0));
  CHECK(lcp::lemke(Matrix(0, 0), Vector(0)).status == Status::solved);
}

// y = q − u: two solutions for q > 0, u = 0 and u = q; none for q < 0 (hard case 34).
TEST_CASE("34: M = -1", "[hard]") {
  const Matrix m = Matrix::Constant(1, 1, -1.0);
  const lcp::Solution positive = lcp::lemke(m, Vector::Constant(1, 2.0));
  REQUIRE(positive.status == Status::solved);
  CHECK((positive.z[0] == 0.0 || positive.z[0] == 2.0));
  CHECK(lcp::residual(m, Vector::Constant(1, 2.0), positive.z) == 0.0);
  CHECK(lcp::lemke(m, Vector::Constant(1, -2.0)).status == Status::ray);
}

// A P-matrix on which Newton's method cycles (Ben Gharbia and Gilbert, INRIA RR-7160; hard case 35): z = (1, 1, 1)/3.
TEST_CASE("35: a P-matrix on which others cycle", "[hard]") {
  Matrix m(3, 3);
  m << 1, 0, 2, 2, 1, 0, 0, 2, 1;
  const Vector q = Vector::Constant(3, -1.0);
  const lcp::Solution solution = lcp::lemke(m, q);
  REQUIRE(solution.status == Status::solved);
  CHECK((solution.z - Vector::Constant(3, 1.0 / 3.0)).cwiseAbs().maxCoeff() <= 1e-15);
  CHECK(solution.basis == std::vector<int>{0, 1, 2});
}

// Skew M: w1 = z2 + q1, w2 = −z1 + q2. For q = (−1, −1) w2 < 0 whatever z ≥ 0 is.
TEST_CASE("an infeasible skew problem ends in a ray, a feasible one does not", "[unit]") {
  Matrix m(2, 2);
  m << 0, 1, -1, 0;
  CHECK(lcp::lemke(m, Vector::Constant(2, -1.0)).status == Status::ray);
  Vector q(2);
  q << -1, 1;  // z2 = 1, z1 ≤ 1
  const lcp::Solution solution = lcp::lemke(m, q);
  REQUIRE(solution.status == Status::solved);
  CHECK(solution.z[1] == Approx(1.0));
}

// A problem and its mirror under a permutation have mirrored solutions; equal rows give ties, which must not make it cycle.
TEST_CASE("ties do not cycle", "[unit]") {
  for (const int k : {2, 5, 20}) {
    const Matrix m = Matrix::Identity(k, k) + Matrix::Ones(k, k);
    const lcp::Solution solution = lcp::lemke(m, Vector::Constant(k, -1.0));
    REQUIRE(solution.status == Status::solved);
    // (I + 11ᵀ) z = 1: z = 1/(1 + k).
    CHECK((solution.z - Vector::Constant(k, 1.0 / (1.0 + k))).cwiseAbs().maxCoeff() <= 1e-14);
  }
}

TEST_CASE("large problems are solved to rounding", "[unit]") {
  for (const int k : {50, 150}) {
    Problems random(static_cast<std::uint64_t>(k));
    const Matrix m = random.semidefinite(k, k / 2) / k;
    const Vector feasible = random.vector(k).cwiseMax(0.0);
    const Vector slack = random.vector(k).cwiseAbs();
    const Vector q = slack - m * feasible;  // z = feasible gives w = slack ≥ 0, so the problem is feasible and thus solvable
    const lcp::Solution solution = lcp::lemke(m, q);
    REQUIRE(solution.status == Status::solved);
    CHECK(lcp::residual(m, q, solution.z) <= 1e-10);
  }
}

TEST_CASE("the residual measures what is wrong", "[unit]") {
  const Matrix m = Matrix::Identity(2, 2);
  Vector q(2), z(2);
  q << -2, 3;
  z << 2, 0;  // w = (0, 3)
  CHECK(lcp::residual(m, q, z) == 0.0);
  z << 0, 0;  // w = (−2, 3): off by 2, of 3
  CHECK(lcp::residual(m, q, z) == Approx(2.0 / 3.0));
  z << 2, 1;  // w = (0, 4): min(1, 4) = 1, of 3
  CHECK(lcp::residual(m, q, z) == Approx(1.0 / 3.0));
  z << 2, -1;
  CHECK(lcp::residual(m, q, z) == Approx(1.0 / 3.0));
}

// Three currents into one node that is otherwise held by a large inductance (ε): w3 = −w4, so that both are zero, then z3 − z4 = 1/(3ε), the others
// zero. Ratios of 10⁷ are equal there, but not as rounded.
TEST_CASE("equal ratios of a small entry are a tie", "[unit]") {
  for (const double epsilon : {1e-4, 1e-6, 1e-8}) {
    Matrix m(6, 6);
    m << 0.1 * epsilon, 0, 64, -64, 0, 0.1 * epsilon, 0, 0, 0, 0, 0, -64, -64, 0, epsilon, -epsilon, 0, -64, 64, 0, -epsilon, epsilon, 0,
        64, 0, 0, 0, 0, 0, 64, 0.1 * epsilon, 64, 64, -64, -64, 0.1 * epsilon;
    Vector q(6);
    q << -8, 0, -1.0 / 3.0, 1.0 / 3.0, 0, -8;
    const lcp::Solution solution = lcp::lemke(m, q);
    REQUIRE(solution.status == Status::solved);
    const double rounding = 64.0 / epsilon * std::numeric_limits<double>::epsilon();
    CHECK(solution.z[2] * epsilon == Approx(1.0 / 3.0).epsilon(rounding));
    CHECK(solution.z.sum() == Approx(solution.z[2]).epsilon(rounding));
  }
}
