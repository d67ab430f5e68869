/// Every solver on every class of problem; what they claim is held against the enumeration of complementary bases.
#include "lcp/solve.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <string>

#include "lcp/enumeration.hpp"
#include "lcp/lemke.hpp"
#include "lcp/newton_min.hpp"
#include "lcp/principal_pivoting.hpp"
#include "lcp/problem_classes.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using lcp::Method;
using lcp::Status;
using linalg::Matrix;
using linalg::Vector;

namespace {

constexpr double solver_agreement = 1e-8;  ///< of two ways to solve small random problems of order one
constexpr double tight = 1e-14;            ///< of problems whose answers are ratios of small integers

struct Solver {
  std::string name;
  unsigned promise;
  std::function<lcp::Solution(Problems&, const Matrix&, const Vector&)> run;
};

lcp::Solution as_solution(const lcp::AssessedSolution& a) { return {a.status, a.z, a.w, a.basis, a.pivots}; }

std::vector<int> any_set(Problems& random, const Vector& q) { return random.subset(static_cast<int>(q.size())); }

const std::vector<Solver>& solvers() {
  static const std::vector<Solver> all = {
      {"Lemke", by_lemke, [](Problems&, const Matrix& m, const Vector& q) { return lcp::lemke(m, q); }},
      {"Newton", by_newton, [](Problems&, const Matrix& m, const Vector& q) { return lcp::newton_min(m, q); }},
      {"Newton from any set", by_newton,
       [](Problems& r, const Matrix& m, const Vector& q) { return lcp::newton_min(m, q, any_set(r, q)); }},
      {"least index", by_least_index, [](Problems&, const Matrix& m, const Vector& q) { return lcp::least_index(m, q); }},
      {"driver", by_lemke, [](Problems&, const Matrix& m, const Vector& q) { return as_solution(lcp::solve(m, q)); }},
  };
  return all;
}

}  // namespace

TEST_CASE("every solver on every class, against enumeration", "[unit]") {
  const ProblemClass& problems = problem_classes()[static_cast<std::size_t>(GENERATE(range(0, 9)))];
  const Solver& solver = solvers()[static_cast<std::size_t>(GENERATE(range(0, 5)))];
  int solved = 0, without = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    INFO(problems.name << ", " << solver.name << ", seed " << seed);
    Problems random(seed);
    const int k = 1 + static_cast<int>(seed % 8);
    const Matrix m = problems.matrix(random, k);
    const Vector q = problems.right(random, m);
    const auto expected = enumerate(m, q);
    const lcp::Solution solution = solver.run(random, m, q);
    if (expected.empty()) ++without;
    if (!expected.empty() && (problems.promised & solver.promise) != 0) REQUIRE(solution.status == Status::solved);
    if (solution.status != Status::solved) continue;
    ++solved;
    CHECK(is_among(solution.z, expected, solver_agreement));
    CHECK(lcp::residual(m, q, solution.z) <= solver_agreement);
    CHECK(lcp::assess(m, q, solution.z).worst() <= solver_agreement);
  }
  CHECK(solved > 10);
  if (problems.name == "semidefinite, any") CHECK(without > 10);
}

TEST_CASE("classes whose solution is unique have one, the same from every solver", "[unit]") {
  for (const auto& problems : problem_classes()) {
    if ((problems.promised & by_least_index) == 0) continue;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      INFO(problems.name << ", seed " << seed);
      Problems random(seed);
      const Matrix m = problems.matrix(random, 2 + static_cast<int>(seed % 7));
      const Vector q = problems.right(random, m);
      const auto expected = enumerate(m, q);
      REQUIRE(expected.size() == 1);
    }
  }
}

// The transform of a transform, by the definition: w_α and z_α change places in w = M z + q.
TEST_CASE("a principal pivot transform keeps the solutions of w = Mz + q", "[unit]") {
  constexpr double least_determinant = 1e-3;  // of entries of order one: the exchange loses three digits at most
  int exchanged = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 2 + static_cast<int>(seed % 6);
    const Matrix m = seed % 2 == 0 ? random.matrix(k, k) : random.semidefinite(k, 1);
    const Vector q = random.vector(k);
    lcp::PrincipalTableau tableau(m, q);
    const std::vector<int> wanted = random.subset(k);
    if (wanted.empty() || std::abs(Matrix(m(wanted, wanted)).determinant()) < least_determinant) continue;
    ++exchanged;
    tableau.exchange(wanted);
    CHECK(tableau.basis() == wanted);
    const Vector z = random.vector(k);
    const Vector w = m * z + q;
    Vector z_now = z, w_now = w;
    for (const int i : tableau.basis()) std::swap(z_now[i], w_now[i]);
    CHECK((tableau.m() * z_now + tableau.q() - w_now).norm() <= solver_agreement * (1.0 + tableau.m().norm()));
  }
  CHECK(exchanged > 20);
}

// Ben Gharbia and Gilbert, INRIA RR-7160: from {1} Newton's method goes around. z = (1, 1, 1)/3.
TEST_CASE("35: Newton cycles, the others do not", "[hard]") {
  Matrix m(3, 3);
  m << 1, 0, 2, 2, 1, 0, 0, 2, 1;
  const Vector q = Vector::Constant(3, -1.0);
  const Vector expected = Vector::Constant(3, 1.0 / 3.0);
  CHECK(lcp::newton_min(m, q, {0}).status == Status::cycle);
  const lcp::Solution least = lcp::least_index(m, q);
  REQUIRE(least.status == Status::solved);
  CHECK((least.z - expected).norm() <= tight);
  const lcp::AssessedSolution answer = lcp::solve(m, q);
  REQUIRE(answer.status == Status::solved);
  CHECK(answer.method == Method::lemke);
  CHECK(answer.assessment.worst() <= tight);
}

// y = q − u: two solutions for q > 0, none for q < 0.
TEST_CASE("34: many solutions and none, from every solver", "[hard]") {
  const Matrix m = Matrix::Constant(1, 1, -1.0);
  Problems random(34);
  for (const auto& solver : solvers()) {
    INFO(solver.name);
    const lcp::Solution two = solver.run(random, m, Vector::Constant(1, 2.0));
    if (two.status == Status::solved) CHECK((two.z[0] == 0.0 || two.z[0] == 2.0));
    CHECK(solver.run(random, m, Vector::Constant(1, -2.0)).status != Status::solved);
  }
  CHECK(lcp::solve(m, Vector::Constant(1, -2.0)).status == Status::ray);
  CHECK(lcp::solve(m, Vector::Constant(1, -2.0)).method == Method::none);
}

// Lemke's path can end in a ray although there is a solution, where M has no structure.
TEST_CASE("the driver falls back and says so", "[unit]") {
  int by_others = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 2 + static_cast<int>(seed % 4);
    const Matrix m = random.matrix(k, k);
    const Vector q = random.vector(k);
    const lcp::AssessedSolution answer = lcp::solve(m, q);
    if (answer.status != Status::solved) {
      CHECK(answer.method == Method::none);
      continue;
    }
    CHECK(answer.assessment.worst() <= lcp::acceptable_residual);
    CHECK(is_among(answer.z, enumerate(m, q), solver_agreement));
    if (answer.method != Method::lemke) ++by_others;
  }
  CHECK(by_others > 5);
}

// Rows of a stiff network differ by twelve powers of ten; scaling by powers of two changes no digit of the data.
TEST_CASE("units of the ports do not matter", "[unit]") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    INFO("seed " << seed);
    Problems random(seed);
    const int k = 2 + static_cast<int>(seed % 5);
    const Matrix m = random.semidefinite(k, k) + 0.05 * Matrix::Identity(k, k);
    const Vector q = random.vector(k);
    const Vector units = random.vector(k).unaryExpr([](double e) { return std::exp2(std::round(20.0 * e)); });
    const lcp::AssessedSolution plain = lcp::solve(m, q);
    const lcp::AssessedSolution scaled = lcp::solve(units.asDiagonal() * m * units.asDiagonal(), units.asDiagonal() * q);
    REQUIRE(plain.status == Status::solved);
    REQUIRE(scaled.status == Status::solved);
    CHECK((units.cwiseProduct(scaled.z) - plain.z).norm() <= solver_agreement * (1.0 + plain.z.norm()));
    CHECK(scaled.basis == plain.basis);
  }
}

TEST_CASE("large problems of all classes are solved to rounding", "[unit]") {
  const int k = GENERATE(40, 150);
  for (const auto& problems : problem_classes()) {
    if ((problems.promised & by_lemke) == 0) continue;
    Problems random(static_cast<std::uint64_t>(k));
    const Matrix m = problems.matrix(random, k);
    const Vector q = problems.name == "semidefinite, any" ? feasible_right(random, m) : problems.right(random, m);
    const lcp::AssessedSolution answer = lcp::solve(m, q);
    INFO(problems.name << " " << k);
    REQUIRE(answer.status == Status::solved);
    CHECK(answer.assessment.worst() <= lcp::acceptable_residual);
  }
}

TEST_CASE("an assessment measures what is wrong, each against its scale", "[unit]") {
  const Matrix m = Matrix::Identity(2, 2);
  Vector q(2), z(2);
  q << -2, 4;
  z << 2, 0;  // w = (0, 4)
  CHECK(lcp::assess(m, q, z).worst() == 0.0);
  z << 1, 0;  // w = (−1, 4)
  const lcp::Assessment low = lcp::assess(m, q, z);
  CHECK(low.scale_w == 4.0);
  CHECK(low.negative_w == 0.25);
  CHECK(low.negative_z == 0.0);
  z << 2, -1;  // w = (0, 3)
  CHECK(lcp::assess(m, q, z).negative_z == 0.5);
  z << 2, 1;  // w = (0, 5): z2 is half of max z, w2 more than max q
  const lcp::Assessment both = lcp::assess(m, q, z);
  CHECK(both.complementarity == 0.5);
  CHECK(both.power == 5.0 / (2 * 2 * 4));
  z << NAN, 0;
  CHECK(lcp::assess(m, q, z).worst() == INFINITY);
  CHECK(lcp::assess(Matrix(0, 0), Vector(0), Vector(0)).worst() == 0.0);
}

TEST_CASE("empty problems", "[unit]") {
  const Matrix m(0, 0);
  const Vector q(0);
  CHECK(lcp::newton_min(m, q).status == Status::solved);
  CHECK(lcp::least_index(m, q).status == Status::solved);
  CHECK(lcp::solve(m, q).status == Status::solved);
}
