// Forms of single dialects: conditional sections, XSPICE's logic, IGBTs of PSpice, gate capacitances, the knee of Zener diodes, bare parameters.

#include <catch2/catch.hpp>
#include <cmath>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

/// The value of `name`; no number after an error.
double measured(const std::string& deck, const std::string& name) {
  const Scratch scratch;
  const Finished finished = run_deck(scratch, deck);
  INFO(finished.err);
  CHECK(finished.status == 0);
  return value_of(finished.out, name);
}

}  // namespace

TEST_CASE(".if chooses among cards by parameters, and nests", "[unit]") {
  const auto deck = [](const std::string& mode) {
    return "sections\n.param mode=" + mode +
           " high=1\n.if (mode == 1)\n.param k=10\nR1 a 0 {k}\n.elseif (mode==2 && high)\n.if {high > 5}\nR1 a 0 1\n.else\n"
           ".model RM R(R=20)\nR1 a 0 RM\n.endif\n.else\nR1 a 0 30\n.endif\nI1 0 a 1\n.tran 1m 1m\n.meas v AVG v(a)\n";
  };
  CHECK(measured(deck("1"), "v") == Approx(10.0));
  CHECK(measured(deck("2"), "v") == Approx(20.0));
  CHECK(measured(deck("7"), "v") == Approx(30.0));
}

TEST_CASE(".if within a subcircuit is decided by each call, and by each run of .step", "[unit]") {
  const std::string deck =
      "sections\n.param mode=1\n.step param mode list 1 2\n.subckt s p params: kind=1\n.if (kind==1)\nR1 p 0 1\n.else\nR1 p 0 2\nR2 p 0 2\n"
      ".endif\n.ends\nX1 a s\nX2 b s kind=2\nX3 c s kind={mode}\n.if (mode==2)\nV1 a 0 6\n.else\nV1 a 0 3\n.endif\n"
      "V2 b 0 3\nV3 c 0 3\n.tran 1m 1m\n.meas i1 AVG i(V1)\n.meas i2 AVG i(V2)\n";
  const Scratch scratch;
  const Finished finished = run_deck(scratch, deck + ".meas i3 AVG i(X3.R1)\n");
  INFO(finished.err + finished.out);
  REQUIRE(finished.status == 0);
  // 3 V or 6 V over 1 ohm; 3 V over two of 2 ohm; 3 V over 1 or 2 ohm.
  CHECK_THAT(finished.out, Contains("-3") && Contains("-6") && Contains("1.5"));
}

TEST_CASE("parameters and models in sections of a subcircuit are those of each call", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_deck(
      scratch,
      "sections\nV1 a 0 12\nX1 a s1 part\nX2 a s2 part kind=2\nX3 a s3 part kind=3 r=7\nX4 a s4 part kind=4\n.model sw SW(Ron=9 Vt=-1)\n"
      ".subckt part p o params: kind=1 r=1\n.if (kind==1)\n.param ro=10\n.model sw SW(Ron=1 Vt=-1)\n.elseif (kind==2)\n.param ro={20*r} "
      "r=2\n"
      ".model sw SW(Ron=2 Vt=-1)\n.elseif (kind==3)\n.model sw SW(Ron=3 Vt=-1)\n.endif\n.if (kind<3)\nR1 o 0 {ro}\n.else\nR1 o 0 "
      "{r}\n.endif\nS1 p o 0 0 sw\n.ends\n"
      ".tran 1m 2m\n.meas v1 FIND v(s1) AT=1m\n.meas v2 FIND v(s2) AT=1m\n.meas v3 FIND v(s3) AT=1m\n.meas v4 FIND v(s4) AT=1m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  // 12 V over Ron and the load: 1 and 10 ohm; 2 and 20·2; 3 and the call's 7; the deck's own model, 9, and the default 1.
  CHECK(value_of(finished.out, "v1") == Approx(12.0 * 10.0 / 11.0));
  CHECK(value_of(finished.out, "v2") == Approx(12.0 * 40.0 / 42.0));
  CHECK(value_of(finished.out, "v3") == Approx(12.0 * 7.0 / 10.0));
  CHECK(value_of(finished.out, "v4") == Approx(12.0 * 1.0 / 10.0));
}

TEST_CASE("slips with .if are named", "[unit]") {
  const Scratch scratch;
  const auto said = [&](const std::string& cards) { return run_deck(scratch, "slips\nR1 a 0 1\nV1 a 0 1\n.tran 1m 1m\n" + cards).err; };
  CHECK_THAT(said(".else\n"), Contains("error[E-misplaced]: .else without .if"));
  CHECK_THAT(said(".if (1)\n.else if (2)\n.endif\n"), Contains("nothing may follow .else; try .elseif"));
  CHECK_THAT(said(".if (1)\n"), Contains("error[E-missing-ends]: .if has no .endif"));
  CHECK_THAT(said(".if (1)\n.else\n.elseif (2)\n.endif\n"), Contains(".elseif after .else"));
  CHECK_THAT(said(".param mode=1\n.if (mod == 1)\n.endif\n"), Contains("unknown") && Contains("try 'mode'"));
  CHECK_THAT(said(".if\n.endif\n"), Contains("error[E-missing-value]"));
  CHECK_THAT(said(".subckt s p\n.if (1)\n.func f(x) {x}\n.endif\nR1 p 0 1\n.ends\nX1 a s\n"), Contains("hold elements, .param and .model"));
  CHECK_THAT(said(".subckt s p k=1\n.if (k==2)\n.param r=1\n.endif\nR1 p 0 {r}\n.ends\nX1 a s\n"),
             Contains("unknown parameter 'r of no section of .if that holds'"));
}

TEST_CASE("XSPICE's bridges and gates switch at their levels, after their delays", "[unit]") {
  // High together from 1 to 3 us, of 10 us; 10 ns later the output: 3.5 V for 2 us, else 0.2 V.
  const std::string deck =
      "gates\nVa a 0 PULSE(0 5 0 0 0 3u 10u)\nVb b 0 PULSE(0 5 1u 0 0 3u 10u)\nabr1 [a b] [ad bd] adcb\na1 [ad bd] yd and1\na2 yd yn inv1\n"
      "abr2 [yd yn] [y z] dacb\na3 [~ad bd] w nand1\nabr3 [~w] [x] dacb\n.model adcb adc_bridge(in_low=0.8 in_high=2)\n"
      ".model and1 d_and(rise_delay=10n fall_delay=10n input_load=0.5e-12)\n.model nand1 d_nand\n.model inv1 d_inverter\n"
      ".model dacb dac_bridge(out_low=0.2 out_high=3.5 out_undef=1.8 t_rise=1n)\nR1 y 0 1k\nR2 z 0 1k\nR3 x 0 1k\n.tran 0.1u 20u\n"
      ".meas y AVG v(y) FROM=10u\n.meas z AVG v(z) FROM=10u\n.meas t WHEN v(y)=2 RISE=1\n.meas x AVG v(x) FROM=10u\n";
  CHECK(measured(deck, "y") == Approx(0.2 * 0.8 + 3.5 * 0.2));
  CHECK(measured(deck, "z") == Approx(0.2 * 0.2 + 3.5 * 0.8));
  CHECK(measured(deck, "t") == Approx(1.01e-6));
  CHECK(measured(deck, "x") == Approx(0.2 * 0.9 + 3.5 * 0.1));  // b without a: from 3 to 4 us
}

TEST_CASE("XSPICE's flip-flop divides by two, and its switch closes in the middle", "[unit]") {
  const std::string divider =
      "divider\nVc c 0 PULSE(0 5 1u 0 0 1u 2u)\nab [c] [cd] ad\naf nq cd null null q nq ff\nad1 [q] [out] da\n.model ad adc_bridge\n"
      ".model da dac_bridge(out_high=4)\n.model ff d_dff(ic=0)\nR1 out 0 1k\n.tran 0.1u 21u\n.meas v AVG v(out) FROM=1u\n"
      ".meas t TRIG v(out) VAL=2 RISE=1 TARG v(out) VAL=2 RISE=2\n";
  CHECK(measured(divider, "v") == Approx(2.0));
  CHECK(measured(divider, "t") == Approx(4e-6));
  const std::string contact =
      "switch\nVc c 0 PWL(0 0 1m 1)\nV1 p 0 10\nas c %gd(p q) sw1\nR1 q 0 9\n.model sw1 aswitch(cntl_off={0.9} cntl_on=0.3 r_on=1 "
      "r_off=1e12 "
      "log=TRUE)\n.tran 10u 1m\n.meas v AVG v(q)\n";
  CHECK(measured(contact, "v") == Approx(9.0 * 0.6));  // closed below 0.6 V: the first 0.6 ms
}

TEST_CASE("an IGBT of PSpice conducts one way, with a drop", "[unit]") {
  const std::string deck =
      "igbt\nV1 p 0 SIN(0 100 50)\nVg g 0 15\nZ1 c g 0 zm\nR1 p c 10\n.model zm NIGBT(VT=5 KP=0.5 TAU=1u)\n.tran 0.1m 20m\n"
      ".meas m MAX i(Z1)\n.meas n MIN i(Z1)\n";
  CHECK(measured(deck, "m") == Approx((100.0 - 0.8) / (10.0 + 1.0 / (0.5 * 5.0))));
  CHECK(measured(deck, "n") == Approx(0.0).margin(1e-12));
}

TEST_CASE("with .options gatecap a gate is charged through its resistance", "[unit]") {
  const std::string deck =
      "gate\nV1 d 0 10\nVg g 0 PULSE(0 10 1u 0 0 5u 10u)\nM1 x g 0 0 NM\nR1 d x 10\n.tran 0.1u 10u\n.meas on WHEN v(x)=5 FALL=1\n"
      ".meas off WHEN v(x)=5 RISE=1\n";
  const std::string model = ".model NM VDMOS(Ron=0.1 Vto=3 Rg=100 Cgs=1n)\n";
  CHECK(measured(deck + model, "on") == Approx(1e-6));
  CHECK(measured(deck + model + ".options gatecap\n", "on") == Approx(1e-6 + 1e-7 * std::log(10.0 / 7.0)).epsilon(1e-6));
  CHECK(measured(deck + model + ".options gatecap=1\n", "off") == Approx(6e-6 + 1e-7 * std::log(10.0 / 3.0)).epsilon(1e-6));
  // Width times 10 nF/m, from the gate to ground alone.
  const std::string planar = ".model NM NMOS(Vto=3 KP=1 W=0.1 L=100u Rg=100 Cgso=10n)\n.options gatecap\n";
  CHECK(measured(deck + planar, "on") == Approx(1e-6 + 1e-7 * std::log(10.0 / 7.0)).epsilon(1e-6));
}

TEST_CASE("with a gate-drain capacitance the gate voltage has a plateau", "[unit]") {
  // (Cgs + Cgd) v' - Cgd vd' = (10 - v)/Rg with vd = 10 - (v - 3) R/Ron: from 9 V to 1 V at the drain; the current of Cgd in R1, a ten-thousandth, is left out.
  const double constant = 100.0 * (1e-9 + 0.2e-9 * (1.0 + 10.0 / 0.01));
  const std::string deck =
      "plateau\nV1 d 0 10\nVg g 0 PULSE(0 10 1u 0 0 5u 10u)\nM1 x g 0 0 NM\nR1 d x 10\n.tran 0.1u 10u\n"
      ".model NM VDMOS(Ron=0.01 Vto=3 Rg=100 Cgs=1n Cgdmax=0.4n)\n.options gatecap\n.meas t TRIG v(x)=9 FALL=1 TARG v(x)=1 FALL=1\n"
      ".meas q INTEG i(M1) FROM=0 TO=0.9u\n";
  CHECK(measured(deck, "t") == Approx(constant * std::log((10.0 - 3.001) / (10.0 - 3.009))).epsilon(5e-4));
  CHECK(measured(deck, "q") == Approx(0.0).margin(1e-15));
}

TEST_CASE("breakdown goes through IBV at BV, as in SPICE", "[unit]") {
  // 12 V = 1002 ohm·i + 5.6 V + 1.5·kT/q·ln(i/5 mA), solved by hand (Newton): kT/q = 25.8649 mV at 27 °C.
  double i = 6e-3;
  constexpr double slope = 1.5 * 0.0258649;
  for (int k = 0; k < 20; ++k) i -= (1002.0 * i + 5.6 + slope * std::log(i / 5e-3) - 12.0) / (1002.0 + slope / i);
  const std::string deck =
      "zener\nV1 p 0 12\nR1 p k 1k\nD1 0 k DZ\n.model DZ D(IS=1e-14 RS=2 BV=5.6 IBV=5m NBV=1.5)\n.tran 1m 10m\n.meas v AVG v(k)\n";
  CHECK(measured(deck, "v") == Approx(12.0 - 1000.0 * i).epsilon(1e-6));
}

TEST_CASE("a parameter's name without braces is its value, with a note", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_deck(scratch, "bare\n.param rload=4 level=8\nV1 a 0 level\nR1 a 0 rload\n.tran 1m 1m\n.meas i AVG i(R1)\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("note[N-bare-parameter]"));
  CHECK(value_of(finished.out, "i") == Approx(2.0));
}

TEST_CASE("with .op alone the tangents of diodes are those at the operating point", "[unit]") {
  // 5 V = 1000 ohm·i + kT/q·ln(i/1e-14 A), by Newton's method.
  double i = 4e-3;
  constexpr double slope = 0.025864926;
  for (int k = 0; k < 20; ++k) i -= (1000.0 * i + slope * std::log(i / 1e-14) - 5.0) / (1000.0 + slope / i);
  CHECK(measured("op\nV1 a 0 5\nR1 a b 1k\nD1 b 0 DX\n.model DX D(IS=1e-14)\n.op\n", "v(b)") == Approx(5.0 - 1000.0 * i).epsilon(1e-6));
}

TEST_CASE("XSPICE's latches and other flip-flops", "[unit]") {
  const std::string sources =
      "latches\nVs s 0 PULSE(0 5 1u 0 0 1u 10u)\nVr r 0 PULSE(0 5 4u 0 0 1u 10u)\nVe e 0 5\nab [s r e] [sd rd ed] ad\n.model ad "
      "adc_bridge\n"
      "ad1 [q] [out] da\n.model da dac_bridge(out_high=10)\nR1 out 0 1k\n.tran 0.1u 20u\n.meas v AVG v(out)\n";
  // High from 1 to 4 us of 10 us.
  CHECK(measured(sources + "a1 sd rd null null null q null la\n.model la d_srlatch\n", "v") == Approx(3.0));
  CHECK(measured(sources + "a1 sd rd ed null null q nq la\n.model la d_srlatch\n", "v") == Approx(3.0));
  // The data are taken over while r is high (4 to 5 us): ~s is high then, so it stays high from 4 us on.
  CHECK(measured(sources + "a1 ~sd rd null null q null la\n.model la d_dlatch\n", "v") == Approx(10.0 * 16.0 / 20.0));
  // Each rise of s toggles: high from 1 to 11 us of 20 us.
  CHECK(measured(sources + "a1 ed sd null null q null la\n.model la d_tff\n", "v") == Approx(5.0));
  CHECK(measured(sources + "a1 ed ed sd null null q null la\n.model la d_jkff\n", "v") == Approx(5.0));
}

TEST_CASE("a ZVS driver of two cross-coupled MOSFETs oscillates from rest", "[unit]") {
  const std::string deck =
      "zvs\nV1 vcc 0 24\nL1 vcc ct 100u Rser=10m\nL2 ct d1 5u\nL3 d2 ct 5u\nC1 d1 d2 0.68u\nK1 L2 L3 0.98\nM1 d1 g1 0 0 NM\nM2 d2 g2 0 0 "
      "NM\n"
      "R1 vcc g1 470\nR2 vcc g2 480\nR3 g1 0 10k\nR4 g2 0 10k\nD1 g1 d2 DF\nD2 g2 d1 DF\nD3 0 g1 DZ\nD4 0 g2 DZ\nR5 d1 d2 100\n"
      ".model NM VDMOS(Vto=3 Ron=75m)\n.model DF D(Vfwd=1 Ron=0.4)\n.model DZ D(Vfwd=0.75 Ron=1.5 Vrev=12 Rrev=20)\n"
      ".tran 0 1m 0 1u uic\n.meas t TRIG v(d1,d2)=0 RISE=20 TARG v(d1,d2)=0 RISE=21\n.meas m MAX v(d1) FROM=0.5m\n";
  // The tank: 2(1 + k) times 5 uH with 0.68 uF; on average 24 V at the centre of half sines, pi times that at a drain, as far as L1 keeps its current.
  CHECK(measured(deck, "t") == Approx(2.0 * 3.14159265 * std::sqrt(2.0 * 1.98 * 5e-6 * 0.68e-6)).epsilon(0.1));
  CHECK(measured(deck, "m") == Approx(3.14159265 * 24.0).epsilon(0.15));
}

TEST_CASE("a timer whose levels all start at zero settles", "[unit]") {
  const std::string deck =
      "timer\nX1 0 t out vcc cv t dis vcc ne555\nV1 vcc 0 12\nR1 vcc dis 4.7k\nR2 dis t 4.7k\nC1 t 0 1n\nC2 cv 0 10n\nR3 out 0 10k\n"
      ".tran 0.1u 1m uic\n.meas p TRIG v(out)=6 RISE=40 TARG v(out)=6 RISE=41\n";
  CHECK(measured(deck, "p") == Approx((3 * 4.7e3) * 1e-9 * std::log(2.0)).epsilon(1e-2));  // data sheet of the NE555
}

TEST_CASE("levels of a VSWITCH count beside a stray Vh", "[unit]") {
  const std::string deck =
      "levels\nV1 a 0 PWL(0 0 1m 1)\nV2 p 0 5\nS1 p q a 0 sw\nR1 q 0 1k\n.model sw vswitch {Roff=1T Ron=1m Von=0.7 Voff=0.3 vh=-0.5}\n"
      ".tran 10u 1m\n.meas t WHEN v(q)=2 RISE=1\n";
  CHECK(measured(deck, "t") == Approx(0.7e-3));
}

TEST_CASE("x4 behind a value is m=4", "[unit]") {
  CHECK(measured("units\nI1 0 a 1\nR1 a 0 8 x4\nC1 a 0 1n x2 Rser=1\n.tran 1u 1m\n.meas v AVG v(a)\n", "v") == Approx(2.0));
}

TEST_CASE("Xyce's switch with an expression as its control", "[unit]") {
  const std::string deck =
      "generic\nV1 a 0 PWL(0 0 1m 1)\nV2 p 0 5\nS1 p q SWM CONTROL={2*V(a)}\nR1 q 0 1k\n.model SWM SWITCH(ON=0.8 OFF=0.2 RON=1m ROFF=1T)\n"
      ".tran 10u 1m\n.meas t WHEN v(q)=2 RISE=1\n";
  CHECK(measured(deck, "t") == Approx(0.4e-3));
}

TEST_CASE("models of PSpice's breakout library are at hand", "[unit]") {
  const std::string deck =
      "breakout\nV1 a 0 10\nVg g 0 10\nR1 a b 1\nM1 b g 0 0 MbreakN W=1 L=1u\nD1 0 b Dbreak\n.lib \"nom.lib\"\n.tran 1u 10u\n.meas i AVG "
      "i(R1)\n";
  CHECK(measured(deck, "i") == Approx(10.0 / (1.0 + 1.0 / (20e-6 * 1e6 * 10.0))));  // level 1: Ron = 1/(Kp W/L vgs)
}
