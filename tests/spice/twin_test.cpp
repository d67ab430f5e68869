// The cards that each element writes for ngspice. What is expected is the definition of the twin (elements/twin.hpp) and ngspice's manual.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "spice/smooth.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// The twin's cards alone: what stands before .save.
std::string twin_of(std::string_view cards) {
  const std::string text = smooth_text(std::string(cards) + "\n.save v(a)\n.tran 1m 1\n");
  return text.substr(0, text.find(".save"));
}

}  // namespace

TEST_CASE("linear elements are written with their numbers expanded", "[unit]") {
  CHECK(twin_of("V1 a 0 5k\nR1 a 0 {2*3k}") == "V1 a 0 DC 5000\nR1 a 0 6000\n");
  CHECK(twin_of("V1 a 0 1 Rser=2\nR1 a 0 1") == "R.V1.Rser V1.Rser 0 2\nV1 a V1.Rser DC 1\nR1 a 0 1\n");
  CHECK(twin_of("I1 0 a 1m\nR1 a 0 4 m=2") == "I1 0 a DC 0.001\nR1 a 0 2\n");
  CHECK(twin_of("I1 0 a 1\nR1 a b 0\nR2 b 0 1") == "I1 0 a DC 1\nV.R1.r a b 0\nR2 b 0 1\n");
  CHECK(twin_of("V1 a 0 1\nL1 a 0 1m Rser=2 Cpar=1p") == "V1 a 0 DC 1\nR.L1.Rser L1.Rser 0 2\nL1 a L1.Rser 0.001\nC.L1.Cpar a 0 1e-12\n");
  CHECK(twin_of("V1 a 0 1\nC1 a 0 1u ic=2\n.ic V(a)=1") == ".ic v(a)=1\nV1 a 0 DC 1\nC1 a 0 1e-06 ic=2\n");
  CHECK(twin_of("V1 a 0 1\nL1 a 0 1m\nL2 b 0 4m\nR2 b 0 1\nK1 L1 L2 1") ==
        "V1 a 0 DC 1\nL1 a 0 0.001\nL2 b 0 0.004\nR2 b 0 1\nK1 L1 L2 1\n");
}

TEST_CASE("controlled sources are SPICE's own where they have one input, else B sources", "[unit]") {
  CHECK(twin_of("V1 a 0 1\nE1 b 0 a 0 2\nR1 b 0 1") == "V1 a 0 DC 1\nE1 b 0 a 0 2\nR1 b 0 1\n");
  CHECK(twin_of("V1 a 0 1\nG1 b 0 a 0 2\nR1 b 0 1") == "V1 a 0 DC 1\nG1 b 0 a 0 2\nR1 b 0 1\n");
  CHECK(twin_of("V1 a 0 1\nR1 a 0 1\nF1 b 0 V1 2\nR2 b 0 1") == "V1 a 0 DC 1\nR1 a 0 1\nF1 b 0 V1 2\nR2 b 0 1\n");
  CHECK(twin_of("V1 a 0 1\nR1 a 0 1\nH1 b 0 R1 2\nR2 b 0 1") == "V1 a 0 DC 1\nV.R1.i a R1.i 0\nR1 R1.i 0 1\nH1 b 0 V.R1.i 2\nR2 b 0 1\n");
  CHECK(twin_of("V1 a 0 1\nV2 c 0 1\nE1 b 0 POLY(2) a 0 c 0 3 1 -2\nR1 b 0 1") ==
        "V1 a 0 DC 1\nV2 c 0 DC 1\nB.E1 b 0 V=3+v(a)-2*v(c)\nR1 b 0 1\n");
}

TEST_CASE("a table of a number or of time needs no control", "[unit]") {
  CHECK(twin_of("V1 a 0 1\nR1 a 0 1\nE1 b 0 TABLE {2} = (0,0) (4,1)\nR2 b 0 1") == "V1 a 0 DC 1\nR1 a 0 1\nB.E1 b 0 V=0.5\nR2 b 0 1\n");
  CHECK_THAT(twin_of("R1 a 0 1\nG1 0 a TABLE {time} = (0,0) (0.5,1)"), Contains("V.G1.part2 G1.part2 0 PWL(0 0 0.5 1)\nB.G1 0 a I=v(G1.part2)\n"));
}

TEST_CASE("an ideal diode is a sidiode with X ohm and 1e5/X ohm; a diode with a model keeps its numbers", "[unit]") {
  CHECK(twin_of("V1 a 0 1\nD1 a b DI\nR1 b 0 1\n.model DI D") ==
        "V1 a 0 DC 1\nA.D1 a b A.D1.model\n.model A.D1.model sidiode(Ron=0.001 Roff=100000000 Vfwd=0)\nR1 b 0 1\n");
  CHECK(twin_of("V1 a 0 1\nD1 a b DM\nR1 b 0 1\n.model DM D(Ron=10m Roff=1Meg Vfwd=0.7 Vrev=5 Rrev=1)") ==
        "V1 a 0 DC 1\nA.D1 a b A.D1.model\n.model A.D1.model sidiode(Ron=0.01 Roff=1000000 Vfwd=0.7 Vrev=5 Rrev=1)\nR1 b 0 1\n");
}

TEST_CASE("a switch keeps its thresholds; a control that no source holds is amplified by 1/X", "[unit]") {
  CHECK(twin_of("V1 a 0 1\nS1 a b a 0 M\nR1 b 0 1\n.model M SW(Ron=1 Roff=1k Vt=0.5 Vh=0.25)") ==
        "V1 a 0 DC 1\nB.S1.control S1.control 0 V=1*(v(a))\nS1 a b S1.control 0 S1.model\n"
        ".model S1.model sw(Ron=1 Roff=1000 Vt=0.5 Vh=0.25)\nR1 b 0 1\n");
  CHECK_THAT(twin_of("V1 a 0 1\nS1 a b b 0 M on\nR1 b 0 1\n.model M SW(Vt=0.5)"),
             Contains("V=1000*(v(b))\n") && Contains("S1.model on\n") && Contains("Vt=500 Vh=0)"));
  CHECK_THAT(twin_of("V1 a 0 1\nR1 a 0 1\nW1 a b R1 M\nR2 b 0 1\n.model M CSW(It=0.5)"), Contains("V=1000*(i(V.R1.i))\n"));
  CHECK_THAT(twin_of("V1 a 0 1\nS1 a b a 0 M\nR1 b 0 1\n.model M VSWITCH(Von=0 Voff=1)"),
             Contains("V=-1*(v(a))\n") && Contains("Vt=-0.5 Vh=0.5)"));
}

TEST_CASE("true jumps become ramps that the next corner allows for", "[unit]") {
  const double edge = 1e-3 * std::sqrt(1e-3) * 0.25;
  CHECK(twin_of("V1 a 0 PULSE(0 1 0.1 0 0 0.25 1)\nR1 a 0 1") ==
        fmt::format("V1 a 0 PULSE(0 1 0.1 {} {} {} 1)\nR1 a 0 1\n", edge, edge, 0.25 - edge));
  CHECK_THAT(twin_of("V1 a 0 PULSE(0 1 0.1 0.01 0.02 0.25 1)\nR1 a 0 1"), Contains("PULSE(0 1 0.1 0.01 0.02 0.25 1)"));
  CHECK_THAT(twin_of("V1 a 0 PWL(0 0 0.5 0 0.5 1 1 1)\nR1 a 0 1"),
             Contains(fmt::format("PWL(0 0 0.5 0 {} 1 1 1)", 0.5 + 1e-3 * std::sqrt(1e-3) * 0.5)));
  CHECK_THAT(twin_of("V1 a 0 SIN(1 2 50 0 0 90)\nR1 a 0 1"), Contains("SIN(1 2 50 0 0 90)"));
  CHECK_THAT(twin_of("V1 a 0 EXP(0 1 0 1m)\nR1 a 0 1"), Contains("EXP(0 1 0 0.001 1000000000000 1)"));
}

TEST_CASE("with uic a source that jumps at t = 0 starts behind its jump", "[unit]") {
  const std::string text = smooth_text("V1 a 0 PULSE(0 1 0 0 0 0.25 1)\nR1 a 0 1\n.tran 1m 1 uic\n");
  CHECK_THAT(text, Contains("V1 a 0 PULSE(1 0 0.25 "));
  CHECK_THAT(smooth_text("V1 a 0 PWL(0 0 0 2 1 3)\nR1 a 0 1\n.tran 1m 1 uic\n"), Contains("PWL(0 2 1 3)"));
}

TEST_CASE("kinks, steps and relays stand at inner nodes, rounded over X", "[unit]") {
  CHECK(twin_of("V1 a 0 1\nB1 b 0 V={max(V(a),0)}\nR1 b 0 1") ==
        "V1 a 0 DC 1\nB1.part2.x B1.part2.x 0 V=v(a)\n"
        "B1.part2 B1.part2 0 V=0.5*(v(B1.part2.x)+sqrt(v(B1.part2.x)*v(B1.part2.x)+4e-06))\nB1 b 0 V=v(B1.part2)\nR1 b 0 1\n");
  CHECK_THAT(twin_of("V1 a 0 1\nA1 a b relay\nR1 b 0 1\n.model relay relay(level=2)"),
             Contains("V=0.5*(1+tanh((v(a))/0.001))\n") && Contains("B.A1 b 0 V=-2+4*v(A1.part2)\n"));
}

TEST_CASE("names that are not ngspice's are replaced, and stay apart", "[unit]") {
  const std::string text = twin_of("V1 a+ 0 1\nR1 a+ a- 1\nR2 a- 0 1\nV2 a 0 1");
  CHECK(text == "V1 a_ 0 DC 1\nR1 a_ a__2 1\nR2 a__2 0 1\nV2 a 0 DC 1\n");
}

TEST_CASE("what ngspice cannot have is refused by its name", "[unit]") {
  const CompiledDeck deck = keep_circuit("V1 a 0 1\nL1 a 0 1 Rser=1\n.ic I(L1)=1\n.tran 1m 1\n");
  REQUIRE(deck.compiled);
  Diagnostics diagnostics;
  CHECK_FALSE(spice::smooth_deck(*deck.compiled->circuit, {}, diagnostics));
  REQUIRE(diagnostics.error_count() == 1);
  CHECK(diagnostics.all()[0].id == "E-no-twin");
}
