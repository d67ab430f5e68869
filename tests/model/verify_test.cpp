/// The first derivative that is not rounding, and its sign.
#include "model/verify.hpp"

#include <catch2/catch.hpp>

#include "model/build_mode.hpp"
#include "model/handmade_systems.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::Departure;
using model::Vector;

namespace {

/// Departure of the only diode guard of a mode at state x.
Departure departure(const model::System& system, const model::IndexSet& active, std::initializer_list<double> state) {
  const auto mode = model::build_mode(system, active);
  REQUIRE(mode->regular);
  std::vector<double> x(state), y(static_cast<std::size_t>(mode->ny));
  model::to_mode(system, *mode, x.data(), y.data());
  model::Verifier verifier;
  Departure result;
  verifier.departures(*mode, y.data(), {0}, &result);
  return result;
}

}  // namespace

// Free carts: x1 has the derivatives x3, −2x1 + x2, −2x3 + x4, …
TEST_CASE("derivatives of the distance to the stop", "[unit]") {
  const model::System system = carts();
  const auto free = set_of(1, {});
  Departure d = departure(system, free, {2.0, 0.0, 0.0, 0.0});
  CHECK(d.order == 0);
  CHECK(d.value == Approx(2.0));
  d = departure(system, free, {0.0, 5.0, -3.0, 1.0});
  CHECK(d.order == 1);
  CHECK(d.value == Approx(-3.0));
  d = departure(system, free, {0.0, 5.0, 0.0, -1.0});
  CHECK(d.order == 2);
  CHECK(d.value == Approx(5.0));
  d = departure(system, free, {0.0, 0.0, 0.0, -7.0});
  CHECK(d.order == 3);
  CHECK(d.value == Approx(-7.0));
  CHECK(departure(system, free, {0.0, 0.0, 0.0, 0.0}).order == -1);
}

TEST_CASE("one verifier, asked of several states and modes in turn", "[unit]") {
  const model::System system = carts();
  const auto free = model::build_mode(system, set_of(1, {})), stuck = model::build_mode(system, set_of(1, {0}));
  struct Case {
    const model::Mode& mode;
    std::vector<double> x;
    Departure expected;
  };
  // As above; the first one twice, the second time when its derivatives are known.
  const std::vector<Case> cases{{*free, {0.0, 0.0, 0.0, -7.0}, {3, -7.0}}, {*free, {0.0, 0.0, 0.0, -7.0}, {3, -7.0}},
                                {*free, {0.0, 5.0, -3.0, 1.0}, {1, -3.0}}, {*stuck, {0.0, -4.0, 0.0, 1.0}, {0, 4.0}},
                                {*stuck, {0.0, 0.0, 0.0, 2.0}, {1, -2.0}}, {*free, {0.0, 0.0, 0.0, 2.0}, {3, 2.0}},
                                {*free, {2.0, 0.0, 0.0, 0.0}, {0, 2.0}},   {*free, {0.0, 5.0, 0.0, -1.0}, {2, 5.0}}};
  model::Verifier verifier;
  for (const Case& c : cases) {
    std::vector<double> y(static_cast<std::size_t>(c.mode.ny));
    model::to_mode(system, c.mode, c.x.data(), y.data());
    Departure d;
    verifier.departures(c.mode, y.data(), {0}, &d);
    CHECK(d.order == c.expected.order);
    CHECK(d.value == Approx(c.expected.value));
  }
}

// At the stop the force is u = −x2, with derivative −x4.
TEST_CASE("derivatives of the force of the stop", "[unit]") {
  const model::System system = carts();
  const auto stuck = set_of(1, {0});
  Departure d = departure(system, stuck, {0.0, -4.0, 0.0, 1.0});
  CHECK(d.order == 0);
  CHECK(d.value == Approx(4.0));
  d = departure(system, stuck, {0.0, 0.0, 0.0, 2.0});
  CHECK(d.order == 1);
  CHECK(d.value == Approx(-2.0));
  CHECK(departure(system, stuck, {0.0, 0.0, 0.0, 0.0}).order == -1);
}

TEST_CASE("a value that is rounding beside the state counts as zero, a small one that stands alone does not", "[unit]") {
  const model::System system = carts();
  const auto free = set_of(1, {});
  CHECK(departure(system, free, {1e-17, 1.0, 0.0, 0.0}).order == 2);
  CHECK(departure(system, free, {1e-17, 0.0, 0.0, 0.0}).order == 0);
  CHECK(departure(system, free, {1e-6, 1.0, 0.0, 0.0}).order == 0);
}

// x1 = 1e-12 beside x2 = 1 is a small number, not rounding; a relaxed verifier takes it for rounding.
TEST_CASE("a relaxed verifier sees less", "[unit]") {
  const model::System system = carts();
  const auto mode = model::build_mode(system, set_of(1, {}));
  const std::vector<double> x{1e-12, 1.0, 0.0, 0.0};
  model::Verifier verifier;
  Departure d;
  verifier.departures(*mode, x.data(), {0}, &d);
  CHECK(d.order == 0);
  verifier.relax(1e4, 0.0);
  verifier.departures(*mode, x.data(), {0}, &d);
  CHECK(d.order == 2);
}
