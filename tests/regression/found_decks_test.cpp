/// Decks that once ended the program (found by tests/random_decks), each as small as it can be.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

// Nothing stores energy and no source drives: the control of the switch reads nothing. Open at 0 V with Vt = 1, all is 0.
TEST_CASE("a switch whose control no state and no source can move", "[regression]") {
  const DeckRun run = run_text("static\nR1 a 0 1\nS1 a 0 0 0 M\n.model M SW(Vt=1)\n.save v(a)\n.tran 1m 2m\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const auto& row : run.rows) CHECK(row[1] == 0.0);
}

// 1 V behind 1 Ω to 1 µF and 10 Ω: v(b) moves by 1/64 of its time constant of 0.9 µs in one of the steps that tell a jump from a motion.
TEST_CASE("the sparse engine takes no fast motion after an edge for a jump", "[regression]") {
  const DeckRun run = run_text_sparse(
      "t\nV1 c 0 PULSE(0 1 1m 0 0 1m 2m)\nV2 a 0 1\nS1 a b c 0 SW\nR1 b 0 10\nC1 b 0 1u\n.model SW SW(Vt=.5 Ron=1)\n.save v(b)\n.tran 1m "
      "4m\n",
      1e-4, true);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.jumps == 0);
  // Before and behind each edge the same: it has come to rest, at 0 or at 10/11 V.
  for (const auto& row : run.rows) CHECK(row[1] == Approx(row[0] == 2e-3 || row[0] == 4e-3 ? 1.0 / 1.1 : 0.0).margin(3e-4 / 1.1));
}

// v(t) = a e^{−t} + b e^{−λt} falls through Vt: Chebyshev's iteration could stand still elsewhere, where its step is nothing.
TEST_CASE("two capacitors discharge through a switch's threshold", "[regression]") {
  struct Case {
    double a, b, rate, threshold;
  };
  for (const Case& k : {Case{0.7229219511326379, 1.152914965710954, 10.0, 0.874123282742411},
                        Case{0.6929184284242083, 2.7080980412368794, 10.0, 0.821161865254852},
                        Case{0.5923054657990292, 2.7308717236257123, 10.0, 0.6371561744005414},
                        Case{0.4106465986104495, 2.736054473942988, 10.0, 0.42311414506884315},
                        Case{0.23913734127520847, 0.8390689801984391, 40.0, 0.2536282442286415}}) {
    const DeckRun run = run_text(
        fmt::format("t\nC1 m 0 1 ic={}\nR1 m 0 1\nC2 t m 1 ic={}\nR2 t m {}\nV1 s 0 1\nS1 s o t 0 M on\nR3 o 0 1\n.model M SW(Vt={} Vh=0)\n"
                    ".save v(o)\n.tran 4 4 uic\n",
                    k.a, k.b, 1.0 / k.rate, k.threshold),
        true);
    INFO(run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    REQUIRE(run.rows.size() >= 3);
    long double low = 0.0L, high = 4.0L;
    for (int i = 0; i < 100; ++i) {
      const long double middle = (low + high) / 2;
      (k.a * std::exp(-middle) + k.b * std::exp(-k.rate * middle) > static_cast<long double>(k.threshold) ? low : high) = middle;
    }
    CHECK(run.rows[1][0] == Approx(static_cast<double>(low)).epsilon(1e-11));
  }
}

TEST_CASE("wires in a loop are named", "[regression]") {
  const DeckRun run = run_text("t\nV1 a 0 1\nR1 a b 0\nR2 a b 0\nR3 b 0 1\n.tran 1 1\n");
  CHECK(run.messages.find("error[E-source-loop]: R1, R2 form a loop without resistance, so their currents are not determined") !=
        std::string::npos);
}

TEST_CASE("modes are counted where there are diodes or switches", "[regression]") {
  CHECK(run_text("t\nV1 a 0 1\nR1 a b 1\nC1 b 0 1\n.tran 1 1 uic\n").answer.statistics.modes_visited == 1);
  CHECK(run_text("t\nV1 a 0 SIN(0 1 1)\nD1 a b D\nR1 b 0 1\n.model D D\n.tran 10m 3 uic\n").answer.statistics.modes_visited == 2);
}

// W19 opens and closes every 6e-19 s around a current that nothing else sees: 10^11 flips to the end of the run. Before that the switches are
// driven by currents that are zero at the operating point, where rounding can leave them without rest.
TEST_CASE("a switch that flips on and on with no effect ends the run with a message", "[regression]") {
  const DeckRun run = run_text(
      "idle flips\nV1 a in PULSE(0 1.58 14.5n 0 2.2e-09 10.2n 59.2n)\nR2 a 0 280k\n.model mCAP4 CAP(C=2.34)\nC3 b a 1.28e-12 mCAP4\n"
      "R5 out b 1.15k\nR7 a n1 351\nL8 0 n1 181u\nV11 out b EXP(10.2 2.62 1.93e-08 2.23e-08) Rser=41.9k\n"
      ".model mD12 D(Roff=0.000245 Vfwd=0.601 Rrev=1.76)\nD13 0 a mD12\nR15 o14 in 18k Rser=683\nH16 o14 0 C3 0.824\nR17 a n1 1.34k\n"
      ".model mCSW18 CSW\nW19 in o14 H16 mCSW18 on\nW20 in 0 R5 mCSW18\nL21 n1 a 14.3u\n.subckt sub1 t0 t1\nR24 0 t0 1.08e+04\n"
      "C25 m t0 5.54e-13\nC26 t1 t0 2.97e-13\n.ends\nX1002 out a sub1\n.tran 950p 52.8n\n");
  CHECK(run.answer.outcome != engine::Outcome::completed);
  CHECK((run.answer.id == "E-accumulation" || run.answer.id == "E-no-operating-point" || run.answer.id == "E-no-solution"));
}

namespace {

/// A leg of a modular multilevel converter (validation/large/circuits.py): half bridges with diodes, a gate pulse each.
std::string multilevel_leg(int submodules) {
  constexpr double period = 20e-3, edge = 1e-6, depth = 0.9, link = 800.0;
  std::string deck = fmt::format("leg\nVP p 0 {}\nVN n 0 {}\n", link / 2, -link / 2);
  for (const bool upper : {true, false})
    for (int k = 0; k < submodules; ++k) {
      const std::string a = upper ? "U" : "L";
      const std::string above = k > 0 ? fmt::format("{}{}", a, k) : upper ? "p" : "la";
      const std::string below = k < submodules - 1 ? fmt::format("{}{}", a, k + 1) : upper ? "ua" : "n";
      const double angle = std::asin(std::clamp(((2.0 * k + 1.0) / submodules - 1.0) / depth, -0.999, 0.999));
      const double half = period / 4 + angle * period / (2.0 * std::acos(-1.0));
      const double start = std::fmod((upper ? 0.75 : 0.25) * period - half + period, period);
      const bool wraps = start + 2.0 * half > period;
      const double delay = wraps ? start + 2.0 * half - period : start;
      const double width = (wraps ? period - 2.0 * half : 2.0 * half) - edge;
      for (const bool bottom : {false, true})
        deck += fmt::format("V{0}{1}{2} {0}{1}{2} 0 PULSE({3} {4} {5:.9e} {6} {6} {7:.9e} {8})\n", a, bottom ? "h" : "g", k,
                            wraps == bottom ? 0 : 1, wraps == bottom ? 1 : 0, delay, edge, width, period);
      deck += fmt::format("C{0}{1} {0}c{1} {2} {3} ic={4}\n", a, k, below, 4e-4 * submodules, link / submodules);
      deck += fmt::format("S{0}t{1} {0}c{1} {2} {0}g{1} 0 SW\nS{0}b{1} {2} {3} {0}h{1} 0 SW\n", a, k, above, below);
      deck += fmt::format("D{0}t{1} {2} {0}c{1} DI\nD{0}b{1} {3} {2} DI\n", a, k, above, below);
    }
  return deck +
         "LU ua o 3m\nLL o la 3m\nRO o x 10\nLO x 0 5m\n.model DI D\n.model SW SW(Ron=1m Roff=1meg Vt=0.5 Vh=0)\n"
         ".save i(LU) i(LL) i(LO)\n.tran 40u 15.1m uic\n";
}

}  // namespace

// Where the current of an arm passes zero its fifteen diodes take over within rounding of one another. Kirchhoff's law at the output, and the
// implicit steps of the other engine.
TEST_CASE("diodes of one arm that begin to conduct together", "[regression]") {
  const std::string deck = multilevel_leg(15);
  const DeckRun exact = run_text(deck);
  INFO(exact.answer.id << " " << exact.answer.message);
  REQUIRE(exact.answer.outcome == engine::Outcome::completed);
  constexpr double tolerance = 1e-6, largest_current = 40.0, kirchhoff_bound = 1e-9;
  const double global_bound = 20.0 * std::cbrt(tolerance * tolerance);
  const DeckRun sparse = run_text_sparse(deck, tolerance);
  REQUIRE(sparse.rows.size() == exact.rows.size());
  for (std::size_t i = 0; i < exact.rows.size(); ++i) {
    const auto& row = exact.rows[i];
    CHECK(std::abs(row[1] - row[2] - row[3]) <= kirchhoff_bound * largest_current);
    for (std::size_t column = 1; column < row.size(); ++column)
      CHECK(std::abs(row[column] - sparse.rows[i][column]) <= global_bound * largest_current);
  }
}

// Where an arm's current passes zero, its 400 diodes follow one another within femtoseconds, and what is left of the others is rounding: some fifty positions were tried at each of these instants, 26
// solutions for an event of the run. 15: gate 1 of docs/validation/large.md.
TEST_CASE("Krylov segments of a multilevel converter of 400 submodules take few solutions for an event", "[regression][long]") {
  constexpr double most_solutions = 15.0;
  const DeckRun run = run_text_segments(multilevel_leg(400));
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto& statistics = run.answer.statistics;
  CHECK(static_cast<double>(statistics.klu_solves) <= most_solutions * static_cast<double>(statistics.events));
}

// Its sixteen ideal sections reach a diode at orders of the source's ramp that rounding hides: the guards leave zero unseen, and small.
TEST_CASE("diodes along a line of L and C are followed without sampling", "[regression]") {
  constexpr int sections = 16;
  std::string deck = "line\nV1 s 0 PULSE(0 10 1u 10n 10n 5u 10u)\nRS s n0 50\n";
  for (int i = 1; i <= sections; ++i) deck += fmt::format("L{0} n{1} n{0} 2.5u\nC{0} n{0} 0 1n\n", i, i - 1);
  for (const int at : {sections / 2, sections}) deck += fmt::format("D{0} n{0} d{0} DI\nRD{0} d{0} 0 100\nCD{0} d{0} 0 10n\n", at);
  deck += fmt::format("RL n{0} 0 1k\n.model DI D\n.save v(n{0}) v(d{0})\n.tran 100n 20u\n", sections);
  const DeckRun exact = run_text(deck);
  REQUIRE(exact.answer.outcome == engine::Outcome::completed);
  for (const engine::Remark& remark : exact.answer.remarks) CHECK(remark.id != "W-events-sampled");
  // The implicit steps of the other engine, with errors that add up over some fifty events.
  constexpr double tolerance = 1e-6, source = 10.0;
  const DeckRun sparse = run_text_sparse(deck, tolerance);
  REQUIRE(sparse.rows.size() == exact.rows.size());
  for (std::size_t i = 0; i < exact.rows.size(); ++i)
    for (std::size_t column = 1; column < exact.rows[i].size(); ++column)
      CHECK(std::abs(exact.rows[i][column] - sparse.rows[i][column]) <= 20.0 * std::cbrt(tolerance * tolerance) * source);
}

// D3 short-circuits the source that A10 is: no current fits, and the engine that does not examine this shared 6 GA out in steps of 0.3 µs.
TEST_CASE("small steps that violate the laws altogether are given up", "[regression]") {
  const std::string deck =
      "short\nV1 0 b SIN(0 0.702 0.596)\n.model mD2 D( )\nD3 0 A MD2\nR5 out a R=830k\nL6 0 out 49.4k ic=12.2u\n.model mISWITCH7 ISWITCH\n"
      "W8 a 0 D3 mISWITCH7\n.model md_dt9 d_dt( gain=0.548 )\nA10 %v out a md_dt9\nL11 b 0 885k\nB13 0 a I={-(sgn(0.543))+i(L11)}\n"
      "C14 0 a 28.5u ic=1.76\n.tran 481m 9.88 uic\n";
  const DeckRun run = run_text_sparse(deck, 1e-6);
  CHECK(run.answer.outcome == engine::Outcome::no_solution);
  CHECK(run.answer.id == "E-step");
}

// The part hangs at ground by L2 alone, which carries nothing. What rounding leaves of its capacitances is one of 10⁻²⁷ F, and rings with L2 at 10¹⁴ rad/s:
// steps of 10⁻¹⁶ s after the start followed that.
TEST_CASE("a ring that is made of rounding does not hold up the steps", "[regression]") {
  const DeckRun run = run_text_sparse(
      "hangs\nV1 a 3 PWL(0 9.19 1u 9.19 2u 20)\nL2 a x 24m\nR2 x 0 135k\nC5 a in 7.4p\nR6 a n1 13.5k\nC7 n1 3 77.8p\n.save v(a,n1)\n.tran "
      "1u 4u\n",
      1e-6);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  REQUIRE(run.rows.size() == 5);
  // R6 and C7 behind the ramp: slope·τ·(1 − e^(−t/τ)), and its decay.
  const double tau = 13.5e3 * 77.8e-12, at_end_of_ramp = 10.81e6 * tau * (1.0 - std::exp(-1e-6 / tau));
  constexpr double few_tolerances = 1e-5, slope_of_ramp_times_tau = 11.4;
  CHECK(std::abs(run.rows[2][1] - at_end_of_ramp) <= few_tolerances * slope_of_ramp_times_tau);
  CHECK(std::abs(run.rows[4][1] - at_end_of_ramp * std::exp(-2e-6 / tau)) <= few_tolerances * slope_of_ramp_times_tau);
}

// R/L is no double.
TEST_CASE("time constants below the range of numbers end the run with a message", "[regression]") {
  const DeckRun run = run_text("tiny\nV1 a 0 PULSE(0 1 0 0 0 1 2)\nR1 a b 1\nL1 b 0 1e-320\n.tran 1m 2m\n");
  CHECK(run.answer.outcome == engine::Outcome::no_solution);
  CHECK(run.answer.message.find("part with node b") != std::string::npos);
}

// S14 holds 1.55 V across V1's 1.12 V: Kirchhoff's laws are off by 10⁻⁴ in every step, and the steps were picoseconds of a tenth of a second.
TEST_CASE("small steps that break Kirchhoff's laws are given up", "[regression]") {
  const DeckRun run = run_text_sparse(
      "contradiction\nV1 b out DC 1.12\nC9 b 0 1.73e-07\nL10 0 out 2.21e+03 ic=-7.7e-06\nR11 out b 1.59e+06\nC12 a out 876n ic=1.98\n"
      ".model mVSWITCH13 VSWITCH( Vser=1.55 Voff=1.23 )\nS14 b out a a mVSWITCH13\n.tran 2.76m 0.102 uic\n",
      1e-4);
  CHECK(run.answer.outcome == engine::Outcome::no_solution);
  CHECK(run.answer.id == "E-step");
}

// Fast parts settle within femtoseconds; D7's voltage then is 10⁻¹⁹ V, of either sign, and was asked for anew at each time constant of the run.
TEST_CASE("a guard of rounding that is negative where no event was found is at rest", "[regression]") {
  const DeckRun run = run_text(R"(femtoseconds
.param p1=1.07
.param p2 =1.98
.param p3={!(atan2(367m,p2)) + 1}
V1 b 0 SIN(0 4.97e+03 56.5Meg) Rser=982k
C2 a 0 1.07e-14
C3 b 0 1.88e-14
.model mNMOS4 NMOS( Kp=50u )
M5 0 a b mNMOS4 W=10u
.model mD6 D Ron=0.488
D7 b 0 mD6
.model mSW8 SW( Ron=0.651 Vser=-687 Vh=2.7 )
M10 0 a b mNMOS4 m=2
H12 a 0 C2 -0.188
.subckt sub4 t0
R16 t0 0 3.87e+04
.model mPMOS17 PMOS( Rd=1 W=10u )
M18 t0 t0 m mPMOS17 AD=1p
.subckt sub5 t0 params: w=1
V19 t0 0 PULSE(0 1.76k 25.7n 1.55e-09 0 2.32e-08 0)
.subckt sub6 t0 t1 t2
.ends
.ends
X1008 m sub5 w={p3/(1.31)}
.ends
X1009 a sub4
.tran 3.18e-09 1.36e-07 1.14e-08 3.18e-09
)");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  constexpr std::uint64_t many_intervals = 100'000;  // there were 10⁸
  CHECK(run.answer.statistics.steps < many_intervals);
}

// L1 drives 8.07 mA through 617 kΩ into C2 until it ends: q = A (e^{s₁t} − e^{s₂t}), L s² + R s + 1/C = 0, i = q' = 0 at t = ln(s₂/s₁)/(s₁ − s₂), 17 time constants of the
// fast decay. What is left of i then was known to 10⁻⁸ of the decay only, with the wrong sign, and the current went on backwards.
TEST_CASE("a current that ends long after its decay ends", "[regression]") {
  const DeckRun run = run_text(R"(late end
D1 n1 0 DI
L1 n1 n3 0.00567 ic=-0.00807
C1 n5 n4 2.21e-06 ic=0
R1 n2 0 617000
C2 n5 n2 3.88e-07 ic=0
D4 n5 n3 DI
.model DI D
.save i(L1) v(n5,n2)
.tran 0.0001288659793814433 0.01288659793814433 uic
.end
)");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.certificate.complementarity < 1e-13);
  REQUIRE(run.rows.size() > 2);
  CHECK(run.rows[1][1] == 0.0);
  const long double i0 = 0.00807L, l = 0.00567L, r = 617000.0L, c = 3.88e-7L;
  const long double fast = -r / (2 * l) - std::sqrt(r * r / (4 * l * l) - 1 / (l * c)), slow = 1 / (l * c) / fast;
  const long double t = std::log(slow / fast) / (fast - slow), q = i0 / (fast - slow) * (std::exp(fast * t) - std::exp(slow * t));
  CHECK(run.rows[1][2] == Approx(static_cast<double>(-q / c)).epsilon(1e-12));
}

// While the charge of the stages evens out in 10⁻¹⁰ s, a guard leaves zero by its slow motion, whose second derivative a norm bounds 10⁷ times too high.
TEST_CASE("a guard that leaves zero beside decays is enclosed by few intervals", "[regression]") {
  const DeckRun run = run_text(R"(multiplier
V1 s 0 SIN(0 309 10700 0 0 0)
R1 s a0 38
C1 a0 a1 2.18e-07 ic=0
D1 0 a1 DX0
C2 0 b1 1.29e-07 ic=0
D2 a1 b1 DX0
C3 a1 a2 1.29e-07 ic=0
D3 b1 a2 DX0
C4 b1 b2 1.29e-07 ic=0
D4 a2 b2 DX0
C5 a2 a3 1.29e-07 ic=0
D5 b2 a3 DX0
C6 b2 b3 1.29e-07 ic=0
D6 a3 b3 DX0
R2 b3 0 360000
.model DX0 D(Ron=0.00131 Vfwd=1)
.model SX1 SW(Ron=0.00125 Vt=0.5)
.tran 2.328e-05 0.0009312 uic
.save v(a0,a1) v(0,b1) v(a1,a2) v(b1,b2) v(a2,a3) v(b2,b3)
.end
)");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.remarks.empty());
  constexpr std::uint64_t many_intervals = 1000;  // there were 5,788
  CHECK(run.answer.statistics.steps < many_intervals);
}

// Whenever a bridge begins its dead time, the rectifier's next diode conducts by way of a mode in which both block: what followed so is remembered.
TEST_CASE("what follows by way of another mode is not searched for again", "[regression]") {
  const DeckRun run = run_text(R"(llc
Vg0 g0 0 PULSE(0 1 1.398e-05 4.9e-09 4.9e-09 2.2815e-05 4.9e-05)
Vg1 g1 0 PULSE(0 1 3.848e-05 4.9e-09 4.9e-09 2.2815e-05 4.9e-05)
V1 in 0 325
S1 in sw g0 0 SX1
D1 sw in DX0
S2 sw 0 g1 0 SX1
D2 0 sw DX0
C1 sw r 2.1e-07 ic=0
L1 r p 0.00026 ic=0
L2 p 0 0.00202 ic=0
L3 sa 0 2.39996e-05 ic=0
L4 0 sb 2.39996e-05 ic=0
D3 sa out DX0
D4 sb out DX0
C2 out 0 0.000174 ic=0
R1 out 0 2.14
K1 L2 L3 L4 0.995
.model DX0 D(Ron=0.00754 Roff=1000000000000 Vfwd=0.85)
.model SX1 SW(Ron=0.00754 Vt=0.5)
.tran 2.3912e-05 0.00095648 uic
.save v(sw,r) i(L1) i(L2) i(L3) i(L4) v(out,0)
.end
)");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  constexpr std::uint64_t many_pivots = 250;  // there were 820
  CHECK(run.answer.statistics.lcp_pivots < many_pivots);
}

// At the start longer Euler steps find no position, and in shorter ones S14 finds no rest: those were taken for made, and the process ended.
TEST_CASE("a switch without rest where longer steps have no position ends the run with a message", "[regression]") {
  const DeckRun run = run_text_sparse(R"(no rest
.param p2=501m
V1 0 out EXP(152p 54.5 733n 3.04e-06) Rser=52.7k
.model mD2 D( )
D3 a 0 mD2
C4 b a 1.2e-10
V5 out 0 EXP(210 177 1.52u 1.43e-06)
C6 0 in 2.65e-10
R7 out n1 594
X9 n1 out b 0 xfmr
R10 b in 179k Rser=256k Cpar=82.5p
H11 n1 out V5 0.455
R12 a 0 1.24k
.model mSW13 SW( Vt=-101 Vh=1.69 )
S14 a out a b mSW13
.tran 7.08u uic
)",
                                      1e-6);
  CHECK(run.answer.outcome == engine::Outcome::no_solution);
}

// The thyristor is fed by what it conducts: each step of more than 10⁻¹³ s has no position, and a run of 0.2 ms took 10⁹ of them.
TEST_CASE("steps that are short because longer ones have no position are given up", "[regression]") {
  const DeckRun run = run_text_sparse(R"(no position
V1 0 a PULSE(0 49.7 0 0 0 0.0214 0) Rser=850
C2 0 a C=4.05u
.model mD3 D( )
G5 0 a a 0 5.6
D8 b o7 mD3
X6 a a o7 thyristor ih=10m
.subckt sub1 t0 t1
.param p2=2.2
.param p3 =0.736
R10 t1 0 R={3.82e+03*p2}
R11 m t0 10.3k
.subckt sub5 t0 t1 t2 params: w=1
C12 t0 t1 C=1.64e-06
C13 t2 t0 25.8u
V14 t1 0 SIN(25.8 4.92 84.1 28.1m 18.6 -141 5) Rser=7.62e+03
.model mCSW17 CSW( Lser=0.824 Vser=-18.5 )
W18 t2 t1 V14 mCSW17
.subckt sub6 t0
.ends
.ends
X1009 t1 0 t0 sub5 w={gauss(0.1)+p3}
.ends
X1010 o7 o7 sub1
.tran
+ 1e-5 0.0002 uic
.probe i(C2)
)",
                                      1e-4);
  CHECK(run.answer.outcome == engine::Outcome::no_solution);
  CHECK(run.answer.id == "E-step");
}
