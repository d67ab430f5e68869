// Forms and circuits that public decks hold, one small deck each.

#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "cli/run_in.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

TEST_CASE("the fourth node of a VDMOS is no part of the circuit", "[unit]") {
  const Scratch scratch;
  // LTspice's VDMOS has three terminals: 10 V over 9 Ω and 1 Ω.
  const Finished finished = run_deck(scratch,
                                     "body pin\nV1 a 0 10\nR1 a d 9\nV2 g 0 10\nM1 d g 0 n004 MX\n.model MX VDMOS(Vto=2 Ron=1)\n"
                                     ".tran 1m 2m\n.meas i FIND i(R1) AT=1m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "i") == Approx(1.0).epsilon(1e-9));
}

TEST_CASE("par('expression') is the expression", "[unit]") {
  const Scratch scratch;
  // 2 V at 2 Ω: 1 A, 2 W.
  const Finished finished = run_deck(scratch,
                                     "par\nV1 a 0 2\nR1 a 0 2\n.tran 1m 2m\n.meas tran i FIND par('-i(V1)') AT=1m\n"
                                     ".meas tran p AVG par('v(a)*i(R1)') FROM=0 TO=2m\n");
  INFO(finished.err);
  CHECK(value_of(finished.out, "i") == Approx(1.0).epsilon(1e-12));
  CHECK(value_of(finished.out, "p") == Approx(2.0).epsilon(1e-12));
}

TEST_CASE("a lateral PNP transistor is a PNP transistor", "[unit]") {
  const Scratch scratch;
  // In its active region it carries BF times its base's current.
  const Finished finished = run_deck(scratch,
                                     "lateral\nV1 e 0 10\nR1 b 0 1Meg\nR2 c 0 1k\nQ1 c b e QL\n.model QL LPNP(IS=1e-15 BF=50)\n"
                                     ".tran 1m 2m\n.meas ib FIND i(R1) AT=1m\n.meas ic FIND i(R2) AT=1m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "ic") == Approx(50.0 * value_of(finished.out, "ib")).epsilon(1e-9));
  CHECK(value_of(finished.out, "ib") > 5e-6);
}

TEST_CASE(".step takes a parameter of a model", "[unit]") {
  const Scratch scratch;
  const std::string circuit = "V1 c 0 10\nV2 p 0 10\nR1 p b 1Meg\nR2 c k 1k\nQ1 k b 0 QX\n.model QX NPN(IS=1e-15 BF=10)\n.tran 1m 2m\n";
  const Finished finished =
      run_deck(scratch, "gain\n" + circuit + ".step NPN QX(BF) list 50 100 200\n.meas gain FIND i(R2)/i(R1) AT=1m\n.save i(R2)\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.out, Contains("50") && Contains("100") && Contains("200"));
  const std::string rows = read_file(scratch / "d.csv");
  INFO(rows);
  // (10 V - kT/q ln(Ic/Is))/1 MΩ times the gain.
  for (const double gain : {50.0, 100.0, 200.0}) {
    const double expected = gain * (10.0 - 1.380649e-23 * 300.15 / 1.602176634e-19 * std::log(gain * 9.3e-6 / 1e-15)) / 1e6;
    const std::size_t at = rows.find("\n" + std::to_string(static_cast<int>(gain)) + ",");
    REQUIRE(at != std::string::npos);
    const std::string line = rows.substr(at + 1, rows.find('\n', at + 1) - at - 1);
    const double last = std::stod(line.substr(line.rfind(',') + 1));
    CHECK(last == Approx(expected).epsilon(0.005));
  }
  CHECK_THAT(run_deck(scratch, "none\n" + circuit + ".step NPN QY(BF) 50 100 50\n").err, Contains("unknown model 'QY'"));
  CHECK_THAT(run_deck(scratch, "none\n" + circuit + ".step NPN QX(nothing) 50 100 50\n").err, Contains("nothing has no effect"));
  CHECK_THAT(run_deck(scratch, "none\n" + circuit + ".step PNP QX(BF) 50 100 50\n").err,
             Contains("E-wrong-model-type") && Contains("NPN, not PNP"));
}

TEST_CASE("a follower's channel has the slope of its own overdrive", "[unit]") {
  const Scratch scratch;
  // Level 1 in saturation: I = K/2 (vgs - Vto)², K = Kp W/L.
  const double current = 1e-3, k = 100e-6 * 100.0, overdrive = std::sqrt(2.0 * current / k);
  const Finished finished = run_deck(scratch,
                                     "follower\nVD d 0 10\nVG g 0 5\nM1 d g s s NM W=100u L=1u\nI1 s 0 1m\n.model NM NMOS(Vto=1 Kp=100u)\n"
                                     ".tran 1u 10u\n.meas v FIND v(s) AT=5u\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "v") == Approx(5.0 - 1.0 - overdrive).margin(0.02 * overdrive));
  CHECK_THAT(finished.err, Contains("N-gate-drive"));
  // A transmission gate of 1.8 V, hard on: its resistance at no drop is 1/(K (vgs - Vto)), with s and d the overdrives against source and drain.
  const Finished gate =
      run_deck(scratch,
               "gate\nVIN in 0 0.2\nVG g 0 1.8\nM1 in g out 0 NM W=100u L=1u\nR1 out 0 10\n.model NM NMOS(Vto=0.5 Kp=100u)\n"
               ".tran 1u 10u\n.meas i FIND i(R1) AT=5u\n");
  INFO(gate.err);
  REQUIRE(gate.status == 0);
  const double i = value_of(gate.out, "i"), s = 1.8 - 10.0 * i - 0.5, d = 1.8 - 0.2 - 0.5;
  CHECK(i == Approx(0.5 * k * (s * s - d * d)).epsilon(0.02));
}

TEST_CASE("a follower's channel has lines for each current that it carries long", "[unit]") {
  const Scratch scratch;
  const Finished finished =
      run_deck(scratch,
               "duty of a tenth\nVD d 0 12\nVG g 0 PULSE(1.5 6 0 1u 1u 9u 100u)\nM1 d g s 0 NM W=100u L=1u\nR1 s 0 100\n"
               "C1 s 0 1n\n.model NM NMOS(Vto=1 Kp=200u)\n.tran 0.1u 500u\n.meas high MAX v(s)\n.meas low FIND v(s) AT=480u\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  // v = R K/2 (vg - Vto - v)² with R K/2 = 1/V: v² - (2 o + 1) v + o² = 0, where o = vg - Vto is 5 V and 0.5 V.
  const auto output = [](double o) { return 0.5 * (2.0 * o + 1.0 - std::sqrt(4.0 * o + 1.0)); };
  CHECK(value_of(finished.out, "high") == Approx(output(5.0)).margin(0.05 * (5.0 - output(5.0))));
  CHECK(value_of(finished.out, "low") == Approx(output(0.5)).margin(0.05 * (5.0 - output(5.0))));
  CHECK_THAT(finished.err, Contains("M1 at 1.6 V") && Contains(" and 2."));
}

TEST_CASE("a source that comparisons alone read is not left out", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_deck(scratch,
                                     "clock\nVtri tri 0 PULSE(0 1 0 5u 5u 0 10u)\nVx x 0 1\nB1 g 0 V=if(V(tri)<0.3,5,0)\nR1 g 0 1k\n"
                                     "R2 x 0 1\n.save v(g)\n.tran 1u 100u\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("left out") && Contains("Vx") && !Contains("Vtri"));
}

TEST_CASE("the netlist of a board is one error", "[unit]") {
  const Scratch scratch;
  const Finished finished = run_deck(scratch, "(export (version D)\n  (design (source x.sch)))\n");
  CHECK_THAT(finished.err, Contains("E-board-netlist") && !Contains("E-no-analysis"));
  CHECK_THAT(run_deck(scratch, "[Main]\nFileType=CIR\nVersion=11.01\n").err,
             Contains("E-board-netlist") && Contains("Micro-Cap") && !Contains("E-syntax"));
}

TEST_CASE("a bulk at ground beside a diode does not take its current", "[unit]") {
  const Scratch scratch;
  // 1 A backwards through a Schottky diode and the bulk diode of a transistor that is off: kT/q ln(1/IS) of the former, 0.30 V, where the latter (IS = 1e-14) would need 0.83 V.
  const Finished finished =
      run_deck(scratch,
               "bulk\nV1 in 0 12\nM1 in 0 sw 0 NX\nD1 0 sw DS\nI1 sw 0 1\n.model NX NMOS(VTO=2 KP=100)\n.model DS D(IS=1e-5)\n"
               ".tran 1u 10u\n.meas v FIND v(sw) AT=5u\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "v") == Approx(-1.380649e-23 * 300.15 / 1.602176634e-19 * std::log(1e5)).epsilon(1e-3));
}

TEST_CASE("a diode without numbers is told of beside transistors and diodes that have SPICE's", "[unit]") {
  const Scratch scratch;
  const auto run = [&](const std::string& other) {
    return run_deck(scratch, "rectifier\nV1 a 0 5\nD1 a b DX\nR1 b 0 1k\n.model DX D\n" + other + ".tran 1u 10u\n").err;
  };
  CHECK_THAT(run(""), !Contains("N-ideal-diode"));
  CHECK_THAT(run("M1 a b 0 0 NX\n.model NX NMOS(Vto=1 Ron=1)\n"), !Contains("N-ideal-diode"));
  CHECK_THAT(run("M1 a b 0 0 NX\n.model NX NMOS(Vto=1 Kp=2)\n"), Contains("N-ideal-diode"));
  CHECK_THAT(run("D2 0 a DY\n.model DY D(IS=1e-12)\n"), Contains("N-ideal-diode"));
}

TEST_CASE("a ring of inverters at rest is told of", "[unit]") {
  const Scratch scratch;
  const auto inverter = [](const std::string& name, const std::string& in, const std::string& out) {
    return "MN" + name + " " + out + " " + in + " 0 0 NM\nMP" + name + " " + out + " " + in + " d d PM\nC" + name + " " + out + " 0 1p\n";
  };
  const std::string models = "VD d 0 5\n.model NM NMOS(Vto=1 Kp=2m)\n.model PM PMOS(Vto=-1 Kp=2m)\n.tran 0.1n 100n uic\n";
  CHECK_THAT(run_deck(scratch, "ring\n" + inverter("1", "a", "b") + inverter("2", "b", "c") + inverter("3", "c", "a") + models).err,
             Contains("W-inverter-at-rest") && Contains("MN1 and MP1") && Contains("MN3 and MP3"));
  CHECK_THAT(
      run_deck(scratch, "chain\nVA a 0 PULSE(0 5 0 1n 1n 20n 40n)\n" + inverter("1", "a", "b") + inverter("2", "b", "c") + models).err,
      !Contains("W-inverter-at-rest"));
}

TEST_CASE("the gate of a junction FET leads over its Rd and Rs", "[unit]") {
  const Scratch scratch;
  // 0.1 A each over 10 Ω and a junction: v = 1 V + kT/q ln(0.1/1e-14).
  const double volts = 1.0 + 1.380649e-23 * 300.15 / 1.602176634e-19 * std::log(0.1 / 1e-14);
  const Finished finished = run_deck(scratch, "gate\nV1 g 0 " + std::to_string(volts) +
                                                  "\nJ1 0 g 0 JX\n.model JX NJF(Vto=-2 Beta=1m Rd=10 Rs=10 Is=1e-14)\n"
                                                  ".tran 1u 10u\n.meas i FIND i(V1) AT=5u\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "i") == Approx(-0.2).epsilon(1e-3));
}

TEST_CASE("an ideal diode is told of where another simulator prints", "[unit]") {
  const Scratch scratch;
  const std::string circuit = "V1 a 0 2\nD1 a b DX\nR1 b 0 2\n.model DX D\n.tran 1m 2m\n";
  CHECK_THAT(run_deck(scratch, "print\n" + circuit + ".print tran v(b)\n").err, Contains("N-ideal-diode"));
  CHECK_THAT(run_deck(scratch, "save\n" + circuit + ".save v(b)\n").err, !Contains("N-ideal-diode"));
}

TEST_CASE("parts of PSpice's libraries: a letter before a name, its timers", "[unit]") {
  const Scratch scratch;
  CHECK_THAT(run_deck(scratch, "letter\nV1 a 0 5\nR1 a b 1Meg\nR2 a c 1k\nQ1 c b 0 QBC548B\n.tran 1m 2m\n").err,
             Contains("QBC548B is not defined, and is taken from the models at hand"));
  // An astable multivibrator of 40 kΩ, 25 kΩ and 10 nF: half a period is 25 kΩ·10 nF·ln 2, the other 65 kΩ·10 nF·ln 2.
  const Finished finished = run_deck(scratch,
                                     "timer\nX1 0 t o v k t d v 555D PARAMS: MAXFREQ=3E6\nV1 v 0 12\nC2 k 0 10n\nR3 0 o 10k\nC1 0 t 10n\n"
                                     "R1 d v 40k\nR2 d t 25k\n.tran 1u 5m uic\n.meas p TRIG v(o)=6 FALL=3 TARG v(o)=6 FALL=4\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "p") == Approx(90e3 * 10e-9 * std::log(2.0)).epsilon(0.01));
}

TEST_CASE("a blank may stand for the equals sign of .param", "[unit]") {
  const Scratch scratch;
  // LTspice: 70 % of 1/200 Hz at 1 kV/s is 3.5 V; the equals sign of others stays.
  const Finished finished = run_deck(scratch,
                                     "blank\n.param ton tp*0.01*duty\n.param tp 1/freq freq 200 duty 70\n.param r {k*2}, k=2\n"
                                     "V1 a 0 {ton*1e3}\nR1 a 0 r\n.op\n.save v(a) i(R1)\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "v(a)") == Approx(3.5).epsilon(1e-12));
  CHECK(value_of(finished.out, "i(R1)") == Approx(0.875).epsilon(1e-12));
}

TEST_CASE(".save inside a subcircuit is passed over with a warning", "[unit]") {
  const Scratch scratch;
  const Finished finished =
      run_deck(scratch, "inside\nV1 a 0 1\nX1 a s\n.subckt s a\nR1 a b 1\nR2 b 0 1\n.save v(b)\n.ends\n.op\n.save v(x1.b)\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("W-ignored-card") && Contains(".save inside .subckt s"));
  CHECK(value_of(finished.out, "v(x1.b)") == Approx(0.5).epsilon(1e-12));
}

TEST_CASE("a deck whose only analysis is another one is told which", "[unit]") {
  const Scratch scratch;
  CHECK_THAT(run_deck(scratch, "sweep\nV1 a 0 1\nR1 a 0 1\n.dc V1 0 1 0.1\n").err,
             Contains("E-no-analysis") && Contains("the deck requests .dc alone"));
}

TEST_CASE("gates take time where without they never settle", "[unit]") {
  const Scratch scratch;
  // A protected return path: M1 and M2 close when v(pp,bm) is above 2.4 V. Before, the gate of M2 stands at its own drain: it holds bm at its threshold, 1 V and the overdrive of 0.4 mA,
  // sqrt(2·0.4 mA/(20 A/V²)) = 6 mV. Then some 9 mA through two channels of 0.05 Ω at most.
  const Finished finished = run_deck(scratch,
                                     "return\nI1 0 pp 0.1\nC1 pp 0 10u\nR1 pp bm 1k\nB1 a bm V=if(V(pp,bm)>2.4, V(pp,bm), 0)\n"
                                     "B2 b bm V=if(V(pp,bm)>2 & V(pp,bm)<20, V(pp,bm), 0)\nM1 d a bm MX\nM2 d b 0 MX\n"
                                     ".model MX VDMOS(Vto=1 Kp=20 Rd=10m Rs=10m Rg=5 Cgs=500p Cgdmax=60p Cgdmin=30p)\n.tran 1u 1m uic\n"
                                     ".meas early FIND V(bm) AT=0.15m\n.meas late FIND V(bm) AT=0.9m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("N-gates-take-time"));
  CHECK(value_of(finished.out, "early") == Approx(1.0).margin(0.012));
  CHECK(value_of(finished.out, "late") > 0.0);
  CHECK(value_of(finished.out, "late") < 9e-3 * 0.1);
}

TEST_CASE("a pulse of a number of cycles may be cut by the next", "[unit]") {
  const Scratch scratch;
  // A triangle of 2.4 us in a period of 2 us: it falls from 1 V to 1/3 V until it starts again, three times. Mean of a period: (1.2·0.5 + 0.8·(1 + 1/3)/2)/2.
  const Finished finished = run_deck(scratch,
                                     "cut\nV1 a 0 PULSE(0 1 0 1.2u 1.2u 0 2u 3)\nR1 a 0 1\n.tran 0.1u 8u\n.meas m AVG v(a) FROM=0 TO=6u\n"
                                     ".meas b FIND v(a) AT=1.9999999u\n.meas r MAX v(a) FROM=6.1u TO=8u\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("W-pulse-cut"));
  CHECK(value_of(finished.out, "m") == Approx((1.2 * 0.5 + 0.8 * (1.0 + 1.0 / 3.0) / 2.0) / 2.0).epsilon(1e-9));
  CHECK(value_of(finished.out, "b") == Approx(1.0 / 3.0).epsilon(1e-6));
  CHECK(value_of(finished.out, "r") == Approx(0.0).margin(1e-12));
}

TEST_CASE("a comparator drives either way", "[unit]") {
  const Scratch scratch;
  // 1 kΩ to 2.5 V: (5 V + 2.5 V·0.04)/1.04 when high, 2.5 V·0.04/1.04 when low. A sine of 1 V about 1 V passes 1.5 V, and the hysteresis of 1.75 mV, twice a period.
  const Finished finished =
      run_deck(scratch,
               "comparator\nV1 a 0 SIN(1 1 1k)\nV2 r 0 1.5\nV3 v 0 5\nV4 m 0 2.5\nX1 a r v 0 o comparator2 vh=1.75m\nR1 o m 1k\n"
               ".tran 1u 2m\n.meas hi MAX v(o)\n.meas lo MIN v(o)\n.meas up WHEN v(o)=2.5 RISE=1\n.meas down WHEN v(o)=2.5 FALL=1\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "hi") == Approx((5.0 + 0.1) / 1.04).epsilon(1e-6));
  CHECK(value_of(finished.out, "lo") == Approx(0.1 / 1.04).epsilon(1e-5));
  const double pi = 3.14159265358979;
  CHECK(value_of(finished.out, "up") == Approx(std::asin(0.50175) / (2.0 * pi * 1e3)).epsilon(1e-6));
  CHECK(value_of(finished.out, "down") == Approx((pi - std::asin(0.49825)) / (2.0 * pi * 1e3)).epsilon(1e-6));
}

TEST_CASE("a part that breaks down has its resistance then, too", "[unit]") {
  const Scratch scratch;
  // 300 V across the 1N4148 of the table, 100 V and 2 Ω, whose SPICE models have RS in series with the junction: (300 − 100) V/2 Ω.
  const Finished finished = run_deck(scratch, "mains\nV1 a 0 SIN(0 300 50)\nD1 a 0 1N4148\n.tran 10u 20m\n.meas lo MIN i(D1)\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("W-rated-voltage"));
  CHECK(value_of(finished.out, "lo") == Approx(-100.0).epsilon(1e-9));
}

TEST_CASE("parameters of another form of MOSFET model are no slips", "[unit]") {
  const Scratch scratch;
  // Shichman-Hodges in the linear region, level 1: v = R·Kp·(vov·vds − vds²/2) with vov = 8 V and Kp = 1 A/V² gives 10 − v = 8·v − v²/2, v = 9 − √61; the
  // channel is a line, so it is near that.
  const Finished planar =
      run_deck(scratch,
               "planar\nV1 d 0 10\nV2 g 0 10\nR1 d a 1\nM1 a g 0 0 MX\n.model MX NMOS(Vto=2 Kp=1 Cgs=50n Cgd=1n Cgdmax=2n)\n"
               ".tran 1u 10u\n.meas v MAX v(a)\n");
  INFO(planar.err);
  REQUIRE(planar.status == 0);
  CHECK_THAT(planar.err, Contains("Cgs, Cgd, Cgdmax of model MX are ignored"));
  CHECK(value_of(planar.out, "v") == Approx(9.0 - std::sqrt(61.0)).epsilon(0.15));
  const Finished vertical =
      run_deck(scratch, "vertical\nV1 d 0 10\nV2 g 0 10\nR1 d a 1\nM1 a g 0 MX\n.model MX VDMOS(Vto=2 Ron=1 cgso=1n)\n.tran 1u 10u\n");
  INFO(vertical.err);
  CHECK(vertical.status == 0);
  CHECK_THAT(vertical.err, Contains("cgso of model MX is ignored"));
  const Finished slip =
      run_deck(scratch, "slip\nV1 d 0 10\nV2 g 0 10\nR1 d a 1\nM1 a g 0 0 MX\n.model MX NMOS(Vtoo=2 Kp=1)\n.tran 1u 10u\n");
  CHECK_THAT(slip.err, Contains("E-unknown-parameter"));
}

TEST_CASE("a regulator by an expression may lie straight across its output capacitor", "[unit]") {
  const Scratch scratch;
  // The input rises by 4 V/ms: the capacitor takes 10 µF · 4 V/ms, the load v/33 Ω, both through 1 mΩ; at the top the load's current alone does.
  const std::string rest =
      "C1 out 0 10u\nR1 out 0 33\n.tran 10u 4m\n.meas v FIND v(out) AT=0.25m\n.meas i FIND i(C1) AT=0.25m\n.meas top FIND v(out) AT=1.5m\n";
  const std::string line = "regulator\nV1 in 0 PULSE(2 6 0 1m 1m 1m 4m)\n";
  for (const std::string source :
       {"E1 out 0 value={min(V(in)-0.2, 3.3)}\n", "B1 out 0 V=limit(V(in)-0.2, 0, 3.3)\n",
        "E1 out 0 TABLE {V(in)-0.2} = (0,0) (3.3,3.3) (6,3.3)\n", "B1 m 0 V=if(V(in)<3.5, V(in)-0.2, 3.3)\nV2 out m 0\n"}) {
    const Finished finished = run_deck(scratch, line + source + rest);
    INFO(source << finished.err);
    REQUIRE(finished.status == 0);
    CHECK_THAT(finished.err, Contains("N-source-resistance"));
    CHECK(value_of(finished.out, "v") == Approx(2.8 - 1e-3 * (0.04 + 2.8 / 33.0)).epsilon(1e-7));
    CHECK(value_of(finished.out, "i") == Approx(0.04).epsilon(1e-4));
    CHECK(value_of(finished.out, "top") == Approx(3.3 * 33.0 / 33.001).epsilon(1e-9));
  }
  // A resistor of the deck's own is enough, and so is one within the capacitor.
  for (const std::string& own :
       {"E1 m 0 value={min(V(in)-0.2, 3.3)}\nRS m out 1m\n" + rest,
        std::string("E1 out 0 value={min(V(in)-0.2, 3.3)}\nC1 out 0 10u Rser=1m\n.tran 10u 4m\n.meas top FIND v(out) AT=1.5m\n")}) {
    const Finished finished = run_deck(scratch, line + own);
    REQUIRE(finished.status == 0);
    CHECK_THAT(finished.err, !Contains("N-source-resistance"));
    CHECK(value_of(finished.out, "top") == Approx(3.3).epsilon(1e-4));
  }
}

TEST_CASE("a load carries nothing against a negative voltage", "[unit]") {
  const Scratch scratch;
  // 10 V of 50 Hz over 1 Ω: nothing below zero, v/1 mΩ in the knee, and 2 A from 2 V on.
  const Finished sine = run_deck(scratch,
                                 "load\nV1 a 0 SIN(0 10 50)\nR1 a b 1\nI1 b 0 2 load\n.tran 10u 20m\n.meas avg AVG i(I1)\n"
                                 ".meas lo MIN v(b)\n.meas hi MAX v(b)\n");
  INFO(sine.err);
  REQUIRE(sine.status == 0);
  const double angle = std::asin(0.2);  // of 2 A: the source then drives it all
  CHECK(value_of(sine.out, "avg") ==
        Approx((2.0 * (3.14159265358979 - 2.0 * angle) + 20.0 * (1.0 - std::cos(angle))) / 6.28318530717959).epsilon(2e-3));
  CHECK(value_of(sine.out, "lo") == Approx(-10.0).epsilon(1e-6));
  CHECK(value_of(sine.out, "hi") == Approx(8.0).epsilon(1e-6));
  CHECK_THAT(sine.err, !Contains("N-load"));
  // Behind a rectifier at rest it waits for a voltage.
  const Finished rest = run_deck(scratch,
                                 "rest\nV1 a 0 SIN(0 10 50)\nD1 a b DX\nC1 b 0 100u\nI1 b 0 0.1 load\n.model DX D(Ron=10m)\n"
                                 ".tran 10u 40m\n.meas lo MIN v(b)\n.meas i FIND i(I1) AT=6m\n");
  INFO(rest.err);
  REQUIRE(rest.status == 0);
  CHECK_THAT(rest.err, !Contains("W-no-operating-point"));
  CHECK(value_of(rest.out, "lo") == Approx(0.0).margin(1e-6));
  CHECK(value_of(rest.out, "i") == Approx(0.1).epsilon(1e-9));
}

TEST_CASE("a measurement of a node that shows a power measures the product", "[unit]") {
  const Scratch scratch;
  // (10 V sin)²/10 Ω: 5 W in the mean, 10 W at the peak; half of both at b.
  const Finished finished =
      run_deck(scratch,
               "power\nV1 a 0 SIN(0 10 50)\nR1 a 0 10\nB1 p 0 V=V(a)*I(R1)\nB2 q 0 V={0.5*V(a)**2/10+0*V(a)}\n.tran 0 40m\n"
               ".meas pavg AVG V(p)\n.meas pk MAX V(p) FROM 10m TO 30m\n.meas q AVG V(q)-V(p)\n.backanno\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("W-unread-part"));
  CHECK(value_of(finished.out, "pavg") == Approx(5.0).epsilon(1e-9));
  CHECK(value_of(finished.out, "pk") == Approx(10.0).epsilon(1e-9));
  CHECK(value_of(finished.out, "q") == Approx(-2.5).epsilon(1e-9));
}

TEST_CASE("two amplifiers may drive one node", "[unit]") {
  const Scratch scratch;
  // A window comparator. Within the window both are low, 10 ohm each below 2 V over 100 kohm; outside one sinks its 25 mA, which the other gives through its 10 ohm.
  const Finished finished =
      run_deck(scratch,
               "window\nV1 p 0 2\nV2 in 0 PWL(0 0.1 1m 0.3)\nV3 hi 0 0.25\nV4 lo 0 0.15\nR1 p out 100k\n"
               "X1 in hi p 0 out level.2 Ilimit=25m\nX2 lo in p 0 out LM358\n.tran 1u 1m\n.meas below FIND v(out) AT=0.1m\n"
               ".meas within FIND v(out) AT=0.5m\n.meas above FIND v(out) AT=0.9m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK_THAT(finished.err, Contains("N-universal-opamp") && Contains("drive one node"));
  CHECK(value_of(finished.out, "within") == Approx(2.0 / (1.0 + 100e3 / 5.0)).epsilon(1e-3));
  const double outside = 2.0 - 25e-3 / (1.0 / 10.0 + 1.0 / 100e3);
  CHECK(value_of(finished.out, "above") == Approx(outside).epsilon(1e-3));
}

TEST_CASE("an amplifier wakes up with its supply", "[unit]") {
  const Scratch scratch;
  // Its output stops 1.5 V from either supply; below 3 V there is nothing between, and it is halfway. A follower of 4 V.
  const Finished finished = run_deck(scratch,
                                     "ramp\nV1 vcc 0 PWL(0 0 1m 12)\nV2 in 0 4\nR1 out 0 10k\nX1 in out vcc 0 out LM741\n.tran 1u 2m\n"
                                     ".meas early FIND v(out) AT=0.1m\n.meas rail FIND v(out) AT=0.4m\n.meas late FIND v(out) AT=1.5m\n");
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  CHECK(value_of(finished.out, "early") == Approx(0.6).epsilon(1e-6));
  CHECK(value_of(finished.out, "rail") == Approx(4.8 - 1.5).epsilon(1e-6));
  CHECK(value_of(finished.out, "late") == Approx(4.0).epsilon(1e-4));
}
