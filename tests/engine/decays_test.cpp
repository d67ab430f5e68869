#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/exact/locator.hpp"
#include "model/build_mode.hpp"
#include "model/handmade_systems.hpp"

using namespace pwlsim::model;
using pwlsim::engine::Located;
using pwlsim::engine::Locator;
using pwlsim::engine::Segment;
using pwlsim::test::leaking;
using pwlsim::test::rates;
using pwlsim::test::set_of;

TEST_CASE("decays that are large beside the slow motion describe a segment to its end", "[unit]") {
  const double delta = 1e-4;
  const System system = leaking(delta);
  const auto whole = build_mode(system, set_of(1, {0}));
  ShiftedSystems shifted(system);
  const auto slow = build_slow_mode(system, *whole, find_cut(system, rates_by_speed(*whole, 0.1), 0.1), shifted);
  REQUIRE(slow != nullptr);
  whole->slow = slow.get();
  const auto [fast, rate] = rates(delta);  // of eigenvectors (2, λ + 1)
  const double psi = GENERATE(0.0, 1.0, 1e3, 1e6);
  CAPTURE(psi);
  const double x[] = {1.0 - psi * 2.0 / (fast + 1.0), 0.5 * (rate + 1.0) - psi};
  // The slow part is (1, (λ + 1)/2), whatever ψ is.
  const double length = std::hypot(1.0, 0.5 * (rate + 1.0));
  CHECK(std::abs(std::abs((slow->decays->slow * Eigen::Map<const Vector>(x, 2))(0)) - length) < 1e-15 * (1.0 + psi));

  Segment segment;
  segment.system = &system;
  segment.mode = whole.get();
  segment.y0 = segment.y = {x[0], x[1]};
  segment.rows = {0};
  segment.departures = {{0, -x[1] / delta}};
  segment.is_brief = true;
  Located located;
  Locator locator;
  const std::atomic<int> signal{1};
  locator.heed(&signal);
  locator.locate(segment, 40.0 * delta, located);
  CHECK(located.found);  // undecided, where the search stood
  CHECK(located.row == -1);
  CHECK(located.tau == 0.0);
  CHECK(segment.certified == 0.0);
  locator.heed(nullptr);
  locator.locate(segment, 40.0 * delta, located);
  CHECK_FALSE(located.found);  // u = −x₂/δ stays positive
  CHECK_FALSE(segment.decays_fail);
  CHECK_FALSE(segment.sampled);
  CHECK(segment.certified == 40.0 * delta);
}
