// What a run on Krylov segments tells beside its rows: orbits, multipliers, impulses, events, passivity.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <sstream>
#include <string>

#include "cli/json_result.hpp"
#include "cli/run_in.hpp"
#include "support/json.hpp"

using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

struct Told {
  Json json;
  std::string err;
};

Told told_by_segments(const Scratch& scratch, const std::string& deck, const std::vector<std::string>& more = {}) {
  scratch.write("deck.net", deck);
  std::vector<std::string> arguments{"deck.net", "--engine", "krylov", "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished finished = run_in(scratch, arguments);
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  return {read_json(finished.out), finished.err};
}

void has_multipliers(const Json& result, const std::vector<std::complex<double>>& expected, double tolerance) {
  CHECK(result["pss"]["stability"].string == "stable");
  REQUIRE(result["pss"]["multipliers"].array.size() >= expected.size());
  for (const auto& value : expected) {
    double apart = INFINITY;
    for (const Json& m : result["pss"]["multipliers"].array)
      apart = std::min(apart, std::abs(std::complex<double>{m["re"].number, m["im"].number} - value));
    INFO(value.real() << " " << value.imag());
    CHECK(apart <= tolerance);
  }
}

constexpr double of_differences = 1e-7;  ///< of multipliers that are known from differences of runs

}  // namespace

// 0.5 A through 1 Ohm. The part of the sources alone has no unknown then.
TEST_CASE("currents of current sources alone can be saved by Krylov segments", "[regression]") {
  const Scratch scratch;
  scratch.write("deck.net", "source\nI1 b 0 0.5\nR1 b 0 1\n.save v(b) i(I1)\n.tran 1u 2u\n.end\n");
  const Finished finished = run_in(scratch, {"deck.net", "--engine", "krylov", "-o", "-", "--quiet"});
  CHECK(finished.status == 0);
  CHECK(finished.out == "time,v(b),i(I1)\n0,-0.5,0.5\n1e-06,-0.5,0.5\n2e-06,-0.5,0.5\n");
}

// The gate is a part of its own; its edges, at 3, 10, 13, ... 50 us, are those of the switch.
TEST_CASE("an edge that two parts come upon is one event of the page by Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told =
      told_by_segments(scratch,
                       "buck\nV1 in 0 12\nVg g 0 PULSE(0 1 0 0 0 3u 10u)\nS1 in sw g 0 SW\nD1 0 sw DX\nL1 sw out 22u ic=3\nC1 "
                       "out 0 10u ic=3.6\nR1 out 0 1\n.model SW SW(Vt=0.5)\n.model DX D\n.tran 1u 50u uic\n.save v(g) v(out)\n.end\n",
                       {"--report", "page.html"});
  CHECK(told.json["stats"]["events"].number == 10.0);
  CHECK_THAT(read_file(scratch / "page.html"), Contains("\"eventCount\": 10"));
}

// A column par() is the voltage of a source that nothing loads.
TEST_CASE("a column that is computed leaves a circuit passive by Krylov segments", "[regression]") {
  const Scratch scratch;
  const std::string rectifier =
      "rectifier\nV1 a 0 SIN(0 10 50)\nR1 a b 1\nD1 b c DX\nC1 c 0 1m\nR2 c 0 50\n.model DX D\n.save par('v(a)-2*v(c)')\n.tran 1m 20m\n";
  const Told told = told_by_segments(scratch, rectifier + ".end\n");
  CHECK(told.json["stats"]["certificate"]["passive"].truth);
  const Told loaded = told_by_segments(scratch, rectifier + "E1 d 0 c 0 2\nR3 d c 1k\n.end\n");
  CHECK_FALSE(loaded.json["stats"]["certificate"]["passive"].truth);
}

// Multipliers: eigenvalues of central differences (1e-4 of each state) of runs over one period by dense modes, which have no derivative. Where S1 opens, or the diode blocks, the inductor's current
// goes through 37 megohm within 0.2 ps.
TEST_CASE("multipliers behind a decay of picoseconds by Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told = told_by_segments(scratch,
                                     "cuk\nV1 src 0 7.68\nRs src in 0.00608\nCin in 0 2.42e-05\nVg1 g1 0 PULSE(0 1 0 10n 10n 4.434393e-06 "
                                     "1e-05)\nL1 in a 7.5e-06\nS1 a 0 g1 0 SW\nC2 a b 6.5e-06\nD1 b 0 DX\nL2 b out 2e-05\nC1 out 0 "
                                     "3.95e-06\nR1 out 0 9.78\nI1 out 0 0.157055\n.model DX D()\n.model SW SW(Vt=0.5 Ron=0.00231 "
                                     "Roff=3.71e+07)\n.pss points=60 tstab=0.0002\n.save v(out)\n.end\n");
  has_multipliers(told.json, {{0.3275521971, 0.8452110263}, {0.3275521971, -0.8452110263}, {0.8294159015, 0.0}}, of_differences);
}

// Expected as above. Currents of both inductors are one while all blocks: the last vectors of the space are rounding.
TEST_CASE("multipliers of a converter in discontinuous conduction by Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told = told_by_segments(
      scratch,
      "cuk\nV1 src 0 31.9\nLs src in 3.96e-06\nCin in 0 8.07e-05 Rser=0.00221\nVg1 g1 0 PULSE(0 1 0 25n 25n 2.621755e-06 5e-06)\nL1 in a "
      "8e-05 Rser=0.0021\nS1 a 0 g1 0 SW\nC2 a b 5.3e-07 Rser=0.053\nD1 b 0 DX\nL2 b out 1.26e-05\nC1 out 0 8e-06 Rser=0.00611\nR1 out 0 "
      "26.3\nI1 out 0 0.242586\n.model DX D(Ron=0.00172)\n.model SW SW(Vt=0.5)\n.pss points=60 tstab=0.0001\n.save v(out)\n.end\n");
  has_multipliers(told.json,
                  {{0.9572436734, 0.2747577732},
                   {0.9572436734, -0.2747577732},
                   {0.9592018622, 0.0},
                   {0.5824206023, 0.5172917904},
                   {0.5824206023, -0.5172917904}},
                  of_differences);
}

// The current never ends in a gap, so that all changes have fixed times: its deviations decay with L1/R1. Both halves of the period are alike: no mean. After one step the residual is an exact zero.
TEST_CASE("an orbit that is reached exactly by Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told =
      told_by_segments(scratch,
                       "half bridge\nV1 in 0 130\nV2 0 neg 130\nVg1 g1 0 PULSE(0 1 0 0 0 2.409968e-06 5e-06)\nVg2 g2 0 "
                       "PULSE(0 1 2.5e-06 0 0 2.409968e-06 5e-06)\nS1 in sw g1 0 SW\nS2 sw neg g2 0 SW\nD1 sw in DX\nD2 neg sw "
                       "DX\nL1 sw out 6.9u\nR1 out 0 2.04\n.model DX D(Vfwd=0.973)\n.model SW SW(Vt=0.5)\n.pss points=60 "
                       "uic\n.meas pss mean AVG i(L1)\n.meas pss most MAX i(L1)\n.end\n");
  has_multipliers(told.json, {{std::exp(-2.04 * 5.0 / 6.9), 0.0}}, 1e-10);
  CHECK(std::abs(measured(told.json, "mean")) <= 1e-9 * measured(told.json, "most"));
}

// Every current is zero at the end of the period, to rounding: no scale for an error.
TEST_CASE("the error of an orbit by Krylov segments is relative to the largest of the period", "[regression]") {
  const Scratch scratch;
  const Told told = told_by_segments(scratch,
                                     "boost\nV1 in 0 30.6\nVg1 g1 0 PULSE(0 1 0 10n 10n 2.753236e-06 1e-05)\nL1 in sw 1.19e-05\nS1 sw 0 g1 "
                                     "0 SW\nD1 sw out DX\nC1 out 0 6.55e-06 Rser=0.00146\nR1 out 0 110\nI1 out 0 0.0556364\n.model DX "
                                     "D(Ron=0.00706 Vfwd=0.251)\n.model SW SW(Vt=0.5)\n.pss points=60\n.save v(out)\n.end\n");
  CHECK(told.json["pss"]["uncertainty"].number <= 1e-12);
}

// Each period S1 takes C1's charge, 1 nF (10 V)(1 - e^-6), and 10 mA for 4 us; R1 carries no impulse. The source of current is a part without unknowns: what was before t = 0 is known of it, too, so
// that the jump there counts, and the edge of the gate.
TEST_CASE("an orbit that begins with a jump has no start to project by Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told =
      told_by_segments(scratch,
                       "snubber\nV1 in 0 10\nR1 in a 1k\nC1 a 0 1n\nS1 a 0 g 0 SW\nVg g 0 PULSE(0 1 0 0 0 4u 10u)\nI1 x 0 1\nR2 "
                       "x 0 1\n.model SW SW(Vt=0.5)\n.pss points=10\n.meas pss q INTEG i(S1)\n.meas pss least MIN i(R1)\n.meas "
                       "pss edge WHEN v(g)=0.3 CROSS=2\n.meas pss source AVG i(I1)\n.save v(a) i(I1)\n.end\n");
  CHECK_THAT(told.err, !Contains("W-start-projected"));
  CHECK_THAT(told.err, !Contains("W-impulse-left-out"));
  CHECK(measured(told.json, "q") == Approx(1e-8 * (1.0 - std::exp(-6.0)) + 4e-8).epsilon(1e-9));
  CHECK(measured(told.json, "least") == Approx(0.01 * std::exp(-6.0)).epsilon(1e-9));
  CHECK(measured(told.json, "edge") == Approx(4e-6).epsilon(1e-12));
  CHECK(measured(told.json, "source") == Approx(1.0).epsilon(1e-12));
}

// All values are zero, as the circuit's are at the start but for the 5 nA that 10 gigohm let through L1, within 10^-16 s.
TEST_CASE("a current through a leak at the start is no contradiction by Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told = told_by_segments(scratch,
                                     "inverting\nV1 in 0 48\nVg g 0 PULSE(0 1 1u 0 0 3u 8u)\nS1 in sw g 0 SW\nL1 sw 0 1.69u ic=0\nD1 out "
                                     "sw DX\nC1 out 0 650u ic=0\nR1 out 0 0.6\n.model DX D(Roff=6e10)\n.model SW SW(Roff=1e10 "
                                     "Vt=0.5)\n.save v(out)\n.tran 1u 40u uic\n.end\n");
  CHECK_THAT(told.err, !Contains("W-start-projected"));
}

// Where S1 opens, 10 gigohm and 3.19 gigohm let what is left of a current decay within 10^-14 s: the ends of pieces, which a measurement asks for, lie within.
TEST_CASE("a measurement does not spoil the certificate of Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told = told_by_segments(
      scratch,
      "sepic\nVg0 g0 0 PULSE(0 1 5.752e-06 1.06e-07 1.06e-07 1.6112e-06 1.06e-05)\nV1 in 0 400\nL1 in fi 1.86e-05 ic=0\nC1 fi 0 1.92e-05 "
      "ic=400\nR1 in fi 6.36\nL2 fi a 0.000117 ic=0\nS1 a 0 g0 0 SX1\nC2 a b 2.99e-05 ic=0\nL3 b 0 0.00017 ic=0\nD1 b out DX0\nC3 out 0 "
      "3.19e-05 ic=0\nR2 out 0 5.39\n.model DX0 D(Ron=0.0128 Roff=3190000000 Vfwd=0.3)\n.model SX1 SW(Ron=0.0597 Roff=10000000000 "
      "Vt=0.5)\n.save v(b) i(V1)\n.tran 0 2.50992e-4 1.756944e-4 2.50992e-07 uic\n.meas tran m2 PP i(L2) FROM=3.957573e-05\n.end\n");
  CHECK(told.json["stats"]["certificate"]["kcl_kvl"].number < 1e-8);
}

// Two converters tied at windings: inductors alone meet at p0, sa1 and f1, so that a voltage there is the derivative of currents, and what rounding of these decays through 10^12 ohm within 10^-19 s.
// No winding has more than a few times the 24 V of the supply.
TEST_CASE("rows right after events do not show rounding across a leak by Krylov segments", "[regression]") {
  const Scratch scratch;
  scratch.write(
      "tied.net",
      "tied\nVg1_0 g10 0 PULSE(0 1 8.99e-06 7.35e-08 7.35e-08 3.3065e-06 7.35e-06)\nV1_0 in0 0 24\nD1_0 sw0 in0 DX0_0\nS2_0 sw0 0 "
      "g10 0 SX1_0\nD2_0 0 sw0 DX0_0\nC1_0 sw0 r0 3.56e-09\nL1_0 r0 p0 0.000249\nL2_0 p0 0 0.000854\nL3_0 sa0 0 "
      "0.00040895\nL4_0 0 sb0 0.00040895\nD4_0 sb0 out0 DX0_0\nC2_0 out0 0 2.2e-06\nR1_0 out0 0 23\nK1_0 L2_0 L3_0 L4_0 "
      "0.98\n.model DX0_0 D(Ron=0.00532 Roff=1e12 Vfwd=1)\n.model SX1_0 SW(Ron=0.00532 Vt=0.5)\nRp_0 p_p0 p0 1e-3\nVg1_1 g11 0 "
      "PULSE(0 1 5.772e-06 1.11e-09 1.11e-09 2.2966e-06 1.11e-05)\nL1_1 in1 a1 0.00707\nL2_1 b1 in1 0.00707\nS2_1 b1 0 g11 0 "
      "SX1_1\nR1_1 a1 sna1 22.1\nC1_1 sna1 0 2.31e-09\nR2_1 b1 snb1 140\nC2_1 snb1 0 4.47e-10\nL3_1 sa1 0 0.0012353\nL4_1 0 sb1 "
      "0.0012353\nD3_1 sa1 f1 DX0_1\nL5_1 f1 out1 8.01e-05\nR3_1 out1 0 21.6\nK1_1 L1_1 L2_1 L3_1 L4_1 0.95\n.model DX0_1 "
      "D(Ron=0.0112 Roff=1e9 Vfwd=0.55)\n.model SX1_1 SW(Ron=0.0301 Roff=1e6 Vt=0.5)\nVp_1 p_sa1 sa1 0\nRT p_p0 p_sa1 1796.13\n"
      ".ic v(snb1)=11.5958\n.save v(f1)\n.tran 10u 40u\n.end\n");
  const Finished finished = run_in(scratch, {"tied.net", "--engine", "krylov", "--events", "-o", "-", "--quiet"});
  REQUIRE(finished.status == 0);
  std::istringstream rows(finished.out);
  std::string line;
  std::getline(rows, line);
  double most = 0.0;
  while (std::getline(rows, line)) most = std::max(most, std::abs(std::stod(line.substr(line.find(',') + 1))));
  CHECK(most > 1.0);
  CHECK(most < 100.0);
}

// S1 closes at t = 0, before which v(a) is the supply's voltage and that of C1, and takes v(a) through 7.7 V. The search begins far from there.
TEST_CASE("what was before t = 0 of an orbit by Krylov segments is its end", "[regression]") {
  const Scratch scratch;
  const Told told = told_by_segments(
      scratch,
      "flyback\nV1 src 0 11.3\nLs src in 2.38e-06\nCin in 0 8.11e-06 Rser=0.00799\nVg1 g1 0 PULSE(0 1 0 0 0 1.856018e-06 5e-06)\nLp in a "
      "1.455e-05\nLq 0 b 1.48425e-05\nK1 Lp Lq 1\nS1 a 0 g1 0 SW\nD1 b out DX\nC1 out 0 7.05e-06\nR1 out 0 2.33\n.model DX D()\n.model SW "
      "SW(Vt=0.5 Ron=0.00165 Roff=415000)\n.pss points=60 uic\n.meas pss falls WHEN v(a)=7.7 CROSS=1\n.meas pss rises WHEN v(a)=7.7 "
      "CROSS=2\n.end\n");
  CHECK(measured(told.json, "falls") == 0.0);
  CHECK(measured(told.json, "rises") == Approx(1.856018e-6).epsilon(1e-12));
}

// A snubber that S1 shorts each period, behind windings that are not perfectly coupled: its 12 nF carry all of the impulse, the supply's capacitor with 32 milliohm and the diodes none.
TEST_CASE("currents that carry no impulse have none by Krylov segments", "[regression]") {
  const Scratch scratch;
  const Told told = told_by_segments(
      scratch,
      "forward\nV1 src 0 274\nLs src in 1.11e-07\nCin in 0 3.39e-06 Rser=0.0319\nVg1 g1 0 PULSE(0 1 0 0 0 4.4262766e-05 0.0001)\nLp in a "
      "0.0064\nLr 0 c 0.0064\nLq b 0 0.000266342\nK1 Lp Lr Lq 0.995\nS1 a 0 g1 0 SW\nD3 c in DX\nCsn a 0 1.19e-08\nRsn c 0 1490\nD1 b x "
      "DX\nD2 0 x DX\nL1 x out 0.000925 Rser=0.00229\nC1 out 0 6.21e-05\nR1 out 0 75.8\n.model DX D(Ron=0.0118 Roff=538000 "
      "Vfwd=0.228)\n.model SW SW(Vt=0.5)\n.pss points=60\n.meas pss least MIN i(Cin)\n.meas pss d MAX i(D3)\n.save v(out)\n.tran 10u "
      "100u\n.end\n");
  CHECK_THAT(told.err, !Contains("W-impulse-left-out"));
  const auto& jumps = told.json["stats"]["jump_details"].array;
  REQUIRE_FALSE(jumps.empty());
  for (const Json& jump : jumps) {
    REQUIRE(jump["impulses"].array.size() == 1);
    CHECK(jump["impulses"].array[0]["element"].string == "S1");
  }
}
