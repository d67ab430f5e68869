// Charges and fluxes that are moved in no time are part of INTEG and AVG.

#include <catch2/catch.hpp>

#include "measure/measured.hpp"

using pwlsim::test::measure_deck;
using pwlsim::test::Measured;

namespace {

constexpr double rounding = 1e-14;  // of numbers of order one

Approx near(double value) { return Approx(value).epsilon(rounding).margin(rounding); }

}  // namespace

// Charge is kept: both capacitors end at (C1·V1 + C2·V2)/(C1 + C2), so that C1·C2/(C1 + C2)·(V1 - V2) passes the switch. At 1 s: 2·1/3·3 V.
TEST_CASE("INTEG and AVG hold the charge that an ideal switch moves in no time", "[unit]") {
  const Measured m = measure_deck(
      "two capacitors\nC1 a 0 2 ic=3\nC2 b 0 1 ic=0\nS1 a b g 0 SW\nVg g 0 PULSE(0 1 1 0 0 9 0)\n.model SW SW(Vt=0.5)\n.tran 1 4 "
      "uic\n.save v(a)\n"
      ".meas through INTEG i(S1)\n.meas into INTEG i(C2)\n.meas out INTEG i(C1)\n.meas mean AVG i(S1)\n.meas sum INTEG "
      "3-2*i(C2)/4-(-i(C1))\n"
      ".meas before INTEG i(S1) TO=1\n.meas after INTEG i(S1) FROM=1\n.meas later INTEG i(S1) FROM=1.5\n.meas product INTEG i(S1)*i(S1)\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("through") == near(2.0));
  CHECK(m.value.at("into") == near(2.0));
  CHECK(m.value.at("out") == near(-2.0));
  CHECK(m.value.at("mean") == near(2.0 / 4.0));
  CHECK(m.value.at("sum") == near(3.0 * 4.0 - 2.0 * 2.0 / 4.0 - 2.0));
  CHECK(m.value.at("before") == near(0.0));
  CHECK(m.value.at("after") == near(2.0));
  CHECK(m.value.at("later") == near(0.0));
  CHECK(m.value.at("product") == near(0.0));  // not defined: left out
}

// C·ΔV; of two capacitors in series across the source C1·C2/(C1 + C2)·ΔV, and the source carries the sum, backwards.
TEST_CASE("INTEG holds the charge that a step of a source moves", "[unit]") {
  const Measured m = measure_deck(
      "step\nV1 a 0 PULSE(1 4 1 0 0 2 0)\nC1 a 0 2\nC2 a b 3\nC3 b 0 6\nR1 a 0 1\n.tran 1 5\n.save v(a)\n"
      ".meas up INTEG i(C1) TO=2\n.meas whole INTEG i(C1)\n.meas series INTEG i(C3) TO=2\n.meas source INTEG i(V1) TO=2\n.meas load INTEG "
      "i(R1) TO=2\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("up") == near(2.0 * 3.0));
  CHECK(m.value.at("whole") == near(0.0));
  CHECK(m.value.at("series") == near(3.0 * 6.0 / 9.0 * 3.0));
  CHECK(m.value.at("load") == near(1.0 + 4.0));
  CHECK(m.value.at("source") == near(-(6.0 + 6.0 + 5.0)));
}

// At t = 0 the step starts from the operating point, 1 V; with uic it belongs to the start.
TEST_CASE("a step at t = 0 counts, unless the run starts with uic", "[unit]") {
  const std::string deck = "start\nV1 a 0 PULSE(1 4 0 0 0 9 0)\nC1 a 0 2\n.save v(a)\n.meas q INTEG i(C1)\n.tran 1 2";
  CHECK(measure_deck(deck + "\n").value.at("q") == near(2.0 * 3.0));
  CHECK(measure_deck(deck + " uic\n").value.at("q") == near(0.0));
}

// L·ΔI of a current source's step through an inductor; a ramp before and after it has C·dv/dt of its own.
TEST_CASE("fluxes of steps, and steps between ramps", "[unit]") {
  const Measured flux = measure_deck("flux\nI1 0 a PULSE(1 3 1 0 0 9 0)\nL1 a 0 5\n.tran 1 2\n.save i(L1)\n.meas flux INTEG v(a)\n");
  REQUIRE(flux.messages.empty());
  CHECK(flux.value.at("flux") == near(5.0 * 2.0));
  const Measured ramp = measure_deck("ramp\nV1 a 0 PWL(0 0 1 1 1 5 2 7)\nC1 a 0 2\n.tran 1 3\n.save v(a)\n.meas q INTEG i(C1)\n");
  REQUIRE(ramp.messages.empty());
  CHECK(ramp.value.at("q") == near(2.0 * 7.0));
}

// A diode takes over between two capacitors: 4 V steps onto C1 through D1 into C2 at rest; both end at C1 and C2 in series, 2·1/3·(4 V) through the diode.
TEST_CASE("a diode passes a charge where a source's step and its own impulse come together", "[unit]") {
  const Measured m = measure_deck(
      "pump\nV1 a 0 PULSE(0 4 1 0 0 9 0)\nC1 a b 2\nD1 b c DI\nC2 c 0 1\n.model DI D\n.tran 1 2 uic\n.save v(c)\n"
      ".meas diode INTEG i(D1)\n.meas first INTEG i(C1)\n.meas source INTEG i(V1)\n");
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("diode") == near(2.0 / 3.0 * 4.0));
  CHECK(m.value.at("first") == near(2.0 / 3.0 * 4.0));
  CHECK(m.value.at("source") == near(-2.0 / 3.0 * 4.0));
}
