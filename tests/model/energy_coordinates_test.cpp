/// States named after elements, matrices in SI units, against closed forms.
#include "model/energy_coordinates.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "model/switch_position.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::EnergyState;
using model::StateSpace;

namespace {

constexpr double coordinate_rounding = 1e-13;

/// The island with the most energy stores.
model::Island main_island(const model::Network& network) {
  std::vector<model::Island> islands = model::split_islands(network);
  const auto stores = [](const model::Island& i) { return i.network.capacitors.size() + i.network.inductors.size(); };
  return *std::max_element(islands.begin(), islands.end(), [&](const auto& a, const auto& b) { return stores(a) < stores(b); });
}

StateSpace space_of(const model::Island& island) {
  Diagnostics diagnostics;
  const auto extraction = model::extract(island, diagnostics);
  REQUIRE(extraction);
  return model::in_energy_coordinates(island, *extraction);
}

}  // namespace

// Hard case 19: C1 = 1 F and C2 = 2 F joined by a diode; x = √C·v, u the diode's current, y = v2 − v1.
TEST_CASE("two capacitors and a diode", "[hard]") {
  TestCircuit c;
  c.c("a", "0", 1.0);
  c.c("b", "0", 2.0);
  c.d("a", "b");
  const StateSpace s = space_of(main_island(c.network()));
  REQUIRE(s.states.size() == 2);
  REQUIRE(s.states[1].terms.size() == 1);
  CHECK(s.states[1].terms[0].element == "C2");
  CHECK(s.states[1].terms[0].is_voltage);
  CHECK(s.states[1].terms[0].coefficient == Approx(std::sqrt(2.0)).epsilon(coordinate_rounding));
  CHECK(s.a.norm() == 0.0);
  CHECK(s.b(0, 0) == Approx(-1.0).epsilon(coordinate_rounding));
  CHECK(s.b(1, 0) == Approx(std::sqrt(0.5)).epsilon(coordinate_rounding));
  CHECK((s.c - s.b.transpose()).norm() <= coordinate_rounding);
  CHECK(s.d(0, 0) == 0.0);
}

// Hard case 24: the loop of the source leaves one state, orthogonal to (1/√C1, 1/√C2): x = (C2 v2 − C1 v1)/√(C1+C2); pole −1/(R(C1+C2)).
TEST_CASE("a capacitive divider has one state, a mixture of both voltages", "[hard]") {
  const double c1 = 1e-12, c2 = 3e-12, r = 1e6;
  TestCircuit c;
  c.v("s", "0", model::Dc{1.0});
  c.c("s", "m", c1);
  c.c("m", "0", c2);
  c.r("m", "0", r);
  const StateSpace s = space_of(main_island(c.network()));
  REQUIRE(s.states.size() == 1);
  REQUIRE(s.states[0].terms.size() == 2);
  const double sign = s.states[0].terms[1].coefficient > 0.0 ? 1.0 : -1.0;
  CHECK(sign * s.states[0].terms[0].coefficient == Approx(-c1 / std::sqrt(c1 + c2)).epsilon(coordinate_rounding));
  CHECK(sign * s.states[0].terms[1].coefficient == Approx(c2 / std::sqrt(c1 + c2)).epsilon(coordinate_rounding));
  CHECK(s.a(0, 0) == Approx(-1.0 / (r * (c1 + c2))).epsilon(coordinate_rounding));
}

// Two windings with k = 1 share one flux: energy ½(√L1 i1 + √L2 i2)².
TEST_CASE("perfectly coupled inductors have one state", "[unit]") {
  const double l1 = 50e-6, l2 = 12.5e-6;
  TestCircuit c;
  const int a = c.l("a", "0", l1), b = c.l("b", "0", l2);
  c.k(a, b, 1.0);
  c.r("a", "0", 3.0);
  c.r("b", "0", 5.0);
  const StateSpace s = space_of(main_island(c.network()));
  REQUIRE(s.states.size() == 1);
  REQUIRE(s.states[0].terms.size() == 2);
  CHECK_FALSE(s.states[0].terms[0].is_voltage);
  CHECK(std::abs(s.states[0].terms[0].coefficient) == Approx(std::sqrt(l1)).epsilon(coordinate_rounding));
  CHECK(std::abs(s.states[0].terms[1].coefficient) == Approx(std::sqrt(l2)).epsilon(coordinate_rounding));
  // x' = −x/(L1/R1 + L2/R2)
  CHECK(s.a(0, 0) == Approx(-1.0 / (l1 / 3.0 + l2 / 5.0)).epsilon(1e-12));
}

// A store far from a loop keeps its own state: a third capacitor beside two in parallel.
TEST_CASE("only what a loop ties together is mixed", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 2.0);
  c.c("b", "0", 1.0);
  c.c("b", "0", 3.0);
  c.r("a", "b", 1.0);
  const StateSpace s = space_of(main_island(c.network()));
  REQUIRE(s.states.size() == 2);
  REQUIRE(s.states[0].terms.size() == 1);
  CHECK(s.states[0].terms[0].element == "C1");
  REQUIRE(s.states[1].terms.size() == 2);
  // √(C2+C3)·v as (C2 v2 + C3 v3)/√(C2+C3)
  CHECK(s.states[1].terms[0].coefficient == Approx(0.5).epsilon(coordinate_rounding));
  CHECK(s.states[1].terms[1].coefficient == Approx(1.5).epsilon(coordinate_rounding));
  CHECK(s.a(0, 0) == Approx(-0.5).epsilon(coordinate_rounding));
  CHECK(s.a(1, 1) == Approx(-0.25).epsilon(coordinate_rounding));
  CHECK(s.a(0, 1) == Approx(1.0 / std::sqrt(8.0)).epsilon(coordinate_rounding));
}

// C discharges through a contact of 2 Ω, or not at all; another source's current follows the contact's.
TEST_CASE("a closed contact is a resistor, an open one nothing", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 4.0);
  const int contact = c.s("a", "0", "a", "0", 1.0);
  c.network().switches[static_cast<std::size_t>(contact)].resistance = 2.0;
  c.r("a", "0", 100.0);
  c.g("a", "0", "a", "0", 0.0);
  c.network().injections.back().current = {{model::Term::Kind::switch_current, contact, 3.0}};
  const model::Island island = main_island(c.network());
  CHECK(space_of(model::in_position(island, {0})).a(0, 0) == Approx(-1.0 / 400.0).epsilon(coordinate_rounding));
  // Four times the contact's current leaves the node.
  CHECK(space_of(model::in_position(island, {1})).a(0, 0) == Approx(-(4.0 / 2.0 + 0.01) / 4.0).epsilon(coordinate_rounding));
}
