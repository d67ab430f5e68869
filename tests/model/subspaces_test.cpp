/// Consistent subspace V and jump subspace T of systems where both are known.
#include "model/subspaces.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "model/handmade_systems.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::Matrix;
using model::Vector;

namespace {

constexpr double projector_rounding = 1e-13;

/// Rounded to double, which is how the tests compute.
struct Rounded {
  explicit Rounded(const model::Subspaces& s)
      : regular(s.regular),
        projector(s.projector.cast<double>()),
        feedback(s.feedback.cast<double>()),
        constraints(s.constraints.cast<double>()),
        free_inputs(s.free_inputs.cast<double>()),
        condition(s.condition),
        dim_v(s.dim_v),
        dim_t(s.dim_t) {}
  bool regular;
  model::Matrix projector, feedback, constraints, free_inputs;
  double condition;
  int dim_v, dim_t;
};

Rounded all_active(const model::System& s) {
  using linalg::Wide;
  return Rounded(model::find_subspaces(s.a.cast<Wide>(), s.b.cast<Wide>(), s.c.cast<Wide>(), s.d.cast<Wide>(), s.n_zeta));
}

}  // namespace

// V: x1 = x3 = 0; T: the directions of position x1 and speed x3. A jump leaves the second cart alone (paper, section 3).
TEST_CASE("two carts: V and T have two dimensions each", "[unit]") {
  const Rounded s = all_active(carts());
  REQUIRE(s.regular);
  CHECK(s.dim_v == 2);
  CHECK(s.dim_t == 2);
  Vector x(4), jumped(4);
  x << 0.0, -1.0, -1.0, 2.0;
  jumped << 0.0, -1.0, 0.0, 2.0;
  CHECK((s.projector * x - jumped).norm() <= projector_rounding);
  // At the stop u must carry the spring of the second cart: x3' = x2 + u = 0.
  CHECK(std::abs((s.feedback * jumped)[0] - 1.0) <= projector_rounding);
  CHECK(s.free_inputs.cols() == 0);
}

TEST_CASE("triple integrator: V is nothing, T everything", "[unit]") {
  const Rounded s = all_active(triple_integrator());
  REQUIRE(s.regular);
  CHECK(s.dim_v == 0);
  CHECK(s.dim_t == 3);
  CHECK(s.projector.norm() <= projector_rounding);
}

// Two capacitors that a diode joins: in units of charge over √C the jump keeps the total charge (hard case 19: 3 V on 1 F, 0 V on 2 F).
TEST_CASE("two capacitors in parallel: an orthogonal projection that keeps the charge", "[unit]") {
  const double c1 = 1.0, c2 = 2.0;
  Matrix b(2, 1);
  b << -1.0 / std::sqrt(c1), 1.0 / std::sqrt(c2);
  const Matrix c = b.transpose();  // y = v2 − v1, the blocking voltage
  const model::System system = handmade(Matrix::Zero(2, 2), b, c, Matrix::Zero(1, 1));
  const Rounded s = all_active(system);
  REQUIRE(s.regular);
  CHECK(s.dim_v == 1);
  CHECK(s.dim_t == 1);
  CHECK((s.projector - s.projector.transpose()).norm() <= projector_rounding);
  Vector x(2);
  x << 3.0 * std::sqrt(c1), 0.0;
  const Vector after = s.projector * x;
  CHECK(after[0] / std::sqrt(c1) == Approx(1.0));
  CHECK(after[1] / std::sqrt(c2) == Approx(1.0));
}

TEST_CASE("with feedthrough there is nothing to jump", "[unit]") {
  Matrix a(1, 1), b(1, 1), c(1, 1), d(1, 1);
  a << -1;
  b << 1;
  c << 2;
  d << 4;
  const Rounded s = all_active(handmade(a, b, c, d));
  REQUIRE(s.regular);
  CHECK(s.dim_v == 1);
  CHECK(s.dim_t == 0);
  CHECK(s.feedback(0, 0) == Approx(-0.5));  // y = 2x + 4u = 0
}

TEST_CASE("two equal ports leave a direction of the input free", "[unit]") {
  Matrix a(1, 1), b(1, 2), c(2, 1);
  a << 0;
  b << 1, 1;
  c << 1, 1;
  const Rounded s = all_active(handmade(a, b, c, Matrix::Zero(2, 2)));
  REQUIRE(s.regular);
  REQUIRE(s.free_inputs.cols() == 1);
  CHECK(std::abs(s.free_inputs(0, 0) + s.free_inputs(1, 0)) <= projector_rounding);
}

TEST_CASE("a mode whose V and T do not fill the space is not regular", "[unit]") {
  // y = x1, but u moves x2 alone and x2 never reaches x1: x1 = 0 can neither be kept nor reached.
  Matrix a = Matrix::Zero(2, 2), b(2, 1), c(1, 2);
  b << 0, 1;
  c << 1, 0;
  CHECK_FALSE(all_active(handmade(a, b, c, Matrix::Zero(1, 1))).regular);
}
