// What decks of LTspice and its like have: currents of transistors by their names, buf and inv, universal operational amplifiers, no ground.

#include <catch2/catch.hpp>
#include <cmath>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

TEST_CASE("Id(M1) and Ic(Q1) are measured, and i(M1) is among the columns", "[unit]") {
  const Scratch scratch;
  // On for half of the time: 10 V over 10 Ω and Ron.
  const Finished finished =
      run_deck(scratch,
               "currents\nV1 d 0 10\nVg g 0 PULSE(0 10 0 0 0 5u 10u)\nM1 x g 0 0 NM\nR1 d x 9.5\n.model NM VDMOS(Ron=0.5 "
               "Vto=3)\n.tran 1u 100u\n.meas a AVG Id(M1)\n.meas b AVG i(M1)\n");
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "a") == Approx(0.5).epsilon(1e-9));
  CHECK(value_of(finished.out, "b") == Approx(0.5).epsilon(1e-9));
  CHECK_THAT(read_file(scratch / "d.csv"), Contains(",i(M1)\n"));
  const std::string transistor = "bipolar\nV1 d 0 10\nI1 0 b 1m\nQ1 x b 0 QN\nR1 d x 10\n.model QN NPN(BF=100)\n.tran 1u 100u\n";
  CHECK(value_of(run_deck(scratch, transistor + ".meas a AVG Ic(Q1)\n").out, "a") == Approx(0.1).epsilon(1e-6));
  CHECK_THAT(run_deck(scratch, transistor + ".meas a AVG Id(Q1)\n").err, Contains("unknown function 'Id'"));
}

TEST_CASE("buf and inv of an expression switch at one half", "[unit]") {
  const Scratch scratch;
  // A ramp from 0 to 1 V in 1 ms, less 0.2 V: above one half for the last 0.3 ms.
  const Finished finished =
      run_deck(scratch,
               "buf\nV1 a 0 PWL(0 0 1m 1)\nB1 b 0 V=buf(v(a)-0.2)\nB2 c 0 V=2*inv(v(a))\nR1 b 0 1\nR2 c 0 1\n.tran 10u 1m\n"
               ".meas x AVG v(b)\n.meas y AVG v(c)\n");
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "x") == Approx(0.3).epsilon(1e-9));
  CHECK(value_of(finished.out, "y") == Approx(1.0).epsilon(1e-9));
}

TEST_CASE("LTspice's universal operational amplifier: gain, slew rate, rails", "[unit]") {
  const Scratch scratch;
  const auto follower = [&](const std::string& level, const std::string& step, const std::string& parameters) {
    return run_deck(scratch,
                    "opamp\nV1 a 0 " + step + "\nV2 vp 0 15\nV3 vn 0 -15\nXU1 a b vp vn out " + level + " " + parameters +
                        "\nR1 out b 1k\nR2 b 0 1k\n.tran 1u 100u\n.meas last FIND v(out) AT=99u\n.meas slope DERIV v(out) AT=2u\n");
  };
  // Twice the input, less what the loop gain of Avol/2 leaves.
  const Finished small = follower("level.1", "1", "Avol=1k GBW=10Meg Slew=10Meg");
  REQUIRE(small.status == 0);
  CHECK_THAT(small.err, Contains("note[N-universal-opamp]"));
  CHECK(value_of(small.out, "last") == Approx(2.0 / (1.0 + 2.0 / 1000.0)).epsilon(1e-6));
  // 10 V/µs would be there after 0.4 µs; 1 V/µs is not.
  const Finished slow = follower("level.2", "PULSE(0 2 1u 1n 1n 1 2)", "Avol=1Meg GBW=100Meg Slew=1Meg Vos=0 Rin=500Meg phimargin=45");
  CHECK(value_of(slow.out, "slope") == Approx(1e6).epsilon(1e-3));
  CHECK(value_of(slow.out, "last") == Approx(4.0).epsilon(1e-4));
  CHECK(value_of(follower("level2", "10", "Rail=1").out, "last") == Approx(14.0).epsilon(1e-3));
  CHECK(value_of(follower("UniversalOpamp2", "1", "").out, "last") == Approx(2.0).epsilon(1e-4));
}

TEST_CASE("in a circuit without ground a node is taken for it, with a note", "[unit]") {
  const Scratch scratch;
  const Finished finished =
      run_deck(scratch, "no ground\nR1 p m 3\nR2 m q 1\nV1 p q 8\n.tran 1u 10u\n.meas a AVG v(m)\n.meas b AVG v(p,q)\n.meas c AVG v(q)\n");
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("note[N-no-ground]: no element is connected to ground: the node q is used as ground"));
  CHECK(value_of(finished.out, "a") == Approx(2.0));
  CHECK(value_of(finished.out, "b") == Approx(8.0));
  CHECK(value_of(finished.out, "c") == 0.0);
  const std::string once = finished.err.substr(finished.err.find("N-no-ground") + 1);
  CHECK_THAT(once, !Contains("N-no-ground"));
  CHECK_THAT(run_deck(scratch, "floating part\nR1 p q 3\nV1 p q 8\nR2 a 0 1\nV2 a 0 1\n.tran 1u 10u\n").err, Contains("error[E-floating]"));
}

TEST_CASE("what a function with memory that is refused is told to try is what does it", "[unit]") {
  const Scratch scratch;
  const auto said = [&](const std::string& card) {
    return run_deck(scratch, "cures\nV1 a 0 SIN(0 1 50)\n" + card + "\nR1 b 0 1\n.tran 1m 20m\n").err;
  };
  CHECK_THAT(said("B1 b 0 V=delay(v(a),1m)"), Contains("Laplace=1/(1+s*T)"));
  CHECK_THAT(said("E1 b 0 LAPLACE {V(a)} = {exp(-s*1m)}"), Contains("(1-s*T/2)/(1+s*T/2)"));
}

TEST_CASE("par('...') on output cards is a column, and a time measures as AT", "[unit]") {
  const Scratch scratch;
  const Finished finished =
      run_deck(scratch,
               "columns\nV1 a 0 PWL(0 0 10m 5)\nR1 a b 1\nR2 b 0 4\n.print tran par('v(a)-2*v(b)') twice=par('2*abs(i(v1))')\n"
               ".save dialogbox\n.step temp 0 100 50\n.meas tran t TRIG time=1m TARG time=10m\n"
               ".meas tran f FIND v(b) WHEN time=5m\n.meas tran late FIND v(b) WHEN time=11m\n.tran 5m 10m\n");
  CHECK_THAT(finished.err, Contains("note[N-step-temperature]") && Contains("note[N-dialogbox]"));
  CHECK(value_of(finished.out, "t") == Approx(9e-3));
  CHECK(value_of(finished.out, "f") == Approx(2.0));  // four fifths of 2.5 V
  CHECK_THAT(finished.err + finished.out, Contains("late"));
  // v(a) - 2·(4/5)·v(a) and 2·v(a)/5, at 0, 2.5 and 5 V.
  CHECK_THAT(read_file(scratch / "d.csv"), Contains("time,par('v(a)-2*v(b)'),twice\n0,0,0\n0.005,-1.5,1\n0.01,-3,2\n"));
}

TEST_CASE("a switch of level 2 with a limit of its current runs, and both are named as ignored", "[unit]") {
  const Scratch scratch;
  const Finished finished =
      run_deck(scratch,
               "level\nV1 a 0 PULSE(0 1 0 1m 1m 3m 8m)\nS1 a b a 0 SX\nR1 b 0 1\n.model SX SW(level=2 Ron=1 Roff=1g Vt=0.5 Ilimit=10)\n"
               ".tran 1m 8m\n.meas m MAX v(b)\n");
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("warning[W-ignored-parameter]: level, Ilimit of model SX are ignored"));
  CHECK(value_of(finished.out, "m") == Approx(0.5));
}

TEST_CASE("PWL file= reads pairs of a file beside the deck", "[unit]") {
  const Scratch scratch;
  // A trapezoid of 4 V from 0 to 4 ms, whose flanks take 1 ms each: 12 V ms over 4 ms.
  scratch.write("points.txt", "* time value\n0 0\n1m, 4\n+2m\t4\r\n\n4e-3 0\n");
  for (const char* source : {"PWL file=points.txt", "PWL(file=points.txt)", "PWL file=\"points.txt\""}) {
    INFO(source);
    const Finished finished =
        run_deck(scratch, std::string("file\nV1 a 0 ") + source + "\nR1 a 0 1\n.tran 0.1m 4m\n.meas m AVG v(a)\n.meas p MAX v(a)\n");
    REQUIRE(finished.status == 0);
    CHECK(value_of(finished.out, "m") == Approx(3.0).epsilon(1e-12));
    CHECK(value_of(finished.out, "p") == Approx(4.0));
  }
  scratch.write("bad.txt", "0 0\n1m\n");
  const std::string said = run_deck(scratch, "file\nV1 a 0 PWL file=bad.txt\nR1 a 0 1\n.tran 0.1m 4m\n").err;
  CHECK_THAT(said, Contains("error[E-pwl-file]: line 2 of 'bad.txt' is not a pair"));
}

TEST_CASE("integrals and derivatives in expressions", "[unit]") {
  const Scratch scratch;
  // Of the step at t = 0 to 2 V: 2t, 5 + 2t; of the ramp of 3 V/ms: 3000 V/s; of that ramp's own integral the ramp again.
  const Finished finished = run_deck(
      scratch,
      "integrals\nV1 a 0 PULSE(0 2 0 0 0 1 2)\nV2 r 0 PWL(0 0 1m 3)\nB1 b 0 V=idt(V(a))*1k\nB2 c 0 V=1+SDT(V(a),5)\nB3 0 d I=ddt(V(r))\n"
      "Rd d 0 1\nX1 r e s\n.subckt s p q\nB1 q 0 V=ddt(idt(V(p)))\n.ends\nRb b 0 1\nRc c 0 1\nRe e 0 1\n.tran 0.5m 1m\n"
      ".meas b FIND v(b) AT=1m\n.meas c FIND v(c) AT=1m\n.meas d FIND v(d) AT=0.5m\n.meas e FIND v(e) AT=0.5m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "b") == Approx(2.0).epsilon(1e-12));
  CHECK(value_of(finished.out, "c") == Approx(6.002).epsilon(1e-12));
  CHECK(value_of(finished.out, "d") == Approx(3000.0).epsilon(1e-9));
  CHECK(value_of(finished.out, "e") == Approx(1.5).epsilon(1e-9));
  CHECK_THAT(read_file(scratch / "d.csv"), Contains("time,v(a),v(r),v(b),v(c),v(d),v(e),i(V1),i(V2)\n"));  // nothing of what is inside
}

TEST_CASE("LAPLACE of a fraction of polynomials in s", "[unit]") {
  const Scratch scratch;
  // Steps of 1 V: 1 - exp(-t/τ); 1 + t/τ of (1+sτ)/(sτ), as a current into 1 Ω; 1 - (1 + t/τ) exp(-t/τ) of 1/(1+sτ)².
  const Finished finished =
      run_deck(scratch,
               "transfer\n.param tau=1m\nV1 in 0 PULSE(0 1 0 0 0 1 2)\nE1 a 0 LAPLACE {V(in)} = {1/(1+s*tau)}\n"
               "G1 0 b in 0 Laplace=(1+s*tau)/(s*tau)\nE2 c 0 LAPLACE {2*V(in)} {0.5*(1+s*1m)**-2}\nRa a 0 1\nRb b 0 1\n"
               "Rc c 0 1\n.ic v(b)=0\n.tran 1m 2m uic\n.meas a FIND v(a) AT=2m\n.meas b FIND v(b) AT=2m\n.meas c FIND v(c) AT=2m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "a") == Approx(1.0 - std::exp(-2.0)).epsilon(1e-12));
  CHECK(value_of(finished.out, "b") == Approx(3.0).epsilon(1e-12));
  CHECK(value_of(finished.out, "c") == Approx(1.0 - 3.0 * std::exp(-2.0)).epsilon(1e-12));
}

TEST_CASE("an oscillator of an ideal comparator with hysteresis runs with the option that the message names", "[unit]") {
  const Scratch scratch;
  const std::string deck =
      "schmitt\nB1 out 0 V=if(V(p)>V(n),1,-1)\nR1 out p 1k\nR2 p 0 1k\nR3 out n 1k\nC1 n 0 1u\n.ic v(n)=0.1\n.tran 10u 20m uic\n"
      ".meas period TRIG v(out)=0 RISE=2 TARG v(out)=0 RISE=5\n";
  const Finished refused = run_deck(scratch, deck);
  CHECK(refused.status == 1);
  const std::string option = ".options nonunique=stay";
  CHECK_THAT(refused.err, Contains("error[E-not-unique]") && Contains(option));
  const Finished finished = run_deck(scratch, deck + option + "\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "period") == Approx(3.0 * 2e-3 * std::log(3.0)).epsilon(1e-9));  // 2RC ln((1+β)/(1-β)) with β = 1/2
}

TEST_CASE("a JFET with a resistor in its source is a source of current", "[unit]") {
  const Scratch scratch;
  // SPICE's saturation, i = Beta (v(gate,source) + 3 V)² with v(gate,source) = -(470 Ω + Rs)·i: a quadratic equation.
  const double beta = 1.304e-3, r = 471.0, b = 6.0 * r + 1.0 / beta, current = (b - std::sqrt(b * b - 36.0 * r * r)) / (2.0 * r * r);
  const Finished finished = run_deck(
      scratch,
      "jfet\nV1 d 0 PWL(0 0 1m 20)\nJ1 d g s JN\nR1 s g 470\nRg g 0 1u\n.model JN NJF(Beta=1.304m Rd=1 Rs=1 Vto=-3)\n.tran 10u 1m\n"
      ".meas i FIND i(R1) AT=1m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "i") == Approx(current).epsilon(0.02));
  CHECK_THAT(finished.err, Contains("a linear channel"));
}

TEST_CASE("a measurement that cannot be read stops no deck that LTspice wrote", "[unit]") {
  const Scratch scratch;
  const std::string deck =
      "measured\nV1 a 0 2\nR1 a b 3\nR2 b 0 1\n.tran 1u 10u\n.meas gain V(b)/V(a)\n.meas twice PARAM 2*gain\n.meas top MAX v(b)\n";
  const Finished finished = run_deck(scratch, deck + ".backanno\n");
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "top") == Approx(0.5).epsilon(1e-12));
  CHECK_THAT(finished.err, Contains("warning[W-measurement]: left out: measurement gain") && Contains("W-measurement-failed"));
  CHECK(finished.out.find("gain") == std::string::npos);
  CHECK(run_deck(scratch, deck).status == 2);
}

TEST_CASE("a MOSFET that biases its own gate has a linear channel, and so has its mirror", "[unit]") {
  const Scratch scratch;
  // v(d) = Vto + i Ron beside 1 kohm at 5 V; the other one has the same gate, and takes as much.
  const double expected = (5.0 - 1.0) / (1000.0 + 100.0);
  const auto run = [&](const std::string& gate, const std::string& tie) {
    return run_deck(
        scratch,
        "mirror\nV1 vdd 0 5\nR1 vdd d 1k\nM1 d " + gate + " 0 0 NM\nM2 o " + gate + " 0 0 NM\nR2 vdd o 500\n" + tie +
            ".model NM NMOS(Vto=1 Ron=100)\n.model SWM SW(Vt=1 Vh=0 Ron=1)\n.tran 1u 10u\n.meas one AVG i(M1)\n.meas other AVG i(M2)\n");
  };
  for (const Finished& finished : {run("d", ""), run("g", "R3 d g 1k\n"), run("g", "V3 c 0 2\nS1 d g c 0 SWM\n")}) {
    REQUIRE(finished.status == 0);
    CHECK(value_of(finished.out, "one") == Approx(expected).epsilon(1e-9));
    CHECK(value_of(finished.out, "other") == Approx(expected).epsilon(1e-9));
  }
}

TEST_CASE("a MOSFET has SPICE's default body diode unless its model gives Ron", "[unit]") {
  const Scratch scratch;
  const std::string deck =
      "body\nV1 a 0 5\nR1 a b 43\nM1 0 0 b 0 NM\n.model NM NMOS(Vto=1)\n.tran 1u 10u\n.meas v AVG v(0,b)\n.meas i AVG i(V1)\n";
  // Bulk to source: reversed here, so nothing flows; with the source below the bulk 0.1 A flow at kT/q ln(i/IS) (IS = 1e-14 A, 27 C).
  const auto below = [&](const std::string& end) {
    std::string text = deck;
    text.replace(text.find("V1 a 0 5"), 8, "V1 0 a 5");
    return run_deck(scratch, text + end);
  };
  for (const Finished& written : {below(".backanno\n"), below("")}) {
    REQUIRE(written.status == 0);
    const double current = -value_of(written.out, "i");
    CHECK(current == Approx(0.1).epsilon(0.02));
    // Two digits of the current in the tangent: off by n kT/q (5 %)²/2 at most.
    CHECK(value_of(written.out, "v") == Approx(0.0258649 * std::log(current / 1e-14)).epsilon(1e-3));
  }
  std::string idealised = deck;
  idealised.replace(idealised.find("V1 a 0 5"), 8, "V1 0 a 5");
  idealised.replace(idealised.find("Vto=1"), 5, "Vto=1 Ron=1");
  CHECK(std::abs(value_of(run_deck(scratch, idealised).out, "v")) < 1e-9);
}
