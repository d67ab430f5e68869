/// What the rational problem tells of uniqueness before any state is known (RationalProblem::is_uniquely_solvable).
#include <catch2/catch.hpp>

#include "model/handmade_systems.hpp"
#include "model/rcp.hpp"

using namespace pwlsim;
using model::IndexSet;
using model::Matrix;
using model::RationalProblem;

namespace {

bool is_unique(const model::System& system, const IndexSet& switches) { return RationalProblem(system).is_uniquely_solvable(switches); }
bool is_unique(const model::System& system) { return is_unique(system, IndexSet(system.ports)); }

/// x' = −x + b·u, y = c·x + D u.
model::System of_one_state(const Matrix& b, const Matrix& c, const Matrix& d) { return test::handmade(-Matrix::Identity(1, 1), b, c, d); }

/// Ports 0 and 1: a diode with a switch in series; the switch's own block is zero, and it holds the diode's u.
model::System diode_behind_switch() {
  Matrix d(2, 2);
  d << 0.5, -1.0, 1.0, 0.0;
  model::System system = of_one_state(Matrix::Zero(1, 2), Matrix::Zero(2, 1), d);
  system.diodes = 1;
  return system;
}

}  // namespace

TEST_CASE("one solution: of a P-matrix, whatever its symmetry", "[unit]") {
  Matrix d(2, 2);
  d << 1.0, -3.0, 2.0, 1.0;
  CHECK(is_unique(of_one_state(Matrix::Zero(1, 2), Matrix::Zero(2, 1), d)));
  d(0, 1) = 3.0;  // det = −5
  CHECK_FALSE(is_unique(of_one_state(Matrix::Zero(1, 2), Matrix::Zero(2, 1), d)));
  CHECK_FALSE(is_unique(of_one_state(Matrix::Zero(1, 1), Matrix::Zero(1, 1), -Matrix::Identity(1, 1))));
}

TEST_CASE("one solution: the first derivative that u reaches decides", "[unit]") {
  const Matrix one = Matrix::Identity(1, 1);
  CHECK(is_unique(of_one_state(one, one, Matrix::Zero(1, 1))));         // y' = … + u
  CHECK_FALSE(is_unique(of_one_state(-one, one, Matrix::Zero(1, 1))));  // y' = … − u
  CHECK_FALSE(is_unique(of_one_state(one, one, -1e-9 * one)));          // y = … − 1e-9·u before all
  CHECK(is_unique(test::triple_integrator()));                          // y''' = u
  CHECK(is_unique(test::carts()));
  CHECK_FALSE(is_unique(test::relay(1.0)));  // x' = sgn x: three solutions from 0 (paper, section 4.2)
}

TEST_CASE("one solution: clamps to both sides are one port", "[unit]") {
  // y1 = x, y2 = 1 − x: u1 and u2 push the state apart, G = g (1 −1; −1 1).
  Matrix b(1, 2), c(2, 1);
  b << 1.0, -1.0;
  c << 1.0, -1.0;
  CHECK(is_unique(of_one_state(b, c, Matrix::Zero(2, 2))));
  b << 1.0, 1.0;  // both push the same way: y2' = … − u2
  CHECK_FALSE(is_unique(of_one_state(b, c, Matrix::Zero(2, 2))));
}

TEST_CASE("one solution: ports that look alike and move the state differently are two", "[unit]") {
  // The second state is seen by no port.
  Matrix b(2, 2), c(2, 2);
  b << 1.0, 1.0, 0.0, 1.0;
  c << 1.0, 0.0, 1.0, 0.0;
  CHECK_FALSE(is_unique(test::handmade(-Matrix::Identity(2, 2), b, c, Matrix::Zero(2, 2))));
  b(1, 1) = 0.0;
  CHECK(is_unique(test::handmade(-Matrix::Identity(2, 2), b, c, Matrix::Zero(2, 2))));
}

TEST_CASE("one solution: a port that moves nothing does not matter, one that moves a hidden state does", "[unit]") {
  Matrix b = Matrix::Zero(1, 1);
  CHECK(is_unique(of_one_state(b, Matrix::Ones(1, 1), Matrix::Zero(1, 1))));
  b(0, 0) = 1.0;
  CHECK_FALSE(is_unique(of_one_state(b, Matrix::Zero(1, 1), Matrix::Zero(1, 1))));
}

TEST_CASE("one solution: a switch that can only be solved with a diode", "[unit]") {
  model::System system = diode_behind_switch();
  CHECK(is_unique(system));
  IndexSet closed(2);
  closed.set(1, true);  // y2 = u1 = 0 at last, and y1 is what u2 makes of it
  CHECK(is_unique(system, closed));
  system.d(0, 0) = -0.5;
  CHECK_FALSE(is_unique(system));
  CHECK(is_unique(system, closed));
}
