/// The cascade of complementarity problems on examples whose answers are known in closed form.
#include "model/cascade.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "model/handmade_systems.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::Cascade;
using model::Matrix;
using model::Vector;
using model::Verdict;

namespace {

constexpr double jump_rounding = 1e-15;
constexpr double noise_of_state = 3e-14;

Cascade cascade_of(const model::System& s) { return {s.a, s.b, s.c, s.d}; }

}  // namespace

// van der Schaft and Schumacher 1996, §3 and eq. (4.21): at x1 = 0 the first of x3, x2, x4 that is not zero decides; x3 < 0 needs a jump to
// x3 = 0; at rest the index is indeterminate (Remark 3.6).
TEST_CASE("5: the cascade on all 27 sign patterns of the two carts", "[hard]") {
  const Cascade cascade = cascade_of(carts());
  CHECK(cascade.one_solution());
  for (const double x2 : {-1.0, 0.0, 1.0})
    for (const double x3 : {-1.0, 0.0, 1.0})
      for (const double x4 : {-1.0, 0.0, 1.0}) {
        INFO("x2, x3, x4 = " << x2 << ", " << x3 << ", " << x4);
        const Vector x = vector({0.0, x2, x3, x4});
        const model::CascadeOutcome smooth = cascade.smooth(x, noise_of_state);
        const model::CascadeOutcome all = cascade.impulsive(x, noise_of_state);
        REQUIRE(all.verdict == Verdict::unique);
        const auto& jump = all.continuations.front();
        CHECK(jump.jumps == (x3 < 0.0));
        CHECK((jump.state_after - vector({0.0, x2, std::max(x3, 0.0), x4})).norm() <= jump_rounding);
        if (x3 < 0.0) {
          CHECK(smooth.verdict == Verdict::none);
          CHECK(jump.active.contains(0));
          continue;
        }
        REQUIRE(smooth.verdict == Verdict::unique);
        const double decisive = x3 != 0.0 ? x3 : x2 != 0.0 ? x2 : x4;
        for (const auto* found : {&smooth.continuations.front(), &jump}) {
          CHECK(found->inactive.contains(0) == (decisive > 0.0));
          CHECK(found->active.contains(0) == (decisive < 0.0));
          CHECK(found->indeterminate.contains(0) == (decisive == 0.0));
        }
      }
}

// A small push decides against a large pull of higher order (hard case 4); below the noise of x it does not.
TEST_CASE("4: the noise of the state is told from the state", "[hard]") {
  const Cascade cascade = cascade_of(carts());
  CHECK(cascade.smooth(vector({0.0, 1e-4, 0.0, -1.0}), noise_of_state).continuations.front().inactive.contains(0));
  CHECK(cascade.smooth(vector({0.0, 1e-16, 0.0, -1.0}), noise_of_state).continuations.front().active.contains(0));
  CHECK(cascade.smooth(vector({0.0, 1e-16, 0.0, -1.0}), 0.0).continuations.front().inactive.contains(0));
}

// The third derivative of x1 is u. From (0, −1, 0) a derivative of a Dirac impulse makes x2 zero, so that the state after is zero (hard case 6).
TEST_CASE("6: an impulse of second order", "[hard]") {
  const Cascade cascade = cascade_of(triple_integrator());
  CHECK(cascade.smooth(vector({0.0, -1.0, 0.0}), noise_of_state).verdict == Verdict::none);
  const model::CascadeOutcome all = cascade.impulsive(vector({0.0, -1.0, 0.0}), noise_of_state);
  REQUIRE(all.verdict == Verdict::unique);
  CHECK(all.continuations.front().jumps);
  CHECK(all.continuations.front().active.contains(0));
  CHECK(all.continuations.front().state_after.norm() <= jump_rounding);
}

// y = q − u, q a constant state: two solutions for q > 0, none for q < 0 (hard case 34).
TEST_CASE("34: several continuations and none", "[hard]") {
  const Cascade cascade(Matrix::Zero(1, 1), Matrix::Zero(1, 1), Matrix::Ones(1, 1), -Matrix::Ones(1, 1));
  CHECK_FALSE(cascade.one_solution());
  CHECK(cascade.smooth(vector({2.0}), noise_of_state).verdict == Verdict::several);
  CHECK(cascade.smooth(vector({2.0}), noise_of_state).continuations.size() == 2);
  CHECK(cascade.smooth(vector({-2.0}), noise_of_state).verdict == Verdict::none);
}

// Twelve unit masses, each with a stop at zero: N = I of relative degree 2, more ports than the enumeration takes. A constant force presses those
// with even number on their stops and pulls the others off.
TEST_CASE("many ports are solved without enumeration", "[unit]") {
  const int k = 12;
  Matrix a = Matrix::Zero(2 * k + 1, 2 * k + 1), b = Matrix::Zero(2 * k + 1, k), c = Matrix::Zero(k, 2 * k + 1);
  for (int i = 0; i < k; ++i) {
    a(2 * i, 2 * i + 1) = 1.0;
    a(2 * i + 1, 2 * k) = i % 2 == 0 ? -1.0 : 1.0;
    b(2 * i + 1, i) = 1.0;
    c(i, 2 * i) = 1.0;
  }
  const Cascade cascade(a, b, c, Matrix::Zero(k, k));
  const model::CascadeOutcome outcome = cascade.smooth(Vector::Unit(2 * k + 1, 2 * k), noise_of_state);
  REQUIRE(outcome.verdict == Verdict::unique);
  for (int i = 0; i < k; ++i) {
    CHECK(outcome.continuations.front().active.contains(i) == (i % 2 == 0));
    CHECK(outcome.continuations.front().inactive.contains(i) == (i % 2 == 1));
  }
}
