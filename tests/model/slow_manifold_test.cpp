#include <catch2/catch.hpp>

#include <cmath>
#include <memory>

#include "model/build_mode.hpp"
#include "model/handmade_systems.hpp"

using namespace pwlsim::model;
using pwlsim::test::leaking;
using pwlsim::test::rates;
using pwlsim::test::set_of;
using pwlsim::test::TwoRates;

namespace {

std::unique_ptr<Mode> slow_mode_of(const System& system, const Mode& whole, double longest) {
  ShiftedSystems shifted(system);
  return build_slow_mode(system, whole, find_cut(system, rates_by_speed(whole, longest), longest), shifted);
}

}  // namespace

TEST_CASE("the slow motion of a mode keeps all digits of its rate, however fast the decay beside it", "[unit]") {
  const double delta = GENERATE(1e-6, 1e-9, 1e-12, 1e-15);
  CAPTURE(delta);
  const System system = leaking(delta);
  const auto whole = build_mode(system, set_of(1, {0}));
  REQUIRE(whole->regular);
  if (whole->constrained) return;  // δ is taken for zero
  const auto slow = slow_mode_of(system, *whole, 1e-3);
  REQUIRE(slow != nullptr);
  REQUIRE(slow->n1 == 1);
  const TwoRates exact = rates(delta);
  CHECK(std::abs(slow->flow.a()(0, 0) / exact.slow - 1.0) < 4e-16 * 4.0);
  CHECK(std::abs(slow->decays->slowest * -exact.fast - 1.0) < 1e-9);
  // On the manifold x₂ = λ-eigenvector: (A + 1) x = λ x gives x₂ = (λ + 1)/2 x₁, and u = −x₂/δ.
  const double x[] = {1.0, 0.5 * (exact.slow + 1.0)};
  double y[1], back[2];
  to_mode(system, *slow, x, y);
  from_mode(system, *slow, y, back);
  CHECK(std::abs(back[0] - x[0]) < 1e-15);
  CHECK(std::abs(back[1] - x[1]) < 1e-15 * std::abs(x[0]));
  CHECK(std::abs(slow->guards(0, 0) * y[0] + x[1] / delta) < 1e-6 * std::abs(x[1] / delta));
  CHECK(std::abs((slow->decays->coordinates * Eigen::Map<const Vector>(x, 2))(0)) < 1e-15);
}

TEST_CASE("a decay that is not much faster, or longer than asked for, is left in the mode", "[unit]") {
  const System near = leaking(1e-2), far = leaking(1e-9);
  CHECK(slow_mode_of(near, *build_mode(near, set_of(1, {0})), 0.1) == nullptr);
  const auto whole = build_mode(far, set_of(1, {0}));
  CHECK(slow_mode_of(far, *whole, 1e-10) == nullptr);
  CHECK(slow_mode_of(far, *whole, 1e-8) != nullptr);
}

TEST_CASE("projection onto the slow manifold goes along the decay", "[unit]") {
  const System system = leaking(1e-7);
  const auto whole = build_mode(system, set_of(1, {0}));
  const auto slow = slow_mode_of(system, *whole, 1e-3);
  REQUIRE(slow != nullptr);
  // The fast eigenvector (2, λ + 1): nothing of it is left.
  const Vector fast = Vector{{2.0, rates(1e-7).fast + 1.0}};
  CHECK((slow->projector * fast).norm() < 1e-15 * fast.norm());
  CHECK((slow->projector * slow->projector - slow->projector).norm() < 1e-15);
}
