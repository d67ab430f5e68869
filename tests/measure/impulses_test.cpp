// Charges and fluxes that are moved in no time are part of INTEG and AVG.

#include <catch2/catch.hpp>
#include <cmath>

#include "measure/measured.hpp"

using pwlsim::test::measure_deck;
using pwlsim::test::Measured;

namespace {

constexpr double exact_reltol = 0.0, sparse_reltol = 1e-4;  // tolerances: which engine
/// Of numbers of order one: rounding, and what the sparse engine's Euler steps leave of a jump in circuits without a time constant.
constexpr double rounding = 1e-14, step_error = 1e-11;

Approx near_on(double value, double engine = exact_reltol) {
  const double error = engine == exact_reltol ? rounding : step_error;
  return Approx(value).epsilon(error).margin(error);
}

}  // namespace

// Charge is kept: both capacitors end at (C1·V1 + C2·V2)/(C1 + C2), so that C1·C2/(C1 + C2)·(V1 - V2) passes the switch. At 1 s: 2·1/3·3 V.
TEST_CASE("INTEG and AVG hold the charge that an ideal switch moves in no time", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const Measured m = measure_deck(
      "two capacitors\nC1 a 0 2 ic=3\nC2 b 0 1 ic=0\nS1 a b g 0 SW\nVg g 0 PULSE(0 1 1 0 0 9 0)\n.model SW SW(Vt=0.5)\n.tran 1 4 "
      "uic\n.save v(a)\n"
      ".meas through INTEG i(S1)\n.meas into INTEG i(C2)\n.meas out INTEG i(C1)\n.meas mean AVG i(S1)\n.meas sum INTEG "
      "3-2*i(C2)/4-(-i(C1))\n"
      ".meas before INTEG i(S1) TO=1\n.meas after INTEG i(S1) FROM=1\n.meas later INTEG i(S1) FROM=1.5\n.meas product INTEG i(S1)*i(S1)\n",
      engine);
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("through") == near_on(2.0, engine));
  CHECK(m.value.at("into") == near_on(2.0, engine));
  CHECK(m.value.at("out") == near_on(-2.0, engine));
  CHECK(m.value.at("mean") == near_on(2.0 / 4.0, engine));
  CHECK(m.value.at("sum") == near_on(3.0 * 4.0 - 2.0 * 2.0 / 4.0 - 2.0, engine));
  CHECK(m.value.at("before") == near_on(0.0, engine));
  CHECK(m.value.at("after") == near_on(2.0, engine));
  CHECK(m.value.at("later") == near_on(0.0, engine));
  CHECK(m.value.at("product") == near_on(0.0, engine));  // not defined: left out, and said
  CHECK(m.result("product").left_out == "the impulse at t = 1 s: i(S1)*i(S1) has no integral over it");
  CHECK(m.result("through").left_out.empty());
}

// C·ΔV; of two capacitors in series across the source C1·C2/(C1 + C2)·ΔV, and the source carries the sum, backwards.
TEST_CASE("INTEG holds the charge that a step of a source moves", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const Measured m = measure_deck(
      "step\nV1 a 0 PULSE(1 4 1 0 0 2 0)\nC1 a 0 2\nC2 a b 3\nC3 b 0 6\nR1 a 0 1\n.tran 1 5\n.save v(a)\n"
      ".meas up INTEG i(C1) TO=2\n.meas whole INTEG i(C1)\n.meas series INTEG i(C3) TO=2\n.meas source INTEG i(V1) TO=2\n.meas load INTEG "
      "i(R1) TO=2\n",
      engine);
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("up") == near_on(2.0 * 3.0, engine));
  CHECK(m.value.at("whole") == near_on(0.0, engine));
  CHECK(m.value.at("series") == near_on(3.0 * 6.0 / 9.0 * 3.0, engine));
  CHECK(m.value.at("load") == near_on(1.0 + 4.0, engine));
  CHECK(m.value.at("source") == near_on(-(6.0 + 6.0 + 5.0), engine));
}

// At t = 0 the step starts from the operating point, 1 V; with uic it belongs to the start.
TEST_CASE("a step at t = 0 counts, unless the run starts with uic", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const std::string deck = "start\nV1 a 0 PULSE(1 4 0 0 0 9 0)\nC1 a 0 2\n.save v(a)\n.meas q INTEG i(C1)\n.tran 1 2";
  CHECK(measure_deck(deck + "\n", engine).value.at("q") == near_on(2.0 * 3.0, engine));
  CHECK(measure_deck(deck + " uic\n", engine).value.at("q") == near_on(0.0, engine));
}

// L·ΔI of a current source's step through an inductor; a ramp before and after it has C·dv/dt of its own.
TEST_CASE("fluxes of steps, and steps between ramps", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const Measured flux =
      measure_deck("flux\nI1 0 a PULSE(1 3 1 0 0 9 0)\nL1 a 0 5\n.tran 1 2\n.save i(L1)\n.meas flux INTEG v(a)\n", engine);
  REQUIRE(flux.messages.empty());
  CHECK(flux.value.at("flux") == near_on(5.0 * 2.0, engine));
  const Measured ramp = measure_deck("ramp\nV1 a 0 PWL(0 0 1 1 1 5 2 7)\nC1 a 0 2\n.tran 1 3\n.save v(a)\n.meas q INTEG i(C1)\n", engine);
  REQUIRE(ramp.messages.empty());
  CHECK(ramp.value.at("q") == near_on(2.0 * 7.0, engine));
}

// A diode takes over between two capacitors: 4 V steps onto C1 through D1 into C2 at rest; both end at C1 and C2 in series, 2·1/3·(4 V) through the diode.
TEST_CASE("a diode passes a charge where a source's step and its own impulse come together", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const Measured m = measure_deck(
      "pump\nV1 a 0 PULSE(0 4 1 0 0 9 0)\nC1 a b 2\nD1 b c DI\nC2 c 0 1\n.model DI D\n.tran 1 2 uic\n.save v(c)\n"
      ".meas diode INTEG i(D1)\n.meas first INTEG i(C1)\n.meas source INTEG i(V1)\n",
      engine);
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("diode") == near_on(2.0 / 3.0 * 4.0, engine));
  CHECK(m.value.at("first") == near_on(2.0 / 3.0 * 4.0, engine));
  CHECK(m.value.at("source") == near_on(-2.0 / 3.0 * 4.0, engine));
}

// A source of V gives C·V² while an ideal switch puts an empty C across it: its voltage is the same before and after the impulse. Of what the switch
// takes, half of that, only a shape of the impulse could tell.
TEST_CASE("a product holds an impulse whose factor is steady, and says when it is not", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const Measured m = measure_deck(
      "charge\nV1 in 0 4\nS1 in b g 0 SW\nC1 b 0 2\nVg g 0 PULSE(0 1 1 0 0 9 0)\n.model SW SW(Vt=0.5)\n.tran 1 4 uic\n.save v(b)\n"
      ".meas given INTEG -v(in)*i(V1)\n.meas atbegin AVG -v(in)*i(V1) FROM=1\n.meas scaled INTEG (3-v(in)/2)*i(S1)+v(in)*0.5\n"
      ".meas lost INTEG v(in,b)*i(S1)\n.meas moved INTEG abs(i(S1))\n.meas rms RMS i(S1)\n.meas most MAX i(S1)\n.meas least MIN i(S1)\n"
      ".meas rate AVG v(b)*v(b)\n.meas late INTEG v(in,b)*i(S1) FROM=1.5\n",
      engine);
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("given") == near_on(2.0 * 4.0 * 4.0, engine));
  CHECK(m.value.at("atbegin") == near_on(2.0 * 4.0 * 4.0 / 3.0, engine));
  CHECK(m.value.at("scaled") == near_on((3.0 - 4.0 / 2.0) * 8.0 + 4.0 * 4.0 * 0.5, engine));
  for (const char* steady : {"given", "atbegin", "scaled", "least", "rate", "late"}) CHECK(m.result(steady).left_out.empty());
  CHECK(m.result("lost").left_out == "the impulse at t = 1 s: v(in,b)*i(S1) has no integral over it");
  CHECK(m.result("moved").left_out == "the impulse at t = 1 s: abs(i(S1)) has no integral over it");
  CHECK(m.result("rms").left_out == "the impulse at t = 1 s: its square has no integral");
  CHECK(m.result("most").left_out == "the impulse at t = 1 s: it is infinite");
}

// The supply of a charge pump: D1 fills C1 again at each fall of the clock, by an impulse. Energy = 5 V times charge.
TEST_CASE("the energy of a supply is its voltage times the charge, impulses and all", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const Measured m = measure_deck(
      "pump\nVin in 0 5\nVc clk 0 PULSE(0 5 0 0 0 5u 10u)\nD1 in a DI\nC1 a clk 1u\nD2 a b DI\nC2 b 0 2u\nRL b 0 1k\n.model DI D\n.tran 1u "
      "0.2m\n"
      ".save v(b)\n.meas charge INTEG -i(Vin)\n.meas energy INTEG -v(in)*i(Vin)\n.meas flow INTEG -i(Vin) FROM=12u TO=14u\n"
      ".meas clock INTEG -v(clk)*i(Vc)\n",
      engine);
  REQUIRE(m.messages.empty());
  CHECK(m.value.at("flow") == near_on(0.0, engine));
  CHECK(m.value.at("charge") > 1e-7);  // 10 µA flow into the load at most times, for 0.2 ms
  CHECK(m.value.at("energy") == Approx(5.0 * m.value.at("charge")).epsilon(step_error));
  CHECK(m.result("energy").left_out.empty());
  CHECK(m.result("clock").left_out == "impulses at 40 instants, first at t = 0 s: -v(clk)*i(Vc) has no integral over them");
}

// q δ(t − t0) in a window of length T: mean q/T, every harmonic 2q/T with the phase 90° − k·360°·t0/T of a sine.
TEST_CASE(".four holds impulses, and their distortion has no bound", "[unit]") {
  const double engine = GENERATE(exact_reltol, sparse_reltol);
  const Measured m =
      measure_deck("impulse\nV1 a 0 PULSE(0 3 1 0 0 9 0)\nC1 a 0 2\n.tran 1 8\n.save v(a)\n.four 0.125 5 i(C1) v(a)\n", engine);
  REQUIRE(m.messages.empty());
  REQUIRE(m.results.fourier.size() == 2);
  const auto& current = m.results.fourier[0];
  REQUIRE(current.harmonics.size() == 6);
  CHECK(current.harmonics[0].magnitude == near_on(6.0 / 8.0, engine));
  for (std::size_t k = 1; k < current.harmonics.size(); ++k) {
    const double phase = 90.0 - 45.0 * static_cast<double>(k);
    CHECK(current.harmonics[k].magnitude == near_on(2.0 * 6.0 / 8.0, engine));
    CHECK(current.harmonics[k].phase == near_on(phase, engine).margin(360.0 * step_error));
  }
  CHECK(std::isinf(current.total_distortion));
  CHECK(current.listed_distortion == near_on(2.0, engine));
  CHECK(std::isfinite(m.results.fourier[1].total_distortion));
}

// Hard case 6, from x1 = 1: x1''' = u, y = x1. It comes to its stop at t = 1 with x2 = x1' = -1, and the derivative of an impulse in u makes x2 zero, by
// way of an impulse of x3 = x1''.
TEST_CASE("where derivatives of impulses act, measurements of what takes part in them fail, and the run does not", "[hard]") {
  const Measured m = measure_deck(
      "triple\nC1 x1 0 1 ic=1\nG1 0 x1 x2 0 1\nC2 x2 0 1 ic=-1\nG2 0 x2 x3 0 1\nC3 x3 0 1 ic=0\nF1 0 x3 VF 1\nE1 k 0 x1 0 1\nVF s k 0\n"
      "D1 0 s DI\n.model DI D\n.save v(x1)\n.tran 0.1 2 uic\n"
      ".meas u INTEG i(D1)\n.meas mean AVG i(D1)\n.meas taken INTEG i(C3)\n.meas x3 INTEG v(x3)\n.meas power INTEG i(D1)*v(x2)\n"
      ".meas before INTEG v(x3) TO=0.9\n.meas after INTEG i(D1) FROM=1.5\n.meas x2 INTEG v(x2)\n.meas x1 INTEG v(x1)\n.meas most MAX "
      "i(D1)\n"
      ".four 0.5 i(D1) v(x1)\n");
  REQUIRE(m.messages.empty());
  for (const char* name : {"u", "mean", "taken", "x3", "power"}) {
    INFO(name);
    CHECK_THAT(m.result(name).failure, Catch::StartsWith("impulses of higher order act at t = "));
  }
  CHECK(m.value.at("before") == near_on(0.0));
  CHECK(m.value.at("after") == near_on(0.0));
  CHECK(m.value.at("x2") == near_on(-1.0));       // x1(2) - x1(0)
  CHECK(m.value.at("x1") == near_on(1.0 / 2.0));  // of 1 - t to t = 1
  CHECK_FALSE(m.result("most").left_out.empty());
  REQUIRE(m.results.fourier.size() == 2);
  CHECK_THAT(m.results.fourier[0].failure, Catch::StartsWith("impulses of higher order act at t = "));
  CHECK(m.results.fourier[1].failure.empty());
}

// Time constants from 1e-16 s to 3e-11 s, shorter than the Euler steps of a run of 1 ms: charge and voltage of a capacitor go together, but for what the
// parabola of the first long step makes of the rest.
TEST_CASE("what moves within the short steps of the sparse engine is part of INTEG", "[unit]") {
  const double reltol = GENERATE(1e-4, 1e-6);
  constexpr double parabola = 2e-4;
  for (const char* resistance : {"1e-10", "1e-7", "1e-6", "1e-5", "3e-5"}) {
    INFO(resistance << " Ohm");
    const Measured m = measure_deck(std::string("fast\nV1 a 0 PULSE(0 5 0.3m 0 0 9 0)\nR1 a b ") + resistance +
                                        "\nC1 b 0 1u\nR2 b 0 1k\n.tran 10u 1m\n.save v(b)\n.meas charge INTEG i(C1) TO=0.8m\n",
                                    reltol);
    REQUIRE(m.messages.empty());
    CHECK(m.value.at("charge") == Approx(5.0 * 1e-6).epsilon(parabola));
  }
}
