// Integrals in expressions that are held or go round, and quotients by voltages of two levels.

#include <catch2/catch.hpp>
#include <cmath>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

TEST_CASE("idt with a reset stands at its start while the reset holds", "[unit]") {
  const Scratch scratch;
  // Reset from 0.4 ms to 0.5 ms of each ms: a ramp of 1 V/ms from 0.5 V to 1.4 V (over the start of the period), held for 0.1 ms.
  const std::string reset = "V2 r 0 PULSE(0 1 0.4m 0 0 0.1m 1m)\n";
  const Finished finished = run_deck(
      scratch, "idt\n" + reset +
                   "V1 a 0 1k\nB1 b 0 V=idt(V(a),0.5,V(r)>0.5)\nB2 c 0 V=2*idt(V(a),0.5,V(r))\nR1 b 0 1\nR2 c 0 1\n.tran 0.1m 5m\n"
                   ".meas a MAX v(b) FROM=1m\n.meas b MIN v(b) FROM=1m\n.meas c AVG v(b) FROM=1m TO=5m\n.meas d FIND v(b) AT=0.3m\n"
                   ".meas e AVG v(c) FROM=1m TO=5m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  const double mean = 0.9 * (0.5 + 0.45) + 0.1 * 0.5;
  CHECK(value_of(finished.out, "a") == Approx(1.4).epsilon(1e-9));
  CHECK(value_of(finished.out, "b") == Approx(0.5).epsilon(1e-9));
  CHECK(value_of(finished.out, "c") == Approx(mean).epsilon(1e-9));
  CHECK(value_of(finished.out, "d") == Approx(0.8).epsilon(1e-9));
  CHECK(value_of(finished.out, "e") == Approx(2.0 * mean).epsilon(1e-9));
}

TEST_CASE("one-cycle control: the integral of the switched voltage ends each pulse", "[unit]") {
  const Scratch scratch;
  // The mean of the switched voltage over a period is the reference: ∫ v dt = 8 V · 10 µs. The diode is ideal, the switch 1 mΩ at some 1.6 A.
  const Finished finished =
      run_deck(scratch,
               "one cycle\nV1 in 0 20\nV2 clk 0 PULSE(0 1 0 1n 1n 100n 10u)\nB1 int 0 V=idt(V(sw)*1e5,0,V(rst)>0.5)\n"
               "A1 clk cmp 0 0 0 rst q 0 SRFLOP\nB2 cmp 0 V=if(V(int)>8,1,0)\nS1 in sw q 0 SX\nD1 0 sw DX\nL1 sw out 100u\nC1 out 0 100u\n"
               "R1 out 0 5\n.model SX SW(Ron=1m Vt=.5 Vh=0)\n.model DX D\n.tran 1u 5m\n.meas v AVG V(out) FROM=4m TO=5m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "v") == Approx(8.0).epsilon(2e-3));
}

TEST_CASE("idtmod goes on at the other end of its range", "[unit]") {
  const Scratch scratch;
  // A sawtooth of 10 kHz between -1 and 1; of a frequency that a signal gives, 3 kHz and then back at 3 kHz, between 0 and 2.
  const Finished finished =
      run_deck(scratch,
               "idtmod\nB1 a 0 V=idtmod(20k,0,2,-1)\nV1 f 0 PWL(0 6k 10.05m 6k 10.05m -6k)\nB2 b 0 V=idtmod(V(f),0,2)\nR1 a 0 1\nR2 b 0 "
               "1\n.tran 10u 20m\n"
               ".meas a1 MAX v(a)\n.meas a2 MIN v(a)\n.meas a3 AVG v(a)\n.meas a4 FIND v(a) AT=75u\n.meas b1 MAX v(b)\n.meas b2 MIN v(b)\n"
               ".meas b3 FIND v(b) AT=10.05m\n.meas b4 FIND v(b) AT=10.2m\n.meas period TRIG v(b)=1 RISE=2 TARG v(b)=1 RISE=12\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "a1") == Approx(1.0).epsilon(1e-9));
  CHECK(value_of(finished.out, "a2") == Approx(-1.0).epsilon(1e-9));
  CHECK(std::abs(value_of(finished.out, "a3")) < 1e-9);
  CHECK(value_of(finished.out, "a4") == Approx(-0.5).epsilon(1e-9));  // 1.5 turns less one
  CHECK(value_of(finished.out, "b1") == Approx(2.0).epsilon(1e-8));
  CHECK(std::abs(value_of(finished.out, "b2")) < 1e-8);
  CHECK(value_of(finished.out, "b3") == Approx(std::fmod(6e3 * 10.05e-3, 2.0)).epsilon(1e-6));
  CHECK(value_of(finished.out, "b4") == Approx(std::fmod(6e3 * 10.05e-3, 2.0) - 6e3 * 0.15e-3 + 2.0).epsilon(1e-6));
  CHECK(value_of(finished.out, "period") == Approx(10.0 / 3e3).epsilon(1e-9));
  CHECK_THAT(run_deck(scratch, "idtmod\nB1 a 0 V=idtmod(V(a),0,0)\nR1 a 0 1\n.tran 1u 1m\n").err, Contains("error[E-range]"));
}

TEST_CASE("a quotient by a voltage of two levels is a switched form", "[unit]") {
  const Scratch scratch;
  // 10 V by 1 V and by 2 V, each half of the time; a sine by a gate plus 1.
  const Finished finished = run_deck(scratch,
                                     "quotients\nV1 q 0 PULSE(1 2 1m 0 0 1m 2m)\nV2 a 0 10\nV3 s 0 SIN(0 6 1k)\nB1 b 0 V=V(a)/V(q)\nB2 0 c "
                                     "I=V(s)/(V(q)-V(a)*0.3)\nR1 b 0 1\nR2 c 0 1\n"
                                     ".tran 10u 4m\n.meas b AVG v(b)\n.meas c1 FIND v(c) AT=0.25m\n.meas c2 FIND v(c) AT=1.25m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "b") == Approx(7.5).epsilon(1e-12));
  CHECK(value_of(finished.out, "c1") == Approx(6.0 / (1.0 - 3.0)).epsilon(1e-9));
  CHECK(value_of(finished.out, "c2") == Approx(6.0 / (2.0 - 3.0)).epsilon(1e-9));
  const auto refused = [&](const std::string& divisor) {
    return run_deck(scratch, "quotient\nV1 q 0 PULSE(0 2 1m 0 0 1m 2m)\nV2 s 0 SIN(0 6 1k)\nB1 b 0 V=10/V(" + divisor +
                                 ")\nR1 b 0 1\n.tran 10u 4m\n")
        .err;
  };
  CHECK_THAT(refused("q"), Contains("error[E-not-piecewise-linear]") && Contains("neither of them zero"));
  CHECK_THAT(refused("s"), Contains("error[E-not-piecewise-linear]"));
}
