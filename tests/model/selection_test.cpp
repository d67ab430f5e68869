/// Which mode follows, where theory knows the answer. Numbers are those of the collection of hard cases.
#include "model/selection.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>

#include "model/handmade_systems.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::Matrix;
using model::SelectionOutcome;
using model::Vector;

namespace {

constexpr double selection_rounding = 1e-12;

struct Outcome {
  model::Selected selected;
  Vector x;
  Vector u;
};

Outcome select(const model::System& system, Vector x, const model::IndexSet& before) {
  model::Selector selector(system, model::Several::stay);
  Outcome outcome;
  outcome.selected = selector.select(x.data(), before, -1);
  outcome.x = x;
  if (outcome.selected.mode) outcome.u = outcome.selected.mode->k * x;
  // The mode belongs to the selector, which ends here.
  return outcome;
}

}  // namespace

// The stop of the two carts touched at x1 = 0: a negative speed x3 jumps to zero; then the first of x3, x2, x4 that is not zero decides:
// positive, the cart leaves; negative, it stays, with force u = −x2. All zero: at rest (paper, section 3 and eq. (4.21)).
TEST_CASE("5: all 27 sign patterns of the two carts at the stop", "[hard]") {
  const model::System system = carts();
  const bool stuck_before = GENERATE(false, true);
  for (const double x2 : {-1.0, 0.0, 1.0})
    for (const double x3 : {-1.0, 0.0, 1.0})
      for (const double x4 : {-1.0, 0.0, 1.0}) {
        INFO("x2, x3, x4 = " << x2 << ", " << x3 << ", " << x4 << (stuck_before ? ", stuck before" : ", free before"));
        const double jumped = std::max(x3, 0.0);
        const double decisive = jumped != 0.0 ? jumped : x2 != 0.0 ? x2 : x4;
        const Outcome o = select(system, vector({0.0, x2, x3, x4}),
                                 set_of(1, stuck_before ? std::initializer_list<int>{0} : std::initializer_list<int>{}));
        REQUIRE(o.selected.outcome == SelectionOutcome::found);
        CHECK((o.x - vector({0.0, x2, jumped, x4})).norm() <= selection_rounding);
        CHECK(o.selected.jumps == (x3 < 0.0 ? 1 : 0));
        CHECK(o.u[0] == Approx(decisive < 0.0 ? -x2 : 0.0).margin(selection_rounding));
        const Vector rate = system.a * o.x + system.b * o.u;
        CHECK(rate[2] == Approx(decisive > 0.0 ? x2 : 0.0).margin(selection_rounding));
      }
}

// x1 = x2 t²/2 + x4 t³/6 + …: it leaves, to come back after 3e-4. The first derivative that is not zero decides, however small.
TEST_CASE("4: a small push decides against a large pull of higher order", "[hard]") {
  const model::System system = carts();
  const Outcome o = select(system, vector({0.0, 1e-4, 0.0, -1.0}), set_of(1, {}));
  REQUIRE(o.selected.outcome == SelectionOutcome::found);
  CHECK(o.selected.jumps == 0);
  CHECK(o.u[0] == 0.0);
  CHECK(o.x == vector({0.0, 1e-4, 0.0, -1.0}));
}

TEST_CASE("3: jump in one mode, continuation in another", "[hard]") {
  const Outcome o = select(carts(), vector({0.0, 1.0, -1.0, 0.0}), set_of(1, {}));
  REQUIRE(o.selected.outcome == SelectionOutcome::found);
  CHECK((o.x - vector({0.0, 1.0, 0.0, 0.0})).norm() <= selection_rounding);
  CHECK(o.u[0] == Approx(0.0).margin(selection_rounding));
}

TEST_CASE("6: the triple integrator jumps to zero by an impulse of higher order", "[hard]") {
  const Outcome o = select(triple_integrator(), vector({0.0, -1.0, 0.0}), set_of(1, {}));
  REQUIRE(o.selected.outcome == SelectionOutcome::found);
  CHECK(o.x.norm() <= selection_rounding);
  CHECK(o.selected.jumps == 1);
}

TEST_CASE("8, 9: a relay of the wrong sign has three ways on, of the right sign one", "[hard]") {
  const model::System wrong = relay(1.0), right = relay(-1.0);
  const Vector rest = vector({0.0, 1.0});
  CHECK(select(wrong, rest, set_of(2, {})).selected.outcome == SelectionOutcome::several);
  const Outcome sliding = select(right, rest, set_of(2, {}));
  REQUIRE(sliding.selected.outcome == SelectionOutcome::found);
  CHECK(sliding.u[0] == Approx(0.5));  // v = 1 − 2λ = 0
  // Away from zero there is one way for both signs.
  for (const double x : {-1.0, 1.0})
    for (const auto* system : {&wrong, &right}) {
      const Outcome o = select(*system, vector({x, 1.0}), set_of(2, {}));
      REQUIRE(o.selected.outcome == SelectionOutcome::found);
      CHECK(o.u[0] == Approx(x > 0.0 ? 0.0 : 1.0).margin(selection_rounding));
    }
}

TEST_CASE("8: where several ways are allowed, the previous mode goes on", "[hard]") {
  const model::System system = relay(1.0);
  for (const auto& before : {set_of(2, {}), set_of(2, {0}), set_of(2, {0, 1})}) {
    model::Selector selector(system, model::Several::stay);
    Vector x = vector({0.0, 1.0});
    const model::Selected selected = selector.select(x.data(), before, -1);
    REQUIRE(selected.outcome == SelectionOutcome::several);
    CHECK(selected.details->continuations.size() == 3);
    CHECK(selected.mode->active == before);
    model::Selector by_order(system, model::Several::first);
    CHECK(by_order.select(x.data(), before, -1).mode->active == set_of(2, {}));
  }
}

/// x1' = x2, x2' = −2 sgn x1 − sgn x2 (hard case 13, twisting): ports λ1, m1, λ2, m2 as of `relay`, then the state 1.
model::System twisting() {
  Matrix a = Matrix::Zero(3, 3), b = Matrix::Zero(3, 4), c = Matrix::Zero(4, 3), d = Matrix::Zero(4, 4);
  a(0, 1) = 1.0;
  a(1, 2) = -3.0;
  b(1, 0) = 4.0;
  b(1, 2) = 2.0;
  c(0, 0) = c(2, 1) = c(1, 2) = c(3, 2) = 1.0;
  d(0, 1) = d(2, 3) = 1.0;
  d(1, 0) = d(3, 2) = -1.0;
  return handmade(a, b, c, d, {}, true);
}

// From (0, 1): acceleration −3 until x2 = 0 at 1/3, then −2 + 1 = −1 … until x1 = 0 again, and so on with speeds ÷ √3: t* = 1 + 2/√3.
// The parabolas between the switchings are integrated by their formulas here, so that only the decisions are the program's.
TEST_CASE("13: twisting decides right at every switching", "[hard]") {
  const model::System system = twisting();
  model::Selector selector(system, model::Several::stay);
  Vector x = vector({0.0, 1.0, 1.0});
  model::IndexSet before(4);
  double time = 0.0;
  for (int i = 0; i < 20; ++i) {
    INFO("switching " << i << " at " << time << ": " << x.transpose());
    const model::Selected selected = selector.select(x.data(), before, -1);
    REQUIRE(selected.outcome == SelectionOutcome::found);
    REQUIRE(selected.jumps == 0);
    before = selected.mode->active;
    const double acceleration = (system.a * x + system.b * (selected.mode->k * x))[1];
    // On the x1 axis x2 is zero and the motion starts towards the origin; on the x2 axis it goes on past it.
    const bool on_speed_axis = i % 2 == 0;
    const double expected = on_speed_axis ? -3.0 * (x[1] > 0.0 ? 1.0 : -1.0) : -1.0 * (x[0] > 0.0 ? 1.0 : -1.0);
    REQUIRE(acceleration == Approx(expected).epsilon(1e-12));
    const double duration = on_speed_axis ? -x[1] / acceleration : std::sqrt(-2.0 * x[0] / acceleration);
    const double x1 = x[0] + x[1] * duration + 0.5 * acceleration * duration * duration;
    const double x2 = x[1] + acceleration * duration;
    x = on_speed_axis ? vector({x1, 0.0, 1.0}) : vector({0.0, x2, 1.0});
    time += duration;
  }
  CHECK(time == Approx((1.0 + 2.0 / std::sqrt(3.0)) * (1.0 - 1.0 / 243.0)).epsilon(selection_rounding));  // (1/√3)¹⁰ of it is still to come
  Vector rest = vector({0.0, 0.0, 1.0});
  const model::Selected at_rest = selector.select(rest.data(), before, -1);
  REQUIRE(at_rest.outcome == SelectionOutcome::found);
  CHECK((system.a * rest + system.b * (at_rest.mode->k * rest)).norm() <= selection_rounding);
}

// Normals n1 = (1, 0), n2 = (½, √3/2); the plastic impact of Moreau from v = (−1, 0.2) at the corner stops the first direction only.
TEST_CASE("14: an obtuse corner", "[hard]") {
  const double s = std::sqrt(3.0) / 2.0;
  Matrix a = Matrix::Zero(4, 4), b = Matrix::Zero(4, 2), c = Matrix::Zero(2, 4);
  a(0, 2) = a(1, 3) = 1.0;
  b.bottomRows(2) << 1.0, 0.5, 0.0, s;
  c.leftCols(2) << 1.0, 0.0, 0.5, s;
  const Outcome o = select(handmade(a, b, c, Matrix::Zero(2, 2)), vector({0.0, 0.0, -1.0, 0.2}), set_of(2, {}));
  REQUIRE(o.selected.outcome == SelectionOutcome::found);
  CHECK((o.x - vector({0.0, 0.0, 0.0, 0.2})).norm() <= selection_rounding);
}

// The same corner: both guards fall, so the rule J = (I \ Γ2) ∪ Γ1 closes both stops and v⁺ = 0. n1 μ1 + n2 μ2 = (1, −0.2) has
// μ2 = −0.4/√3 = −0.231: the second stop would have to pull.
TEST_CASE("14: the rule takes both stops, and one of them adheres", "[hard]") {
  const double s = std::sqrt(3.0) / 2.0;
  Matrix a = Matrix::Zero(4, 4), b = Matrix::Zero(4, 2), c = Matrix::Zero(2, 4);
  a(0, 2) = a(1, 3) = 1.0;
  b.bottomRows(2) << 1.0, 0.5, 0.0, s;
  c.leftCols(2) << 1.0, 0.0, 0.5, s;
  const model::System corner = handmade(a, b, c, Matrix::Zero(2, 2));
  model::Selector selector(corner, model::Several::stay);
  const Vector before = vector({0.0, 0.0, -1.0, 0.2});
  const model::IndexSet both = selector.by_rule(before.data(), set_of(2, {}));
  CHECK(both == set_of(2, {0, 1}));
  const model::Mode& mode = selector.modes().mode(both);
  REQUIRE(mode.regular);
  const Vector after = mode.projector * before;
  CHECK(after.norm() <= selection_rounding);
  const Vector multipliers = b.bottomRows(2).fullPivLu().solve(after.tail(2) - before.tail(2));
  CHECK(multipliers[0] == Approx(1.0 + 0.2 / std::sqrt(3.0)).epsilon(selection_rounding));
  CHECK(multipliers[1] == Approx(-0.4 / std::sqrt(3.0)).epsilon(selection_rounding));
}

// x'' = 2 + u, 0 ≤ u ⊥ x − 1.5 t² ≥ 0, from rest: u = 1 holds it on the parabola. States x, x', p = 1.5 t², p', p''.
TEST_CASE("15: a support that accelerates", "[hard]") {
  Matrix a = Matrix::Zero(5, 5), b = Matrix::Zero(5, 1), c = Matrix::Zero(1, 5);
  a(0, 1) = a(2, 3) = a(3, 4) = 1.0;
  a(1, 4) = 2.0 / 3.0;  // the constant 2, from p'' = 3
  b(1, 0) = 1.0;
  c(0, 0) = 1.0;
  c(0, 2) = -1.0;
  const Outcome o = select(handmade(a, b, c, Matrix::Zero(1, 1)), vector({0.0, 0.0, 0.0, 0.0, 3.0}), set_of(1, {}));
  REQUIRE(o.selected.outcome == SelectionOutcome::found);
  CHECK(o.selected.jumps == 0);
  CHECK(o.u[0] == Approx(1.0));
}

// Case 34 as a system without states: y = q − u has two solutions for q > 0 and none for q < 0.
TEST_CASE("34: no mode, where none exists", "[hard]") {
  Matrix a = Matrix::Zero(1, 1), b = Matrix::Zero(1, 1), c(1, 1), d(1, 1);
  c << -1.0;
  d << -1.0;
  const model::System none = handmade(a, b, c, d, {}, true);
  CHECK(select(none, vector({1.0}), set_of(1, {})).selected.outcome == SelectionOutcome::none);
}
