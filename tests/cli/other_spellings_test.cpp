// Spellings of other simulators' decks, one small deck each.

#include <catch2/catch.hpp>
#include <cmath>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

TEST_CASE("a sign may stand before braces", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_deck(scratch,
                                     "signs\n.param vdd=30\nV1 a 0 -{vdd}\nV2 b 0 +'vdd'\nV3 c 0 PULSE(-{vdd} {vdd} 1m 0 0 1 2)\nR1 a 0 "
                                     "1\nR2 b 0 1\nR3 c 0 1\n.tran 1m 2m\n"
                                     ".meas a FIND v(a) AT=1m\n.meas b FIND v(b) AT=1m\n.meas c AVG v(c) TO=1m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "a") == -30.0);
  CHECK(value_of(finished.out, "b") == 30.0);
  CHECK(value_of(finished.out, "c") == Approx(-30.0));
}

TEST_CASE("a value as DC(48), a model in braces, .probe tran", "[unit]") {
  const Scratch scratch;
  // 48 V less 0.5 V over 2 Ω and 0.5 Ω.
  const Finished finished = run_deck(scratch,
                                     "old spellings\nV1 a 0 dc(48)\nD1 a b DX\nR1 b 0 2\n.model DX D {Ron=0.5 Roff=1T Vfwd=0.5}\n"
                                     ".model SX SW {Ron=1 Vt=2}\n.tran 1m 2m\n.probe tran v(b) i(R1)\n.meas i FIND i(R1) AT=1m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "i") == Approx(47.5 / 2.5).epsilon(1e-9));
  CHECK_THAT(read_file(scratch / "d.csv"), Catch::Matchers::StartsWith("time,v(b),i(R1)\n"));
  CHECK_THAT(run_deck(scratch, "braces\nV1 a 0 {1+}\nR1 a 0 1\n.tran 1m 2m\n").err, Contains("error[E-syntax"));
}

TEST_CASE("a file whose name has blanks", "[unit]") {
  const Scratch scratch;
  scratch.write("my diodes.lib", "* models\n.model DX D(Ron=0.5 Vfwd=0.5)\n");
  const std::string circuit = "V1 a 0 48\nD1 a b DX\nR1 b 0 2\n.tran 1m 2m\n.meas i FIND i(R1) AT=1m\n";
  const Finished finished = run_deck(scratch, "blanks\n.include my diodes.lib\n" + circuit);
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "i") == Approx(19.0).epsilon(1e-9));
  CHECK_THAT(run_deck(scratch, "blanks\n.include no such.lib\n" + circuit).err, Contains("error[E-syntax-include]"));
}

TEST_CASE("times of crossings: TIME WHEN, and at the end of the run", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_deck(scratch,
                                     "times\nV1 a 0 PWL(0 0 1m 1)\nR1 a 0 1\n.tran 1u 1m\n.meas tran t TIME WHEN v(a)=0.25\n"
                                     ".meas d TRIG v(a)=0.5 TARG v(a)=1\n.meas w WHEN v(a)=1\n.meas none WHEN v(a)=1.001\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "t") == Approx(0.25e-3).epsilon(1e-9));
  CHECK(value_of(finished.out, "d") == Approx(0.5e-3).epsilon(1e-9));
  CHECK(value_of(finished.out, "w") == Approx(1e-3).epsilon(1e-9));
  CHECK_THAT(finished.err, Contains("measurement none failed"));
}

TEST_CASE("a triangle whose top is given a picosecond is no cut pulse", "[unit]") {
  const Scratch scratch;
  const std::string rest = "R1 a 0 1\n.tran 1u 200u\n.meas m AVG v(a)\n";
  const Finished finished = run_deck(scratch, "triangle\nV1 a 0 PULSE(-1 1 0 10u 10u 1p 20u)\n" + rest);
  CHECK(finished.status == 0);
  CHECK(std::abs(value_of(finished.out, "m")) < 1e-6);
  CHECK_THAT(finished.err, !Contains("W-pulse-cut"));
  CHECK_THAT(run_deck(scratch, "cut\nV1 a 0 PULSE(-1 1 0 10u 10u 1u 20u)\n" + rest).err, Contains("W-pulse-cut"));
}

TEST_CASE("a thyristor of two transistors latches by itself", "[unit]") {
  const Scratch scratch;
  // Fired at a quarter of the period: 100 V·(1 + 0)/(2π·50 Ω) less some 1 V of drop for a quarter of the time. ngspice-39: 0.3147 A.
  const Finished finished = run_deck(
      scratch,
      "scr\nV1 a 0 SIN(0 100 50)\nRL a an 50\nQ1 g1 g2 an PN\nQ2 g2 g1 0 NP\n.model PN PNP(BF=5 IS=1e-14)\n.model NP NPN(BF=20 IS=1e-14)\n"
      "Vg x 0 PULSE(0 5 5m 1u 1u 200u 20m)\nRg x g1 1k\nRk g1 0 1k\n.tran 10u 60m\n.meas tran ia avg i(RL) from 20m to 60m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "ia") == Approx(100.0 / (2.0 * M_PI * 50.0) - 0.25 * 0.9 / 50.0).epsilon(0.01));
  CHECK_THAT(finished.err, Contains("note[N-not-unique]"));
}

TEST_CASE("parts at hand that a deck calls as subcircuits", "[unit]") {
  const Scratch scratch;
  // A triangle of ±1 V beside 0.5 V: the collector is open for a quarter of the time, else at 60 Ω of 10 kΩ and 60 Ω.
  const Finished finished =
      run_deck(scratch,
               "parts\nV1 vcc 0 10\nV2 t 0 PULSE(-1 1 0 0.5m 0.5m 0 1m)\nV3 r 0 0.5\nX1 t r vcc 0 o LM393\nR1 vcc o 10k\n"
               "V4 a 0 10\nX2 a b 1N4148\nR2 b 0 1k\nX3 c vcc 0 IRF540N\nR3 vcc c 1k\n.tran 10u 4m\n.meas o AVG v(o)\n"
               ".meas b AVG v(b)\n.meas c AVG v(c)\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "o") == Approx(0.25 * 10.0 + 0.75 * 10.0 * 60.0 / 10060.0).epsilon(1e-4));
  CHECK(value_of(finished.out, "b") == Approx(9.3).epsilon(0.02));  // a silicon diode at 9 mA
  CHECK(value_of(finished.out, "c") < 1e-3);
  CHECK_THAT(finished.err, Contains("with the nodes anode cathode") && Contains("with the nodes drain gate source"));
}

TEST_CASE("PSpice's brackets around nodes in .PROBE", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_deck(
      scratch, "brackets\nV1 1 2 5\nR1 1 0 1\nR2 2 0 1\n.TRAN 1u 2u\n.PROBE/CSDF V([1],[2]) V([1]) I(R1)\n.meas v FIND V(1) AT=1u\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "v") == Approx(2.5));
  CHECK_THAT(read_file(scratch / "d.csv"), Catch::Matchers::StartsWith("time,\"V([1],[2])\",V([1]),I(R1)\n"));
}

TEST_CASE("transistors whose gates undo one another are told what they lack", "[unit]") {
  const Scratch scratch;
  // Each one's drain is the other's gate, through a diode: without time neither may be on nor off.
  const Finished finished = run_deck(
      scratch,
      "zvs driver\nV1 vcc 0 24\nL1 vcc ct 100u\nLa ct a 10u\nLb ct b 10u\nK1 La Lb 0.99\nC1 a b 660n\nM1 a g1 0 0 MX\nM2 b g2 0 0 MX\n"
      "I1 0 g1 50m\nI2 0 g2 50m\nR3 g1 0 10k\nR4 g2 0 10k\nD1 g1 b DX\nD2 g2 a DX\n.model MX VDMOS(Vto=3 Ron=75m "
      "Vfwd=0.8)\n"
      ".model DX D(Vfwd=0.7)\n.ic V(a)=1\n.tran 1u 2m uic\n");
  CHECK(finished.status == 1);
  CHECK_THAT(finished.err, Contains("error[E-no-settle]") && Contains("a capacitor from gate to source"));
}

TEST_CASE("a resistance between the drains lets a driver without gate time settle", "[unit]") {
  const Scratch scratch;
  // Each gate then hangs on its own drain too. Over a period a drain, a half sine in half of the time, averages the 24 V of the supply: its peak is π·24 V.
  const double tolerance = 0.04;  // of the ripple that the choke of 100 µH leaves
  const Finished finished = run_deck(
      scratch,
      "zvs driver\nV1 vcc 0 24\nL1 vcc ct 100u\nLa ct a 10u\nLb ct b 10u\nK1 La Lb 0.99\nC1 a b 660n\nM1 a g1 0 0 MX\nM2 b g2 0 0 MX\n"
      "I1 0 g1 50m\nI2 0 g2 50m\nR3 g1 0 10k\nR4 g2 0 10k\nD1 g1 b DX\nD2 g2 a DX\nR5 a b 200\n.model MX VDMOS(Vto=3 Ron=75m Vfwd=0.8)\n"
      ".model DX D(Vfwd=0.7)\n.ic V(a)=1\n.tran 1u 2m uic\n.meas pk MAX v(a) from=1.5m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "pk") == Approx(M_PI * 24.0).epsilon(tolerance));
}
