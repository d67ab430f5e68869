/// Decks by exact segments (`--engine krylov`), against the same references as the exact engine.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"
#include "regression/reference.hpp"

using namespace pwlsim::test;

namespace {

constexpr double segments_bound = 3e-8;  ///< of a signal's largest value
constexpr const char* case_of_several_solutions = "case08";

void check_deck(const std::filesystem::path& deck) {
  if (deck.stem() == case_of_several_solutions) return;
  INFO(deck.stem().string());
  const DeckRun run = run_deck_segments(deck);
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  CHECK(worst_error(run, read_reference(deck.stem().string())) <= segments_bound);
}

/// Two three-phase bridges in series, a sixth of a half period apart, with filters of the orders 5, 7 and 11 at each phase. `first`: phase of the first source, degrees; `filter_pi`: for the filters' inductances.
std::string filtered_bridges(int first, double filter_pi) {
  std::string deck = "filtered bridges\n";
  for (const int bridge : {0, 1})
    for (const int phase : {0, 1, 2}) {
      const std::string at = fmt::format("{}_{}", bridge, phase);
      deck += fmt::format("V{0} s{0} m{1} SIN(0 325 50 0 0 {2})\nR{0} s{0} t{0} 0.05\nL{0} t{0} a{0} 1m ic=0\n", at, bridge,
                          30 * bridge - 120 * phase + first);
      for (const int order : {5, 7, 11}) {
        const double c = 1e-4 / order, turning = 2.0 * filter_pi * 50.0 * order;
        deck += fmt::format("C{0}_{1} a{0} f{0}_{1} {2} ic=0\nRF{0}_{1} f{0}_{1} g{0}_{1} 0.1\nLF{0}_{1} g{0}_{1} w{3}_{1} {4} ic=0\n", at,
                            order, c, bridge, 1.0 / (turning * turning * c));
      }
      deck += fmt::format("DP{0} a{0} d{1} DI\nDN{0} {2} a{0} DI\n", at, bridge, bridge == 0 ? "0" : "d0");
    }
  return deck +
         "RM0 m0 0 1meg\nRM1 m1 d0 1meg\nLD d1 o 2m ic=0\nCD o 0 500u ic=900\nRD o 0 40\n"
         ".save v(o) i(LD) i(L0_0)\n.tran 80u 0.04 uic\n.model DI D\n";
}

/// Two bridges in series on two stars of sources, a twelfth of a period apart.
std::string twelve_pulse(char at, double volts, double hertz, const std::string& leakage, const std::string& smoothing,
                         const std::string& diode) {
  std::string deck;
  int source = 0, number = 0;
  for (const int star : {0, 1})
    for (const int phase : {0, 1, 2}) {
      const std::string node = fmt::format("{}{}_{}", at, star, phase);
      deck += fmt::format("V{0}{1} s{2} m{0}{3} SIN(0 {4} {5} 0 0 {6})\nL{0}{1} s{2} p{2} {7} ic=0\n", at, source, node, star, volts, hertz,
                          -120 * phase - 30 * star, leakage);
      ++source;
      deck +=
          fmt::format("D{0}{1} p{2} {3} D{0}\nD{0}{4} {5} p{2} D{0}\n", at, number, node,
                      star == 0 ? fmt::format("d{}", at) : fmt::format("e{}", at), number + 1, star == 0 ? fmt::format("e{}", at) : "0");
      number += 2;
    }
  return deck + fmt::format("LF{0} d{0} o{0} {1}\n.model D{0} D({2})\n", at, smoothing, diode);
}

}  // namespace

TEST_CASE("decks of netlists/ agree with their references by Krylov segments", "[regression]") {
  check_deck(GENERATE(from_range(decks_in("netlists"))));
}

TEST_CASE("hard cases agree with their references by Krylov segments", "[hard]") {
  check_deck(GENERATE(from_range(decks_in("tests/hard"))));
}

// The exact engine's rows are within 1e-12 of closed forms (paper_test.cpp). What continues in several ways is left out.
TEST_CASE("decks of the paper agree with dense modes by Krylov segments", "[regression]") {
  constexpr double agreement = 1e-9;
  for (const auto& deck : decks_in("netlists/paper")) {
    if (deck.stem() == "relay_wrong") continue;
    INFO(deck.stem().string());
    const DeckRun dense = run_deck(deck), segments = run_deck_segments(deck);
    REQUIRE(dense.answer.outcome == pwlsim::engine::Outcome::completed);
    REQUIRE(segments.answer.outcome == pwlsim::engine::Outcome::completed);
    CHECK(segments.answer.statistics.events == dense.answer.statistics.events);
    REQUIRE(segments.rows.size() == dense.rows.size());
    for (std::size_t i = 0; i < dense.rows.size(); ++i)
      for (std::size_t k = 1; k < dense.rows[i].size(); ++k)
        CHECK(std::abs(segments.rows[i][k] - dense.rows[i][k]) <= agreement * std::max(1.0, std::abs(dense.rows[i][k])));
  }
}

// The fall of each pulse is cut off at the end of its period, 1 ps before its own, and jumps by 4 nV: 200 edges. The rise and the fall are 1 ps apart, which for implicit steps over 100 ms is one instant.
TEST_CASE("corners of a source that are a picosecond apart are two by Krylov segments", "[regression]") {
  const std::string deck = "corners\nV1 a 0 PULSE(0 1 0 .25m .25m 1p .5m)\nR1 a b 1\nC1 b 0 1u\n.save v(b)\n.tran 1m 100m uic\n";
  for (const DeckRun& run : {run_text(deck), run_text_segments(deck)}) {
    REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
    CHECK(run.answer.statistics.events == 200);
  }
}

// At most 10⁻⁷ A within 100 ns, beside which 10¹⁵ A, which `time` reaches later, left seven digits (E-certificate). Beside dense modes, which share no vector with the segments.
TEST_CASE("time counts by what it reaches within a run by Krylov segments", "[regression]") {
  const std::string deck =
      "ramp\nB1 0 x I={time}\nC1 x 0 1n\nR1 x y 1k\nL1 y z 1m\nR2 z 0 100\nD1 x w DX\nR3 w 0 10\n.model DX D\n.save v(x) v(z) i(D1)\n"
      ".tran 1n 100n uic\n";
  const auto [modes, segments] = run_both(deck);
  CHECK(largest_difference(modes, segments) <= 1e-9);
}

// A buck under peak-current control whose clock sets its latch at the instant at which the run ends: in what was left of it, 0 s, signs were rounding (E-singular). The last row is of what follows: the
// switch is closed, v(sw) = Vin.
TEST_CASE("a run by Krylov segments may end where a switch closes", "[regression]") {
  const std::string deck =
      "peak current\nVin in 0 12\nVclk clk 0 PULSE(0 1 0 0 0 0.2u 10u)\nVctl ctl 0 3.5\nH1 sense 0 Vs 1\n"
      "B1 latch 0 V={if(V(clk)>0.5,1,0)-if(V(sense)>V(ctl),1,0)}\nS1 in sw latch 0 SX\nD1 0 sw DX\nVs sw coil 0\nL1 coil out 20u\n"
      "C1 out 0 100u\nR1 out 0 3\n.model SX SW(Ron=0 Vt=0 Vh=0.5)\n.model DX D\n.save v(sw)\n.tran 20n 50u uic\n";
  const DeckRun run = run_text_segments(deck);
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  CHECK(run.rows.back()[0] == 50e-6);
  CHECK(run.rows.back()[1] == Approx(12.0).epsilon(1e-9));
}

// `time` is a source that rises beyond any run, to 10¹⁵: voltages counted as small beside that, and guards as rounding. The relay of netlists/paper/relay.net in closed form: x = 1/4 − t + t²/2 until it
// is 0 at t = 1 − √½, where it stays until t = 1; from there (t − 1)²/2. At rest the diode to ground carries 1 mA, what is left of the 2 mA through R1: v(b) = 0.
TEST_CASE("time itself is no larger than the run by segments and by implicit steps", "[regression]") {
  const std::string relay =
      "relay\nC1 x 0 1 ic=0.25\nB1 0 x I={time}\nA1 x %i x relay\n.model relay relay(level=1)\n.save v(x)\n.tran 0.1 2 uic\n";
  const std::string diodes =
      "at rest\nB1 a 0 V={time+2}\nR1 a b 1k\nD1 b 0 DX\nD2 0 b DX\nR2 b c 1k\nV2 c 0 -1\n.model DX D\n.save v(b)\n.tran 1n 2n\n";
  const auto check = [](const DeckRun& run, const auto& expected, double most) {
    INFO(run.answer.id << " " << run.answer.message);
    REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
    for (const auto& row : run.rows) CHECK(std::abs(row[1] - expected(row[0])) <= most);
  };
  const auto x = [](double t) { return t < 1.0 - std::sqrt(0.5) ? 0.25 - t + 0.5 * t * t : t < 1.0 ? 0.0 : 0.5 * (t - 1.0) * (t - 1.0); };
  check(run_text_segments(relay), x, 1e-11);
  check(run_text_sparse(relay, 1e-6), x, 1e-5);
  const auto rest = [](double) { return 0.0; };
  check(run_text_segments(diodes), rest, 1e-11);
  check(run_text_sparse(diodes, 1e-6), rest, 1e-11);
}

// A compensator of picofarads beside 100 uF, which has 10^4 times its root of energy: an amplifier of 10^4 reads what a tolerance of energy alone does not see, and rows were 9e-8 off.
TEST_CASE("what an amplifier reads has the digits of its own size by Krylov segments", "[regression]") {
  const std::string deck =
      "type III\nV1 in 0 12\nS1 in sw g 0 SM\nD1 0 sw DM\nL1 sw out 10u Rser=10m\nC1 out 0 100u Rser=20m\nR1 out 0 1\n"
      ".model SM SW(Ron=10m Roff=10Meg Vt=0.5)\n.model DM D(Ron=10m Roff=10Meg Vfwd=0.4)\nR2 out fb 10k\nC3 out x 1n\nR3 x fb 1k\n"
      "R4 fb 0 10k\nVref ref 0 2.5\nE1 ctl 0 VALUE={limit(1e4*(V(ref)-V(fb)),0,1.8)}\nC4 ctl y 2.2n\nR5 y fb 10k\nC5 ctl fb 100p\n"
      "V3 saw 0 PULSE(0 2 0 1.99u 0.01u 0 2u)\nB1 g 0 V=if(V(ctl)>V(saw),1,0)\n.tran 1u 200u uic\n";
  const auto [modes, segments] = run_both(deck);
  CHECK(largest_difference(modes, segments) <= 1e-9);
}

// Between pulses the port of abs is at zero on either side, to rounding of the source: 398 more events were told.
TEST_CASE("a port that changes sides at zero is no event by Krylov segments", "[regression]") {
  const std::string deck = "abs of a pulse\nV1 a 0 PULSE(0 5 0 1n 1n 5u 10u)\nB1 x 0 V=abs(V(a))*2\n.save v(x)\n.tran 1m 10m\n";
  const auto [modes, segments] = run_both(deck);
  CHECK(segments.answer.statistics.events <= modes.answer.statistics.events);
}

// A relay that drives a tank: in the position in which it would hold v(o) at zero, two integrations away, steps of 10⁻¹⁵ s move v(o) by less than rounding of the matrix, which made it singular; it was
// taken for one that holds (E-certificate). Beside dense modes, which share no equations with the segments.
TEST_CASE("a position that a constraint two integrations away decides is no shorter than its digits by Krylov segments", "[regression]") {
  const std::string deck =
      "relay\nA1 o x REL\n.model REL relay(level=-2)\nL1 x n 1.25m\nR1 n o 10\nC1 o 0 6.25u ic=6.474\n.save v(o) i(L1)\n.tran 1u 1m uic\n";
  const auto [modes, segments] = run_both(deck);
  CHECK(segments.answer.statistics.events == modes.answer.statistics.events);
  CHECK(largest_difference(modes, segments) <= 1e-9);
}

// All of what is behind the block's output is empty, and ground alone ties it to the rest, but the block drives it: v(c) = 1 − e^(−t/RC). It stayed at zero.
TEST_CASE("a part that is driven from elsewhere is not at rest by Krylov segments", "[regression]") {
  const std::string deck =
      "driven\nV1 a 0 PULSE(0 12 0)\nA1 a b H\n.model H hyst(in_low=1 in_high=1)\nR1 b c 100\nC1 c 0 1u\n.save v(b) v(c)\n.tran 10u 500u\n";
  const DeckRun run = run_text_segments(deck);
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  for (const auto& row : run.rows) {
    CHECK(row[1] == Approx(1.0));
    CHECK(row[2] == Approx(1.0 - std::exp(-row[0] / 100e-6)).margin(1e-12));
  }
}

// Clock and data are one sinusoid above 0.1, so that data is low before each edge of the clock. Where rounding put data first the flip-flop went high.
TEST_CASE("controls that pass at one instant change together by Krylov segments", "[regression]") {
  const std::string deck =
      "together\nB1 d 0 V={u(sin(1571*time)-0.1)}\nB2 c 0 V={u(sin(1571*time)-0.1)}\nA1 d 0 c 0 0 0 q 0 DFLOP\n.save v(q)\n"
      ".tran 100u 20m\n";
  const DeckRun run = run_text_segments(deck);
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  for (const auto& row : run.rows) CHECK(row[1] == Approx(0.0).margin(1e-9));
}

// A current begins with the square of time, where rounding of its derivatives at the start hides it: of 48 events 8 were not told.
TEST_CASE("a diode whose current begins slowly is an event by Krylov segments", "[regression]") {
  const auto [modes, segments] = run_both(filtered_bridges(7, std::numbers::pi));
  CHECK(segments.answer.statistics.events >= modes.answer.statistics.events);
  CHECK(largest_difference(modes, segments) <= 1e-9);
}

// As two diodes in series carry one current, they turn on together. The second one's voltage stands behind a leak of 1 MOhm at a star point, whose row is 10^9 and reads a decay of 1 ns: rounding of that
// decay was 8 mV of noise, within which it stayed off for 27 ns, and the run ended in E-certificate (4.5e-6).
TEST_CASE("a decay that is over does not hide a diode behind a floating leak by Krylov segments", "[regression]") {
  const auto [modes, segments] = run_both(filtered_bridges(0, 3.14159265358979));
  CHECK(segments.answer.certificate.complementarity <= 1e-9);
  CHECK(largest_difference(modes, segments) <= 1e-9);
}

// A thyristor without a gate pulse keeps conducting while it carries a current: (12 − v(k))/3.22 by Ohm's law, as R1 and R2 are in series with it. Where the transistor of the boost cell beside it closed, the
// first position looked at had the cell's diode on a wrong side, and the thyristor's current as well: its latch was opened, and i(V2) stayed at zero, 0.4 of the current of D3 off, without an error.
TEST_CASE("a latch is not opened by what flows while a diode is on a wrong side by Krylov segments", "[regression]") {
  const std::string deck =
      "latch\nV1 a 0 12\nVg g 0 SIN(0.35 1 8)\nL1 a x 1.927\nX1 x g 0 mosfet ron=20m\nD1 x o DI\nC1 o 0 0.2457\nV2 s 0 PULSE(0 12 0.0125)\n"
      "Vt t m PULSE(0 1 0.01862 0 0 0.125)\nR1 s r 2.22\nX2 r m t thyristor\nR2 m k 1\nC2 k 0 0.01216\nR3 k 0 28.27\nD2 o p DI\nD3 p k DF\n"
      ".save v(k) i(V2) i(D3)\n.tran 4.739m 1\n.model DF D(Ron=20m Vfwd=0.7)\n.model DI D\n";
  const auto [modes, segments] = run_both(deck);
  CHECK(segments.answer.statistics.events == modes.answer.statistics.events);
  CHECK(largest_difference(modes, segments) <= 1e-9);
  const std::vector<double>* row = segments.row_at(0.37912);
  REQUIRE(row != nullptr);
  CHECK((*row)[2] == Approx(-(12.0 - (*row)[1]) / 3.22).epsilon(1e-9));
}

// Nothing hangs at o, so that no current flows: C1 keeps its voltage and v(n) = v(s) - v(C1), by Kirchhoff's laws. Rounding of the current charged it by 10⁻² V within 20 ms (10⁻⁹ of it with 5 V), without an
// error. In the third deck R2 and I1 hang on C1 and go with it: v(p) = v(n) + 1 V.
TEST_CASE("what carries no current is not charged by rounding by Krylov segments", "[regression]") {
  const auto [card, charge] = GENERATE(table<std::string, double>({{"", 0.0}, {" ic=5", 5.0}, {"\nR2 p n 1k\nI1 n p 1m\n*", 0.0}}));
  const std::string deck =
      "ends\nV1 s 0 SIN(0 12 150) Rser=0.1\nR1 n m 10m\nD1 m o DI\n.model DI D\n.save v(n) v(*)\n.tran 0.2m 20m uic\nC1 s n 0.492u" + card +
      "\n";
  const DeckRun run = run_text_segments(deck);
  INFO(deck << run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  const auto column = [&](const std::string& name) {
    const auto found = std::find(run.signals.begin(), run.signals.end(), name);
    return found == run.signals.end() ? std::size_t{0} : static_cast<std::size_t>(found - run.signals.begin()) + 1;
  };
  const std::size_t n = column("v(n)"), s = column("v(s)"), p = column("v(p)");
  REQUIRE(n * s != 0);
  for (const auto& row : run.rows) {
    CHECK(row[s] - row[n] == Approx(charge).margin(1e-11));
    if (p != 0) CHECK(row[p] - row[n] == Approx(1.0).margin(1e-10));
  }
}

namespace {

/// Of the first signal at these times.
struct Known {
  double time, value;
};

void check_first_signal(const std::string& deck, const std::vector<Known>& known, double margin) {
  const auto run = run_text_segments(deck);
  INFO(deck << run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  for (const auto& [time, value] : known) {
    INFO("t = " << time);
    const std::vector<double>* row = run.row_at(time);
    REQUIRE(row != nullptr);
    CHECK((*row)[1] == Approx(value).margin(margin));
  }
}

}  // namespace

// A relay holds v(o) at zero until, 2 ps after D1 begins to conduct, that takes it to its lower limit; the current of D1 rises with 5 ns. With three vectors its voltage was 4 kV beyond that limit
// at once, which was taken for a sign. Numbers: Kirchhoff's equations of the three phases, by matrix exponentials with 40 digits.
TEST_CASE("a voltage that few vectors do not know is no sign", "[regression]") {
  check_first_signal(
      "t\nV1 s 0 PWL(0 0 10u 1 40u 4)\nD1 s n DX\nC1 n o 0.5u\nA1 o x REL\nL1 x m 2m Rpar=100k\nR1 m o 10\nC2 o 0 10u\nR2 o 0 100\n"
      ".model REL relay(level=-2)\n.model DX D(Ron=10m Vfwd=0.6)\n.save v(o)\n.tran 10u 40u\n",
      {{0.0, 0.0}, {10e-6, 0.0182229788274505}, {20e-6, 0.0570037108971769}, {40e-6, 0.106578155303234}}, 1e-10);
}

// A relay that passes zero at 8.84 µs. In a sliding motion, which it does not have there, it would begin at −600 V: it begins at zero in passive networks only. Numbers: as above, two phases.
TEST_CASE("a relay that cannot slide switches by Krylov segments", "[regression]") {
  check_first_signal(
      "t\nI1 0 o 0.2\nA1 o x REL\nL1 x m 0.333m\nR1 m o 10\nC1 o 0 1.667u Rser=10m ic=-1\nR2 o 0 100\n.model REL relay(level=2)\n.save "
      "v(o)\n"
      ".tran 10u 40u uic\n",
      {{10e-6, 0.116233508347294}, {20e-6, 1.25369632565293}, {40e-6, 3.45784176620171}}, 1e-10);
}

// A current that is cut off behind 1 GΩ is a voltage of 5 GV for 0.3 ns, beside which D1 counted as nothing: it turns off with that current, and on again at 30.5 µs. Numbers: as above, three phases.
TEST_CASE("a diode is looked at when a decay is over that hides it", "[regression]") {
  check_first_signal(
      "t\nC1 a 0 0.9m ic=35.486\nR1 a 0 440\nD1 a o DF\nC2 o 0 17m Rser=10m ic=34.92\nR2 o 0 3\nL1 x o 0.28 ic=-4.9\nD2 0 x DX\n"
      ".model DF D(Ron=20m Vfwd=0.7)\n.model DX D(Roff=1G Vfwd=0.4)\n.save v(a)\n.tran 1m 10m uic\n",
      {{1e-3, 34.8726111005477}, {5e-3, 32.4104150728745}, {10e-3, 29.5805934240305}}, 1e-9);
}

// .ic holds 5 V across an inductor, which only steps of 10¹⁴ time constants find singular: there is no operating point, and all begins at zero. L2 then takes 5 A·(1 − exp(−t/4 s)) from 10 ms on.
TEST_CASE("a voltage that .ic holds across an inductor is no contradiction", "[regression]") {
  check_first_signal(
      "t\nV1 s 0 12\nL1 s x 0.5\nD1 x o DI\nR1 o 0 1k\nV2 p 0 PULSE(0 5 10m)\nR2 p q 1\nL2 q 0 4\nL3 b f 16\nK1 L2 L3 1\nD2 b o DR\n"
      ".ic v(x)=7\n.model DI D\n.model DR D(Ron=10m Roff=10Meg)\n.save i(L2)\n.tran 10m 100m\n",
      {{0.0, 0.0}, {20e-3, -5.0 * std::expm1(-0.0025)}, {0.1, -5.0 * std::expm1(-0.0225)}}, 1e-10);
}

// A diode of a small pump beside 100 V across 0.5 Ω is on for 0.1 ms and blocks for good. What hid that was the noise of its guard by norms, 5·10² times what the guard is measured against: v(n) at the end was
// 2·10⁻⁴ off, without an error. By matrix exponentials in 40 digits.
TEST_CASE("a decay does not hide the diode of a pump beside large currents by Krylov segments", "[regression]") {
  check_first_signal(
      "pump\nVs s 0 PWL(0 0 0.1m 0 0.3m 12)\nC1 s n 0.26u Rser=10m\nD1 n o DI\nC2 o 0 7u\nR1 n 0 33Meg\nC3 o h 0.44u ic=-100\nV2 p 0 100\n"
      "D2 p h DI\nC4 h 0 1.5m ic=100\nR4 h 0 0.5\n.model DI D\n.save v(n)\n.tran 0.1m 2m uic\n",
      {{2e-3, 0.405114371974389}}, 1e-9);
}

// v(a) is a pulse with edges of 1 ns that is at zero in each row, v(b) a sinusoid: the row is −2 sin 2π50t.
TEST_CASE("a ramp that ends soon does not hide what is beside it by Krylov segments", "[regression]") {
  const DeckRun run = run_deck_segments(PWLSIM_SOURCE_DIR "/tests/golden/foreign_cards.net");
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  const auto signal =
      static_cast<std::size_t>(std::find(run.signals.begin(), run.signals.end(), "par('v(a)-2*v(b)')") - run.signals.begin());
  REQUIRE(signal < run.signals.size());
  REQUIRE(run.rows.size() == 11);
  for (const auto& row : run.rows) CHECK(row[1 + signal] == Approx(-2.0 * std::sin(100.0 * std::numbers::pi * row[0])).margin(1e-11));
}

namespace {

/// A hysteretic buck converter whose output is tied to 140 V of two rectified phases. Between both hangs a SEPIC converter.
std::string hysteretic_buck(const char* values) {
  return fmt::format(
      "hysteretic buck\n{}\nVR ref 0 5\nS1 in sw ref out SH\nD1 0 sw DI\nVb pb 0 SIN(0 170 60 0 0 120)\nDa pa bus DI\nDb pb bus DI\n"
      "RY bus q 10\nLi q d 100u\nS2 d 0 g 0 SM\nCs d x 10u\nL2 x 0 100u\nD2 x o DM\nCo o 0 47u\nRo o 0 12\nVg g 0 PULSE(0 5 0 1n 1n 5u "
      "10u)\n"
      ".model DI D\n.model SH SW(Ron=0 Vt=0 Vh=25m)\n.model SM SW(Vt=2.5 Ron=1m Roff=1Meg)\n.model DM D(Ron=1m Roff=1Meg)\n"
      ".save v(out) i(L1) v(bus)\n.tran 2u 0.4m uic\n",
      values);
}

}  // namespace

// In the position with the switch open and its diode off the current is zero, and with it the voltage across the capacitor's resistance: that closed the switch again. The first ended in an error, in the second the
// switch closed at 0.295 ms, 13 mA before the threshold, without one. Each event carries on the error of the last: rows move by 10⁴ times what the bus does.
TEST_CASE("a switch whose opening leaves a current to a diode stays open by Krylov segments", "[regression]") {
  constexpr double agreement = 1e-7;
  const auto* const values =
      GENERATE("V1 in 0 12\nL1 sw out 47u\nC1 out e 100u\nRE e 0 50m\nR1 out 0 2.5\nRX out bus 1k\nVa pa 0 SIN(0 170 60)\nCb bus 0 297u",
               "V1 in 0 16.2765\nL1 sw out 22.6647u\nC1 out e 45.6057u\nRE e 0 50.3321m\nR1 out 0 2.76192\n"
               "RX out bus 101.421\nVa pa 0 SIN(0 233.431 60)\nCb bus 0 30.8027u");
  const BothRuns runs = run_both(hysteretic_buck(values));
  CHECK(runs.segments.answer.statistics.events == runs.modes.answer.statistics.events);
  CHECK(largest_difference(runs.modes, runs.segments) <= agreement);
}

// A space of all 32 states holds every motion of them; one of fewer takes a vector for each 0.7 radians of the fastest (2/sqrt(LC) = 63 radians per µs) and some twelve more, so that a
// segment of 40 radians takes one a radian. Lengths failed again and again with a step that the position had for far shorter ones: eight a radian.
TEST_CASE("a line without loss takes few vectors by Krylov segments", "[regression]") {
  constexpr double agreement = 1e-9, henries = 1e-6, farads = 1e-9, stop = 50e-6, most_of_a_radian = 2.0;
  constexpr int sections = 16;
  std::string deck = "line\nV1 x0 0 1\n";
  for (int k = 1; k <= sections; ++k) deck += fmt::format("L{0} x{1} x{0} {2}\nC{0} x{0} 0 {3}\n", k, k - 1, henries, farads);
  deck += fmt::format("D1 x{} c DI\nVC c 0 0.8\n.model DI D(Ron=10m Roff=1meg Vfwd=0.7)\n.tran 1u {} uic\n", sections, stop);
  const BothRuns runs = run_both(deck);
  CHECK(largest_difference(runs.modes, runs.segments) <= agreement);
  CHECK(runs.segments.answer.statistics.klu_solves <= most_of_a_radian * stop * 2.0 / std::sqrt(henries * farads));
}

// The same beside slow stores. A step γ for a length of 16 γ that turns the line by more than a radian takes all 40 vectors for five radians; and currents between capacitors and sources lose digits with each vector,
// whatever the length of the segment, which was made again 32 times as short for that. With γ of half a radian, and without the vectors that have no digits, a segment has 30 to 35 radians, in two steps.
TEST_CASE("a line without loss has long segments beside slow stores", "[regression]") {
  constexpr double agreement = 1e-9, henries = 1e-6, farads = 1e-9, stop = 50e-6, most_of_a_radian = 2.0, least_of_a_step = 15.0;
  constexpr int sections = 20;
  const auto* const beside = GENERATE(  // a multiplier, and a grid behind a rectifier
      "V1 s 0 SIN(0 1 50)\nCA1 a1 s 1u ic=0.9\nCB1 b1 0 1u ic=1.8\nDA1 0 a1 DI\nDB1 a1 b1 DI\nCA2 a2 a1 1u ic=1.8\nCB2 b2 b1 1u ic=1.8\n"
      "DA2 b1 a2 DI\nDB2 a2 b2 DI\nRL b2 0 200k\nRT x10 b1 1meg\n",
      "V1 s 0 SIN(0 10 1k 0 0 180)\nRS s w 0.5\nDR w a DI\nR1 a b 1\nR2 b c 1\nR3 c d 1\nR4 d a 1\nCa a 0 1u ic=8\nCb b 0 1u ic=8\n"
      "Cc c 0 1u ic=8\nCd d 0 1u ic=8\nRG a 0 1k\nRT x10 b 10\nRU x20 c 1k\n");
  std::string deck = "line beside slow stores\nV0 x0 0 1\n";
  for (int k = 1; k <= sections; ++k) deck += fmt::format("L{0} x{1} x{0} {2}\nC{0} x{0} 0 {3}\n", k, k - 1, henries, farads);
  deck += fmt::format("D1 x{} c DI\nVC c 0 0.8\n{}.model DI D\n.tran 1u {} uic\n", sections, beside, stop);
  const BothRuns runs = run_both(deck);
  CHECK(largest_difference(runs.modes, runs.segments) <= agreement);
  const double radians = stop * 2.0 / std::sqrt(henries * farads);
  CHECK(runs.segments.answer.statistics.klu_solves <= most_of_a_radian * radians);
  CHECK(least_of_a_step * runs.segments.answer.statistics.steps <= radians);
}

// A multiplier of three stages whose diodes have 1.4 mΩ and 115 MΩ: a guard that has no sign in a short segment has one in a longer one, which must be tried also where the position refused that length before. Else a
// diode is on its wrong side, by 2·10⁻⁶ of what the certificate measures ports against.
TEST_CASE("a guard without a sign is looked at over longer segments by Krylov segments", "[regression]") {
  constexpr double agreement = 1e-9;
  const BothRuns runs = run_both(R"(multiplier
V1 s 0 SIN(0 24.7 11800)
R1 s a0 2.3
C1 a0 a1 3.59n ic=0
D1 0 a1 DX
C2 0 b1 3.59n ic=0
D2 a1 b1 DX
C3 a1 a2 2.43n ic=0
D3 b1 a2 DX
C4 b1 b2 3.59n ic=0
D4 a2 b2 DX
C5 a2 a3 3.4n ic=0
D5 b2 a3 DX
C6 b2 b3 3.59n ic=0
D6 a3 b3 DX
R2 b3 0 1.91meg
.model DX D(Ron=1.38m Roff=115meg Vfwd=0.7)
.tran 21.099u 843.96u uic
.save v(a0,a1) v(0,b1) v(a1,a2) v(b1,b2) v(a2,a3) v(b2,b3)
)");
  CHECK(largest_difference(runs.modes, runs.segments) <= agreement);
  CHECK(runs.segments.answer.certificate.complementarity <= agreement);
}

// Each diode's current is that of its 1 mOhm between capacitors, whose voltages no event moves: the rows before and after one are the same. Those after it had up to 5e-4 of a current of what then decays within a nanosecond.
TEST_CASE("a row after an event has what the segment begins with, before any decay, by Krylov segments", "[regression]") {
  constexpr double agreement = 1e-9;  ///< of the largest current
  std::string deck = "multiplier\nV1 s 0 SIN(0 100 6k)\n", currents;
  for (int k = 1; k <= 7; ++k) {
    const std::string above = k == 1 ? "s" : fmt::format("a{}", k - 1), low = k == 1 ? "0" : fmt::format("b{}", k - 1);
    deck += fmt::format("CA{0} a{0} {1} 1u ic={2}\nCB{0} b{0} {3} 1u ic=180\nDA{0} {3} a{0} DI\nDB{0} a{0} b{0} DI\n", k, above,
                        k == 1 ? 90 : 180, low);
    currents += fmt::format(" i(DA{0}) i(DB{0})", k);
  }
  deck += "RL b7 0 700k\n.model DI D(Ron=1m)\n.save" + currents + "\n.tran 20u 1m uic\n";
  const DeckRun run = run_text_segments(deck, true);
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  double largest = 0.0;
  for (const auto& row : run.rows)
    for (std::size_t k = 1; k < row.size(); ++k) largest = std::max(largest, std::abs(row[k]));
  std::size_t events = 0;
  for (std::size_t i = 1; i < run.rows.size(); ++i) {
    if (run.rows[i][0] != run.rows[i - 1][0]) continue;
    ++events;
    INFO("t = " << run.rows[i][0]);
    for (std::size_t k = 1; k < run.rows[i].size(); ++k) CHECK(std::abs(run.rows[i][k] - run.rows[i - 1][k]) <= agreement * largest);
  }
  CHECK(events == run.answer.statistics.events);
}

// The stop holds the first cart at x1 = 0: its force is 2 x1 - x2 = 1. The end of that segment, where the diode blocks, is known before the first row is written: its row was that of the position behind it.
TEST_CASE("the first row is one of the position in which the run begins by Krylov segments", "[regression]") {
  const DeckRun run = run_deck_segments(std::filesystem::path(PWLSIM_SOURCE_DIR) / "netlists/carts.net");
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  const auto force = static_cast<std::size_t>(std::find(run.signals.begin(), run.signals.end(), "i(D1)") - run.signals.begin());
  REQUIRE(force < run.signals.size());
  CHECK(run.rows.front()[1 + force] == Approx(1.0).epsilon(1e-12));
}

// Converters 540 and 651 of tests/converters, tied by kilohms: beside 31 µF the flyback converter's stores are 10⁻⁵ of the energy. Its currents were 1.3e-7 off, as the error of a segment counted by the energy of the part alone.
TEST_CASE("Krylov segments: stores with little of the energy have their digits", "[regression]") {
  constexpr double expected = 1e-9;
  const auto [modes, segments] = run_both(
      "push-pull and flyback converter\n"
      "Vg0a g0a 0 PULSE(0 1 1.5438e-06 4.69e-10 4.69e-10 1.5097e-06 4.69e-06)\n"
      "Vg1a g1a 0 PULSE(0 1 3.8888e-06 4.69e-10 4.69e-10 1.5097e-06 4.69e-06)\n"
      "V1a ina 0 400\n"
      "L1a ina aa 2.09e-06 ic=0\n"
      "L2a ba ina 2.09e-06 ic=0\n"
      "S1a aa 0 g0a 0 SX1a\n"
      "D1a 0 aa DX0a\n"
      "S2a ba 0 g1a 0 SX1a\n"
      "D2a 0 ba DX0a\n"
      "R1a aa snaa 0.409\n"
      "C1a snaa 0 1.32e-07 ic=0\n"
      "R2a ba snba 1.6\n"
      "C2a snba 0 5.48e-09 ic=0\n"
      "L3a saa 0 1.22312e-06 ic=0\n"
      "L4a 0 sba 1.22312e-06 ic=0\n"
      "D3a saa fa DX0a\n"
      "D4a sba fa DX0a\n"
      "L5a fa outa 4.8e-06 ic=0\n"
      "C3a outa 0 3.14e-05 ic=0\n"
      "R3a outa 0 0.769\n"
      "K1a L1a L2a L3a L4a 0.98\n"
      ".model DX0a D(Ron=0.0155 Roff=1000000000000 Vfwd=1)\n"
      ".model SX1a SW(Ron=0.0155 Vt=0.5)\n"
      "Vg0b g0b 0 PULSE(0 1 5.3086e-06 5.43e-08 5.43e-08 3.334e-06 5.43e-06)\n"
      "V1b inb 0 24\n"
      "L1b inb swb 0.000849 ic=0\n"
      "S1b swb 0 g0b 0 SX1b\n"
      "R1b swb snswb 18.7\n"
      "C1b snswb 0 6.33e-09 ic=0\n"
      "L2b 0 sb 0.000277779 ic=0\n"
      "D1b sb outb DX0b\n"
      "C2b outb 0 2.24e-06 ic=0\n"
      "R2b outb 0 11\n"
      "K1b L1b L2b 0.99\n"
      ".model DX0b D(Ron=0.0175 Roff=914000000000 Vfwd=1)\n"
      ".model SX1b SW(Ron=0.0175 Vt=0.5)\n"
      "Vg0c g0c 0 PULSE(0 1 1.12e-07 4.07e-08 4.07e-08 1.8823e-06 4.07e-06)\n"
      ".model SX0c SW(Ron=0.02 Roff=100000000 Vt=0.5)\n"
      ".model SX1c SW(Ron=0.02 Roff=815000000 Vt=0.5)\n"
      "Rtie1 fa tie 1.9e+03\n"
      "Rtie2 outb tie 428\n"
      "Rtie3 g0c tie 237\n"
      ".save i(L5a) v(outa) i(L1b) i(L2b) v(outb)\n"
      ".tran 2.2769e-06 9.1076e-05\n"
      ".end\n");
  CHECK(largest_difference(modes, segments) <= expected);
}

// 0.6 pA to 6 pA of a clamp beside 13 A in the same part: rounding of the largest current hid its sign, and v(l) was up to 1 V off, without a word, by segments and by implicit steps with a
// tolerance of 1e-7. Kirchhoff's laws give v(l) = min(325 V / 2, v(mid) + 0.3 V).
TEST_CASE("a clamp between leaks is decided by what they carry, not by the largest current", "[regression]") {
  const std::string deck =
      "clamp between leaks\n"
      "V1 o 0 325\n"
      "R1 o l 1e12\n"
      "R2 l 0 1e12\n"
      "D6 l mid DX\n"
      "V2 s 0 SIN(162 3 1k)\n"
      "R3 s mid 0.1\n"
      "D7 mid x DX\n"
      "R4 x 0 12\n"
      "C1 x 0 1u\n"
      ".model DX D(Ron=0 Vfwd=0.3)\n"
      ".tran 17u 3m\n"
      ".save v(l) v(mid)\n";
  constexpr double reltol = 1e-7, bound_of_segments = 1e-9;
  const auto check = [](const DeckRun& run, double bound) {
    REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
    CHECK(run.answer.statistics.events == 6);
    for (const auto& row : run.rows) {
      INFO("t = " << row[0]);
      CHECK(std::abs(row[1] - std::min(162.5, row[2] + 0.3)) <= bound * 162.5);
    }
  };
  check(run_text_segments(deck), bound_of_segments);
  check(run_text_sparse(deck, reltol), 10.0 * reltol);
}

// A flyback converter between two twelve-pulse rectifiers. Twenty vectors of one segment leave its voltages six digits, and rounding turned by 9e14 radians a second in them: all later segments of that position were made for
// it, picoseconds each, and the run took minutes.
TEST_CASE("a turning that is rounding is forgotten by Krylov segments", "[regression]") {
  constexpr double expected = 1e-9;
  constexpr std::uint64_t most_segments = 4000;
  const auto [modes, segments] = run_both("flyback converter between rectifiers\n" +
                                          twelve_pulse('a', 17.0, 50.0, "5.21e-05", "0.000139 ic=0\nCFa oa 0 0.00103 ic=0\nRFa oa 0 6.91",
                                                       "Ron=0.0351 Roff=33400000000 Vfwd=0") +
                                          "Vg g 0 PULSE(0 1 2.92e-06 0 0 2.0038e-05 3.65e-05)\n"
                                          "Vb in 0 12\n"
                                          "Lb1 in sw 0.000122 ic=0\n"
                                          "Sb sw 0 g 0 SX\n"
                                          "Rb1 sw sn 1.49\n"
                                          "Cb1 sn 0 3.75e-07 ic=0\n"
                                          "Lb2 0 s 6.06694e-06 ic=0\n"
                                          "Db s out DX\n"
                                          "Cb2 out 0 0.000403 ic=0\n"
                                          "Rb2 out 0 0.692\n"
                                          "Kb Lb1 Lb2 0.95\n"
                                          ".model DX D(Ron=0.00231 Vfwd=0)\n"
                                          ".model SX SW(Ron=0.0099 Roff=1000000 Vt=0.5)\n" +
                                          twelve_pulse('c', 325.0, 60.0, "5.98e-05", "0.00103 ic=0\nCFc oc 0 0.000469 ic=0\nRFc oc 0 14.1",
                                                       "Ron=0.0473 Roff=1000000000000 Vfwd=0.55") +
                                          "Rt0 ma1 tie 3980\n"
                                          "Rt1 sw tie 22800\n"
                                          "Rt2 pc1_1 tie 231\n"
                                          ".tran 1.18453e-05 0.00071072 uic\n"
                                          ".save v(out) v(oa) v(oc) v(tie) i(Lb1)\n");
  CHECK(segments.answer.statistics.steps < most_segments);
  CHECK(largest_difference(modes, segments) <= expected);
}

// A clamp whose other node has a milliohm: rounding of its current there hid that of the clamp, 0.3 nA, from implicit steps, and v(q) was 30 V off in 31 rows of 686. Dense modes share no equations with them.
TEST_CASE("a clamp beside a milliohm is decided by what leaks carry by implicit steps", "[regression]") {
  constexpr double reltol = 1e-8;
  const std::string deck =
      "leg of a three-level rectifier\n"
      "VA a 0 SIN(0 325 50)\n"
      "LA a x 1.2m\n"
      "RA x y 50m\n"
      "S1 p o g1 0 SW1\n"
      "D1 o p DF\n"
      "S2 o y g2 0 SW1\n"
      "D2 y o DF\n"
      "S3 y q g3 0 SW1\n"
      "D3 q y DF\n"
      "S4 q n g4 0 SW1\n"
      "D4 n q DF\n"
      "D5 m o DF\n"
      "D6 q m DF\n"
      "CP p m 470u ic=350\n"
      "CN m n 470u ic=350\n"
      "RL p n 60\n"
      "RM m 0 1m\n"
      "RS y s 47\n"
      "CS s m 4.7n\n"
      "VG1 g1 0 PULSE(0 1 0 0 0 40u 100u)\n"
      "VG3 g3 0 PULSE(1 0 0 0 0 40u 100u)\n"
      "VG2 g2 0 1\n"
      "VG4 g4 0 0\n"
      ".model SW1 SW(Ron=8m Roff=2e11 Vt=0.5)\n"
      ".model DF D(Ron=6m Vfwd=0.8)\n"
      ".tran 7.3u 5m uic\n"
      ".save v(o) v(q) v(y) v(p,n) i(LA)\n";
  const DeckRun modes = run_text(deck), steps = run_text_sparse(deck, reltol);
  REQUIRE(modes.answer.outcome == pwlsim::engine::Outcome::completed);
  REQUIRE(steps.answer.outcome == pwlsim::engine::Outcome::completed);
  CHECK(steps.answer.statistics.events == modes.answer.statistics.events);
  CHECK(largest_difference(modes, steps) <= 10.0 * reltol);
}
