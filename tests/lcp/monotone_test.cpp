/// What is not unique in singular monotone problems, and the least norm among the solutions, against a search of all 3^k faces.
#include "lcp/monotone.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "lcp/enumeration.hpp"
#include "lcp/lemke.hpp"
#include "lcp/principal_pivoting.hpp"
#include "lcp/solve.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using lcp::Status;
using linalg::Matrix;
using linalg::Vector;

namespace {

constexpr double agreement = 1e-8;  ///< of two ways to solve small random problems of order one
constexpr double tight = 1e-13;     ///< of problems whose answers are ratios of small integers
constexpr int targets = 40;         ///< random points whose nearest solutions show what varies
constexpr double reach = 30.0;      ///< size of those, larger than any vertex
constexpr double variation = 1e-6;  ///< entries that vary by less between those are determined

struct Extent {
  lcp::SolutionSet least;
  std::vector<char> z_determined, w_determined;
};

/// Projects random points on the set of solutions.
Extent by_search(Problems& random, const Matrix& m, const Vector& q) {
  const auto k = static_cast<int>(q.size());
  const Point least = nearest_solution(m, q, Vector::Zero(k), Vector::Zero(k));
  REQUIRE(least.exists);
  Extent extent;
  extent.least.z = least.z;
  extent.least.w = least.w;
  Vector spread_z = Vector::Zero(k), spread_w = Vector::Zero(k);
  for (int i = 0; i < targets; ++i) {
    const Point other = nearest_solution(m, q, reach * random.vector(k), reach * random.vector(k));
    spread_z = spread_z.cwiseMax((other.z - least.z).cwiseAbs());
    spread_w = spread_w.cwiseMax((other.w - least.w).cwiseAbs());
  }
  for (int i = 0; i < k; ++i) {
    extent.z_determined.push_back(spread_z[i] <= variation);
    extent.w_determined.push_back(spread_w[i] <= variation);
  }
  return extent;
}

/// Small integers, so that there are ties and degenerate solutions.
Matrix integer_semidefinite(Problems& random, int k) {
  const int rank = random.below(k);
  const Matrix g = random.matrix(k, rank).unaryExpr([](double x) { return std::round(1.6 * x); });
  const Matrix s = random.matrix(k, k).unaryExpr([](double x) { return std::round(0.8 * x); });
  return g * g.transpose() + s - s.transpose();
}

}  // namespace

TEST_CASE("least norm and what is indeterminate, against a search of all faces", "[unit]") {
  int problems = 0, indeterminate = 0, degenerate = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 1 + static_cast<int>(seed % 4);
    const Matrix m = integer_semidefinite(random, k);
    const Vector q = random.vector(k).unaryExpr([](double x) { return std::round(1.6 * x); });
    const lcp::Answer answer = lcp::solve(m, q, lcp::Class::monotone);
    const Point any = nearest_solution(m, q, Vector::Zero(k), Vector::Zero(k));
    REQUIRE((answer.status == Status::solved) == any.exists);
    if (!any.exists) {
      CHECK(answer.status == Status::ray);
      continue;
    }
    ++problems;
    const Extent expected = by_search(random, m, q);
    CHECK(answer.z_determined == expected.z_determined);
    CHECK(answer.w_determined == expected.w_determined);
    CHECK(answer.determined == (lcp::all_solutions(m, q, answer.z).dimension == 0));
    CHECK((answer.z - expected.least.z).norm() <= agreement * (1.0 + expected.least.z.norm()));
    CHECK((answer.w - expected.least.w).norm() <= agreement * (1.0 + expected.least.w.norm()));
    CHECK(answer.assessment.worst() <= lcp::acceptable_residual);
    if (!answer.determined) ++indeterminate;
    if ((answer.z + answer.w).minCoeff() == 0.0) ++degenerate;
  }
  CHECK(problems > 300);
  CHECK(indeterminate > 100);
  CHECK(degenerate > 50);
}

// M + εI has one solution; for ε → 0 it tends to the solution of least |z| (Cottle, Pang, Stone, Theorem 5.6.2), which with symmetric M is that of
// least |z|² + |w|², because w is then the same for all.
TEST_CASE("the least norm of symmetric problems is the limit of Tikhonov's", "[unit]") {
  constexpr double epsilon = 1e-8;
  constexpr double limit_agreement = 1e-5;  ///< of the extrapolation to ε = 0 from ε and ε/10
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 3 + static_cast<int>(seed % 10);
    const int rank = k / 2;
    const Matrix orthonormal = Eigen::HouseholderQR<Matrix>(random.matrix(k, rank)).householderQ() * Matrix::Identity(k, rank);
    const Vector values = Vector::Constant(rank, 1.0) + 0.5 * random.vector(rank);
    const Matrix m = orthonormal * values.asDiagonal() * orthonormal.transpose();
    const Vector q = m * random.vector(k);
    const lcp::Answer answer = lcp::solve(m, q, lcp::Class::monotone);
    REQUIRE(answer.status == Status::solved);
    const lcp::Solution near = lcp::lemke(m + epsilon * Matrix::Identity(k, k), q);
    const lcp::Solution nearer = lcp::lemke(m + 0.1 * epsilon * Matrix::Identity(k, k), q);
    REQUIRE(near.status == Status::solved);
    REQUIRE(nearer.status == Status::solved);
    const Vector limit = (10.0 * nearer.z - near.z) / 9.0;
    CHECK((answer.z - limit).norm() <= limit_agreement * (1.0 + limit.norm()));
  }
}

// Which of a port's two variables is called z is the model's choice and may not show in the answer.
TEST_CASE("the answer does not depend on which variable is called z", "[unit]") {
  int exchanged = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 2 + static_cast<int>(seed % 6);
    const Matrix m = integer_semidefinite(random, k);
    const Vector q = -(m * random.vector(k));
    lcp::PrincipalTableau other(m, q);
    exchanged += other.exchange_most(random.subset(k));
    const lcp::Answer a = lcp::solve(m, q, lcp::Class::monotone);
    const lcp::Answer b = lcp::solve(other.m(), other.q(), lcp::Class::monotone);
    REQUIRE(a.status == b.status);
    if (a.status != Status::solved) continue;
    for (int i = 0; i < k; ++i) {
      const bool swapped = other.exchanged()[static_cast<std::size_t>(i)];
      const auto at = static_cast<std::size_t>(i);
      CHECK(a.z[i] == Approx(swapped ? b.w[i] : b.z[i]).margin(agreement));
      CHECK(a.w[i] == Approx(swapped ? b.z[i] : b.w[i]).margin(agreement));
      CHECK(a.z_determined[at] == (swapped ? b.w_determined[at] : b.z_determined[at]));
    }
  }
  CHECK(exchanged > 100);
}

// Two diodes in parallel carry 1 A: half each (hard case 27). z: currents; v = 1·(i1 + i2 − 1) blocks.
TEST_CASE("27: parallel diodes share by least norm, and say so", "[hard]") {
  const lcp::Answer answer = lcp::solve(Matrix::Ones(2, 2), Vector::Constant(2, -1.0), lcp::Class::monotone);
  REQUIRE(answer.status == Status::solved);
  CHECK_FALSE(answer.determined);
  CHECK((answer.z - Vector::Constant(2, 0.5)).norm() <= tight);
  CHECK(answer.z_determined == std::vector<char>{0, 0});
  CHECK(answer.w_determined == std::vector<char>{1, 1});
}

// Two diodes in series block 1 V; z: blocking voltages p1, p2; w: currents. Nothing fixes the midpoint but p1 + p2 = 1 (hard case 26):
// with a resistor of 1 Ω and a source of −1 V in the loop i = p1 + p2 − 1 in both. Least norm: half each.
TEST_CASE("26: the midpoint of two blocking diodes floats", "[hard]") {
  const lcp::Answer answer = lcp::solve(Matrix::Ones(2, 2), Vector::Constant(2, -1.0), lcp::Class::monotone);
  CHECK((answer.z - Vector::Constant(2, 0.5)).norm() <= tight);
  // The same circuit with z = (p1, i2), w = (i1, p2): i1 = i2, p2 = 1 − p1 + i2. Half each again.
  Matrix m(2, 2);
  m << 0, 1, -1, 1;
  Vector q(2);
  q << 0, 1;
  const lcp::Answer hybrid = lcp::solve(m, q, lcp::Class::monotone);
  REQUIRE(hybrid.status == Status::solved);
  CHECK_FALSE(hybrid.determined);
  CHECK(hybrid.z[0] == Approx(0.5));
  CHECK(hybrid.w[1] == Approx(0.5));
  CHECK(hybrid.z[1] == 0.0);
  CHECK(hybrid.z_determined == std::vector<char>{0, 1});
  CHECK(hybrid.w_determined == std::vector<char>{1, 0});
}

// Diodes a→b→c→a, 1 A drawn from b and fed into c: i = (1, 0, 1) + t (1, 1, 1), t ≥ 0; least norm t = 0 (hard case 25). The potentials are equal and
// otherwise free; least norm: zero.
TEST_CASE("25: the current around a ring of diodes", "[hard]") {
  // Ports: three currents; three pairs of potentials, v = v⁺ − v⁻ with w = ±(balance). Skew.
  Matrix incidence(3, 3);  // node × diode: current out of the node
  incidence << 1, 0, -1, -1, 1, 0, 0, -1, 1;
  Matrix m = Matrix::Zero(9, 9);
  m.block(0, 3, 3, 3) = -incidence.transpose();  // blocking voltage of a→b: v_b − v_a
  m.block(0, 6, 3, 3) = incidence.transpose();
  m.block(3, 0, 3, 3) = incidence;
  m.block(6, 0, 3, 3) = -incidence;
  Vector q = Vector::Zero(9);
  q.segment(3, 3) << 0, 1, -1;  // balance of a, b, c: current out into diodes + drawn by the source
  q.segment(6, 3) << 0, -1, 1;
  const lcp::Answer answer = lcp::solve(m, q, lcp::Class::monotone);
  REQUIRE(answer.status == Status::solved);
  CHECK((answer.z.head(3) - Eigen::Vector3d(1, 0, 1)).norm() <= tight);
  CHECK(answer.w.head(3).norm() <= tight);
  for (const int i : {0, 1, 2}) {
    CHECK_FALSE(answer.z_determined[static_cast<std::size_t>(i)]);
    CHECK(answer.w_determined[static_cast<std::size_t>(i)]);
  }
}

TEST_CASE("problems with one solution are left as they are", "[unit]") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 1 + static_cast<int>(seed % 8);
    const Matrix m = random.semidefinite(k, k) + 0.05 * Matrix::Identity(k, k);
    const Vector q = random.vector(k);
    const lcp::Answer answer = lcp::solve(m, q, lcp::Class::monotone);
    REQUIRE(answer.status == Status::solved);
    CHECK(answer.determined);
    CHECK(answer.z == lcp::solve(m, q).z);
  }
}

TEST_CASE("monotone is what the smallest eigenvalue of the symmetric part says", "[unit]") {
  CHECK(lcp::is_monotone(Matrix::Ones(3, 3)));
  CHECK_FALSE(lcp::is_monotone(-Matrix::Ones(1, 1)));
  Matrix m(2, 2);
  m << 1, 3, -1, 1;  // symmetric part [[1, 1], [1, 1]]
  CHECK(lcp::is_monotone(m));
  m(0, 1) = 3.001;
  CHECK_FALSE(lcp::is_monotone(m));
  CHECK(lcp::is_monotone(Matrix(0, 0)));
}
