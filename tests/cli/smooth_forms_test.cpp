// Smooth functions and products that decks have: of voltages that are numbers, to show powers, in polynomials; XSPICE's oscillators.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

using std::numbers::pi;

Finished ran(const std::string& deck) {
  const Scratch scratch;
  Finished finished = run_deck(scratch, deck);
  INFO(finished.err);
  CHECK(finished.status == 0);
  return finished;
}

}  // namespace

TEST_CASE("voltages of constant sources are numbers in sines, powers and products", "[unit]") {
  const Finished finished =
      ran("numbers\nV1 f 0 50\nV2 m 0 0.8\nE1 g 0 f 0 2\nB1 a 0 V=V(m)*sin(2*pi*V(f)*time)\nB2 b 0 V=V(a)/V(m)+sqrt(V(g))\n"
          "B3 c 0 V=V(m)**0.5*cos(2*pi*V(g)*time)\nR1 a 0 1\nR2 b 0 1\nR3 c 0 1\n.tran 1u 40m\n.meas a RMS V(a)\n.meas b AVG V(b)\n.meas c "
          "RMS V(c)\n");
  CHECK(value_of(finished.out, "a") == Approx(0.8 / std::sqrt(2.0)).epsilon(1e-9));
  CHECK(value_of(finished.out, "b") == Approx(10.0).epsilon(1e-9));
  CHECK(value_of(finished.out, "c") == Approx(std::sqrt(0.8) / std::sqrt(2.0)).epsilon(1e-9));
}

TEST_CASE("a source that .step changes is another number in each run", "[unit]") {
  const Finished finished =
      ran("stepped\nV1 m 0 1\nV2 a 0 SIN(0 1 50)\nB1 b 0 V=V(m)*V(a)\nR1 b 0 1\n.step V1 list 2 3\n.tran 1u 20m\n.meas b RMS V(b)\n");
  CHECK_THAT(finished.out, Contains("2,1.41421356") && Contains("3,2.12132034"));
}

TEST_CASE("asin of a sine in time is a triangle", "[unit]") {
  // Triangles of ±1 with 1 kHz: an RMS of 1/√3; at t = 50 µs, 36° behind the start, asin(sin(1·π/10))·2/π = 0.2.
  const Finished finished = ran(
      "triangles\nB1 a 0 V=(2/pi)*asin(sin(2*pi*1k*time))\nB2 b 0 V=(2/pi)*acos(cos(2*pi*1k*time))\nB3 c 0 V=asin(-sin(-2*pi*1k*time+2))\n"
      "R1 a 0 1\nR2 b 0 1\nR3 c 0 1\n.tran 1u 3m\n.meas a RMS V(a)\n.meas at FIND V(a) AT=50u\n.meas later FIND V(a) AT=2.4m\n"
      ".meas b AVG V(b)\n.meas b0 FIND V(b) AT=0\n.meas c FIND V(c) AT=0.1m\n");
  CHECK(value_of(finished.out, "a") == Approx(1.0 / std::sqrt(3.0)).epsilon(1e-9));
  CHECK(value_of(finished.out, "at") == Approx(0.2).epsilon(1e-9));
  CHECK(value_of(finished.out, "later") == Approx(0.4).epsilon(1e-9));
  CHECK(value_of(finished.out, "b") == Approx(1.0).epsilon(1e-9));
  CHECK(std::abs(value_of(finished.out, "b0")) < 1e-9);
  CHECK(value_of(finished.out, "c") == Approx(std::asin(-std::sin(-0.2 * pi + 2.0))).epsilon(1e-9));
}

TEST_CASE("a steep tanh of a signal is a comparator, and says so; another one is refused", "[unit]") {
  // A comparator of gain 1000 beside a triangle of ±1: low for 3/4 of the time, ±12 V.
  const Finished finished =
      ran("tanh\nV1 t 0 PULSE(-1 1 0 0.5m 0.5m 0 1m)\nB1 a 0 V=12*tanh(1000*(-0.5-V(t)))\nR1 a 0 1\n.tran 1u 4m\n.meas a AVG V(a)\n");
  CHECK(value_of(finished.out, "a") == Approx(-6.0).epsilon(1e-9));
  CHECK_THAT(finished.err, Contains("note[N-idealised]") && Contains("limit(x,-1,1)"));
  const Scratch scratch;
  CHECK_THAT(run_deck(scratch, "tanh\nV1 t 0 SIN(0 1 50)\nB1 a 0 V=tanh(V(t))\nR1 a 0 1\n.tran 1u 4m\n").err,
             Contains("error[E-not-piecewise-linear]") && Contains("limit(x,-1,1)"));
}

TEST_CASE("a power that nothing reads is left out, with a warning", "[unit]") {
  const std::string circuit = "power\nV1 a 0 SIN(0 10 50)\nR1 a 0 10\nB1 p 0 V=V(a)*I(V1)\nR2 p pf 10k\nC2 pf 0 1u\n.tran 1m 40m\n";
  const Scratch scratch;
  const Finished finished = run_deck(scratch, circuit + ".backanno\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("warning[W-unread-part]") && Contains("V(p), V(pf) are left out, with R2, C2"));
  CHECK_THAT(read_file(scratch / "d.csv"), Catch::Matchers::StartsWith("time,v(a),i(V1)\n"));
  CHECK_THAT(run_deck(scratch, circuit).err, Contains("error[E-not-piecewise-linear]"));  // of a deck that LTspice did not write
}

TEST_CASE("a product that something reads stays an error", "[unit]") {
  const Scratch scratch;
  const auto said = [&](const std::string& cards) {
    const Finished finished = run_deck(scratch, "read\nV1 a 0 SIN(0 10 50)\nR1 a 0 10\n.tran 1m 40m\n.backanno\n" + cards);
    CHECK(finished.status == 2);
    return finished.err;
  };
  const std::string power = "B1 p 0 V=V(a)*I(V1)\nR2 p 0 1k\n";
  const auto is_error = Contains("error[E-not-piecewise-linear]: B1: a product of signals");
  CHECK_THAT(said(power + ".save v(p)\n"), is_error);
  CHECK_THAT(said(power + "R3 p pf 1k\nC3 pf 0 1u\n.meas m AVG v(pf)\n"), is_error);
  CHECK_THAT(said(power + ".ic v(p)=1\n"), is_error);
  CHECK_THAT(said(power + "E1 q 0 p 0 2\nR3 q 0 1k\n"), is_error);
  CHECK_THAT(said("B1 p 0 V=V(a)*I(V1)\nL2 p 0 1m\n"), is_error);        // a power stage
  CHECK_THAT(said("B1 a 0 I=V(a)*V(a)\n"), is_error);                    // within what it reads
  CHECK_THAT(said(power + "B2 q 0 V=idt(V(p))\nR4 q 0 1\n"), is_error);  // read by what has a form
}

TEST_CASE("products of controls in POLY are switched forms", "[unit]") {
  // v(c) = 1 + 2 v(a) + 3 v(g) + 5 v(a)·v(g), of which v(g) is 0 for a half and 2 for a half of the time, v(a) = 4: 9 and 9 + 6 + 40.
  const Finished finished =
      ran("poly\nV1 a 0 PWL(0 4 1 4.000001)\nV2 g 0 PULSE(0 2 0 0 0 1m 2m)\nE1 c 0 POLY(2) a 0 g 0 1 2 3 0 5\nR1 c 0 1\n"
          "G1 0 d POLY(2) a 0 g 0 0 0 0 0 5\nR2 d 0 1\n.tran 1u 4m\n.meas c AVG V(c)\n.meas d AVG V(d)\n");
  CHECK(value_of(finished.out, "c") == Approx(0.5 * (9.0 + 55.0)).epsilon(1e-6));
  CHECK(value_of(finished.out, "d") == Approx(20.0).epsilon(1e-6));
  const Scratch scratch;
  CHECK_THAT(run_deck(scratch, "square\nV1 a 0 SIN(0 1 50)\nE1 c 0 POLY(1) a 0 0 0 1\nL1 c 0 1\n.tran 1m 2m\n").err,
             Contains("error[E-poly]"));
}

TEST_CASE("decks for ngspice are told what they have otherwise here", "[unit]") {
  const Scratch scratch;
  const std::string cards = "V1 a 0 PULSE(-1 1 0 5u 5u 0 10u)\nD1 a b DX\nR1 b 0 1\n.model DX D()\n.tran 1u 40u\n";
  for (const std::string& deck : {".title KiCad schematic\n" + cards, "ngspice\n" + cards + ".control\nrun\n.endc\n"}) {
    const std::string told = run_deck(scratch, deck).err;
    CHECK_THAT(told, Contains("note[N-pulse-without-top]: V1"));
    CHECK_THAT(told, Contains("note[N-ideal-diode]: the model DX"));
  }
  const std::string plain = run_deck(scratch, "any\n" + cards).err;
  CHECK_THAT(plain, !Contains("N-pulse-without-top") && !Contains("N-ideal-diode"));
}

TEST_CASE("XSPICE's oscillators", "[unit]") {
  // At 2 kHz (a control of 0.25 between 1 and 5 kHz): from -1 V to 2 V in 30 % of the period; high for its last 30 %.
  // ngspice-39: v(tri) = 0.528 V at 76.4 us; the square wave rises at 350 us; d_pwm rises at 125 us and falls at 375 us.
  const std::string models =
      ".model t1 triangle(cntl_array=[0 1] freq_array=[1000 5000] out_low=-1 out_high=2 duty_cycle=0.3)\n"
      ".model t2 triangle(cntl_array=[0 1] freq_array=[2k {f}] out_low=-1 out_high=2 duty_cycle=0.3)\n"
      ".model s1 square(cntl_array=[0 1] freq_array=[1000 5000] out_low=-1 out_high=2 duty_cycle=0.3 rise_time=1e-7 fall_time=1e-7)\n"
      ".model n1 sine(cntl_array=[0 1] freq_array=[2k 2k] out_low=-1 out_high=2)\n"
      ".model o1 d_osc(cntl_array=[0 1] freq_array=[1000 5000] duty_cycle=0.3 init_phase=0)\n"
      ".model p1 d_pwm(frequency=2k cntl_array=[-1 1] dc_array=[0.1 0.9] init_phase=90)\n"
      ".model dac dac_bridge(out_low=0 out_high=5)\n.param f=2k\n";
  const Finished finished =
      ran("oscillators\nV1 c 0 0.25\nV2 z 0 0\nA1 c tri t1\nA2 c trj t2\nA3 c sq s1\nA4 c si n1\nA5 c dd o1\nA6 z de p1\nA7 [dd de] [ao "
          "ae] dac\n" +
          models +
          "R1 tri 0 1\nR2 trj 0 1\nR3 sq 0 1\nR4 si 0 1\nR5 ao 0 1\nR6 ae 0 1\n.tran 1u 4m\n.meas tri FIND V(tri) AT=76.4u\n"
          ".meas trj FIND V(trj) AT=576.4u\n.meas si FIND V(si) AT=125u\n.meas sq AVG V(sq)\n.meas rise WHEN V(sq)=0 RISE=1\n"
          ".meas ao AVG V(ao)\n.meas up WHEN V(ae)=2.5 RISE=1\n.meas down WHEN V(ae)=2.5 FALL=1\n");
  CHECK(value_of(finished.out, "tri") == Approx(-1.0 + 3.0 * 76.4 / 150.0).epsilon(1e-6));
  CHECK(value_of(finished.out, "trj") == Approx(-1.0 + 3.0 * 76.4 / 150.0).epsilon(1e-6));
  CHECK(value_of(finished.out, "si") == Approx(2.0).epsilon(1e-9));
  CHECK(value_of(finished.out, "sq") == Approx(0.7 * -1.0 + 0.3 * 2.0).epsilon(1e-6));
  CHECK(value_of(finished.out, "rise") == Approx(350e-6).epsilon(1e-6));
  CHECK(value_of(finished.out, "ao") == Approx(1.5).epsilon(1e-6));
  CHECK(value_of(finished.out, "up") == Approx(125e-6).epsilon(1e-6));
  CHECK(value_of(finished.out, "down") == Approx(375e-6).epsilon(1e-6));
}

TEST_CASE("what describes a capacitor has no effect, and an empty value is none", "[unit]") {
  // 1 kΩ and 1 µF for one time constant.
  const Finished finished =
      ran("parts\nV1 a 0 1\nR1 a b 1k tol=1 pwr=0.1\nC1 b 0 1u V=35 Irms=1.9 MTBF=5000 mfg=\"Some Maker\" pn=\"X 1\" type=\"Al\" ppPkg=1\n"
          "X1 b c gain \"\"\nR2 c 0 1\n.subckt gain in out\nE1 out 0 in 0 2\n.ends\n.tran 1u 1m uic\n.meas v FIND V(c) AT=1m\n");
  CHECK(value_of(finished.out, "v") == Approx(2.0 * (1.0 - std::exp(-1.0))).epsilon(1e-6));
}

TEST_CASE("PSpice's step, and cards of PSpice and Xyce that ask for nothing here", "[unit]") {
  // A sine is above zero for half of its period.
  const Finished finished =
      ran("step\nV1 a 0 SIN(0 10 50)\nB1 b 0 V={3*STP(V(a))}\nR1 b 0 1\n.tran 1u 40m\n.WATCH TRAN V(b)\n.PREPROCESS REPLACEGROUND TRUE\n"
          ".VECTOR b\n.RESULT {V(b)}\n.FFT V(b)\n.meas b AVG V(b)\n.meas c PARAM stp(b)+stp(-b)\n");
  CHECK(value_of(finished.out, "b") == Approx(1.5).epsilon(1e-9));
  CHECK(value_of(finished.out, "c") == Approx(1.0).epsilon(1e-9));
  for (const char* card : {".WATCH", ".PREPROCESS", ".VECTOR", ".RESULT", ".FFT"}) {
    INFO(card);
    CHECK_THAT(finished.err, Contains("warning[W-ignored-card]: " + std::string(card) + " is ignored"));
  }
}

TEST_CASE("a run in which nothing moves says so, where something could switch", "[unit]") {
  // A relaxation oscillator started at zero, where both inputs of its comparator are equal; 1 mV beside it, it swings.
  const std::string deck =
      "rest\nV1 vp 0 15\nV2 vn 0 -15\nR1 o p 5k\nR2 p 0 5k\nR3 o m 10k\nC1 m 0 20n\nXU1 p m vp vn o LT1001\n.tran 1u 2m uic\n.meas high "
      "MAX V(o)\n";
  CHECK_THAT(ran(deck).err, Contains("note[N-at-rest]"));
  const Finished moved = ran(deck + ".ic V(m)=1m\n");
  CHECK_THAT(moved.err, !Contains("N-at-rest"));
  CHECK(value_of(moved.out, "high") > 10.0);
  CHECK_THAT(ran("passive\nV1 a 0 5\nR1 a b 1\nC1 b 0 1\n.tran 1u 1m\n").err, !Contains("N-at-rest"));
  CHECK_THAT(ran("moving\nV1 a 0 5\nD1 a b DX\nR1 b c 1\nC1 c 0 1m\n.model DX D(Ron=1m)\n.tran 1u 1m uic\n").err, !Contains("N-at-rest"));
}
