#include "model/static_neighbours.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "model/handmade_systems.hpp"
#include "support/random.hpp"

namespace {

using namespace pwlsim;
using namespace pwlsim::model;
using linalg::Matrix;
using linalg::Vector;

constexpr double clear = 1e-6;  ///< of numbers near one: what is nearer to zero decides nothing

enum class Solved { yes, no, open };

/// Whether 0 ≤ u ⊥ q + D u ≥ 0 has a solution with that active set, by its equations written out.
Solved solves(const Matrix& d, const Vector& q, unsigned active) {
  std::vector<int> on, off;
  for (int i = 0; i < q.size(); ++i) ((active >> static_cast<unsigned>(i)) & 1U ? on : off).push_back(i);
  Vector u = Vector::Zero(q.size());
  if (!on.empty()) {
    const Eigen::FullPivLU<Matrix> factors(Matrix(d(on, on)));
    const auto last = static_cast<Eigen::Index>(on.size()) - 1;
    if (std::abs(factors.matrixLU()(last, last)) < clear) return Solved::open;
    u(on) = -factors.solve(Vector(q(on)));
  }
  const Vector y = q + d * u;
  double least = 1.0;
  for (const int i : on) least = std::min(least, u[i]);
  for (const int i : off) least = std::min(least, y[i]);
  return least > clear ? Solved::yes : least < -clear ? Solved::no : Solved::open;
}

IndexSet set_of(unsigned active, int ports) {
  IndexSet set(ports);
  for (int i = 0; i < ports; ++i) set.set(i, ((active >> static_cast<unsigned>(i)) & 1U) != 0);
  return set;
}

}  // namespace

TEST_CASE("neighbours at an instant: as the equations of each say", "[unit]") {
  constexpr int ports = 5;
  int solutions = 0, refusals = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    test::Random random(seed);
    CAPTURE(seed);
    const Matrix d = Matrix::NullaryExpr(ports, ports, [&] { return random.chance(0.3) ? 0.0 : random.between(-1.0, 1.0); });
    const Vector q = Vector::NullaryExpr(ports, [&] { return random.between(-0.5, 1.0); });
    System system = test::handmade(Matrix::Zero(ports, ports), Matrix::Zero(ports, ports), Matrix::Identity(ports, ports), d);
    for (unsigned active = 0; active < 1U << ports; ++active) {
      if (solves(d, q, active) != Solved::yes) continue;
      const StaticNeighbours neighbours(system, set_of(active, ports), q.data(), q.norm());
      for (int i = 0; i < ports; ++i)
        for (int j = i; j < ports; ++j) {
          const unsigned flips = 1U << static_cast<unsigned>(i) | 1U << static_cast<unsigned>(j);
          const Solved expected = solves(d, q, active ^ flips);
          if (expected == Solved::open) continue;
          CAPTURE(active, i, j);
          CHECK((i == j ? neighbours.may_flip(i) : neighbours.may_flip(i, j)) == (expected == Solved::yes));
          ++(expected == Solved::yes ? solutions : refusals);
        }
    }
  }
  CHECK(solutions > 50);
  CHECK(refusals > 1000);
}

TEST_CASE("neighbours at an instant: what derivatives decide is left open", "[unit]") {
  // y1 = x1, whatever u is: active at x1 = 0. y2 = x2 + u2 stays positive without u2, and y3 = x3 − u3 has two solutions.
  Matrix d = Matrix::Zero(3, 3);
  d(1, 1) = 1.0;
  d(2, 2) = -1.0;
  System system = test::handmade(Matrix::Zero(3, 3), Matrix::Identity(3, 3), Matrix::Identity(3, 3), d);
  const Vector x = (Vector(3) << 0.0, 1.0, 2.0).finished();
  const StaticNeighbours neighbours(system, set_of(0b001, 3), x.data(), 2.0);
  CHECK(neighbours.may_flip(0));
  CHECK_FALSE(neighbours.may_flip(1));
  CHECK(neighbours.may_flip(2));
  CHECK_FALSE(neighbours.may_flip(0, 1));
  CHECK(neighbours.may_flip(0, 2));
}
