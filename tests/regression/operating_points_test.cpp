/// Converters whose operating point was found or not by the order of their cards or by their values.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

bool starts_at_rest(const DeckRun& run) {
  const auto& remarks = run.answer.remarks;
  return std::none_of(remarks.begin(), remarks.end(),
                      [](const auto& remark) { return remark.id == "W-no-operating-point" || remark.id == "W-start-projected"; });
}

std::string deck(const std::vector<std::string>& cards, const std::string& rest) {
  std::string text = "t\n";
  for (const auto& card : cards) text += card + "\n";
  return text + rest;
}

}  // namespace

// Both gates are at 1 V: 12 V over S1 (1 mΩ), L1 and S2 (1 mΩ), and D2 leads the middle to 2.7 Ω: v(out) = 12·1000/(2000 + 1/2.7).
// S3 and S4 are open; their 1e12 Ω count in the 16th place.
TEST_CASE("a non-inverting buck-boost converter starts at rest in any order of its cards", "[regression]") {
  std::vector<std::string> cards = {"Vin in 0 12",    "V1 g1 0 1",  "V2 g2 0 1",     "S1 in x g1 0 SX", "D1 0 x D",         "L1 x y 7.5u",
                                    "S2 y 0 g2 0 SX", "D2 y out D", "C1 out 0 7.5u", "S3 x 0 0 g1 SY",  "S4 y out 0 g2 SY", "R1 out 0 2.7"};
  std::mt19937 random(3);
  const double expected = 12.0 * 1000.0 / (2000.0 + 1.0 / 2.7);
  constexpr double tolerance = 1e-7;  // resistances over 15 decades
  for (int run = 0; run < 20; ++run) {
    const DeckRun result = run_text(deck(cards,
                                         ".model D D\n.model SX SW(Ron=1m Roff=1e12 Vt=0.5)\n.model SY SW(Ron=1m Roff=1e12 Vt=-0.5)\n"
                                         ".save v(out) i(L1)\n.tran 1u 2u\n"));
    CAPTURE(run, result.messages, result.answer.message);
    REQUIRE(result.answer.outcome == engine::Outcome::completed);
    CHECK(starts_at_rest(result));
    CHECK(result.rows[0][1] == Approx(expected).epsilon(tolerance));
    CHECK(result.rows[0][2] == Approx((12.0 - expected) * 1000.0).epsilon(tolerance));
    std::shuffle(cards.begin(), cards.end(), random);
  }
}

// The half-bridge's switches are open, and alike: v(mid) is half of 325 V. Its time constant is 700 MΩ times 33 µF, that of the rectifier tied to it 177 µH over 1.3 MΩ.
TEST_CASE("what leaks alone decide is at rest to nine digits beside what is fast", "[regression]") {
  const std::string text =
      "t\nVg1 g1 0 PULSE(0 1 18.983u 26.2n 26.2n 12.191u 26.2u)\nVg2 g2 0 PULSE(0 1 32.083u 26.2n 26.2n 12.191u 26.2u)\nV1 in 0 325\n"
      "S1 in sw g1 0 SX\nD1 sw in DX\nS2 sw 0 g2 0 SX\nD2 0 sw DX\nR1 in cin 0.118\nC1 cin mid 33.2u\nC2 mid 0 33.2u\nL1 sw mid 6.66m\n"
      "L2 sa 0 7.48318m\nL3 0 sb 7.48318m\nK1 L1 L2 L3 0.98\nD3 sa f DX\nD4 sb f DX\nL4 f out 396u\nC3 out 0 5.89u\nR2 out 0 39.7\n"
      ".model DX D(Ron=43.8m)\n.model SX SW(Ron=1.35m Roff=702meg Vt=0.5)\n"
      "Va ps0 nn SIN(0 170 50)\nRa ps0 p0 15.5m\nVb ps1 nn SIN(0 170 50 0 0 -120)\nRb ps1 p1 15.5m\nVc ps2 nn SIN(0 170 50 0 0 -240)\n"
      "Rc ps2 p2 15.5m\nD5 p0 dp DY\nD6 0 p0 DY\nD7 p1 dp DY\nD8 0 p1 DY\nD9 p2 dp DY\nD10 0 p2 DY\nL5 dp o2 177u\nC4 o2 0 297u\n"
      "R4 o2 0 55.3\n.model DY D(Ron=2.11m Roff=1.31meg)\nR5 cin tie 7.914\nR6 ps0 tie 7.914\n.save v(mid)\n.tran 1u 2u\n.end\n";
  for (const DeckRun& run : {run_text(text), run_text_segments(text)}) {
    CAPTURE(run.messages, run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    CHECK(starts_at_rest(run));
    CHECK(run.rows[0][1] == Approx(162.5).epsilon(1e-9));
  }
}

// Half of 24 V between two open switches, which are alike. The three leaks beside inductors have ports of their own in dense modes, which conducted in the long steps that should give the point its digits.
TEST_CASE("a leak beside inductors does not conduct at the operating point that leaks decide", "[regression]") {
  const DeckRun run = run_text(
      "t\nVga ga 0 PULSE(0 1 18.321u 0 0 8.929u 18.7u)\nVgb gb 0 PULSE(0 1 27.671u 0 0 8.929u 18.7u)\nV1 in 0 24\nS1 in sw ga 0 SX\nD1 sw "
      "in DX\n"
      "S2 sw 0 gb 0 SX\nD2 0 sw DX\nR1 in cin 0.46\nC1 cin mid 51.5u\nC2 mid 0 51.5u\nL1 sw mid 207u\nL2 sa 0 8.86974u\nL3 0 sb 8.86974u\n"
      "K1 L1 L2 L3 0.98\n.model DX D(Ron=0.0197 Roff=1meg Vfwd=0.7)\n.model SX SW(Ron=0.0197 Roff=17.4meg Vt=0.5)\n"
      "V2 i2 0 5\nL4 i2 a 34.2u\nL5 b o 34.5u\nRb tie b 8580\nRs tie sb 4.81meg\nRc tie s3 134\n"
      "V3 i3 0 259\nL6 i3 s3 290u\nD3 s3 o3 DY\nR3 o3 0 49.5\n.model DY D(Ron=7.13m Roff=16.4meg Vfwd=0)\n.save v(mid)\n.tran 1u "
      "2u\n.end\n");
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(starts_at_rest(run));
  constexpr double expected = 12.0, rounding = 1e-11;  // it was 5e-8
  CHECK(run.rows[0][1] == Approx(expected).epsilon(rounding));
}

// S1 to S4 are open: v(a), and what hangs at it, leaks through 1e12 Ω. S1 and S2 carry the same current from 12 V to the load (68 Ω): v(a) is 6 V,
// but for what D2 and D3 do, which block. The flying capacitor's other end may lie between D4's 0 V and D3's v(sw) = 0 V.
TEST_CASE("a flying-capacitor converter starts at rest in any order of its cards", "[regression]") {
  std::vector<std::string> cards = {"Vin in 0 12",   "V1 g1 0 0",     "V2 g2 0 0",  "S1 in a g1 0 SX", "S2 a sw g2 0 SX",
                                    "D3 b sw D",     "D4 0 b D",      "D1 a in D",  "D2 sw a D",       "Cf a b 150n",
                                    "L1 sw out 27u", "C1 out 0 1.6u", "R1 out 0 68"};
  std::mt19937 random(4);
  for (int run = 0; run < 20; ++run) {
    const DeckRun result =
        run_text(deck(cards, ".model D D\n.model SX SW(Ron=1m Roff=1e12 Vt=0.5)\n.save v(a) v(b) v(out)\n.tran 1u 2u\n"));
    CAPTURE(run, result.messages, result.answer.message);
    REQUIRE(result.answer.outcome == engine::Outcome::completed);
    CHECK(starts_at_rest(result));
    CHECK(result.rows[0][1] == Approx(6.0).epsilon(1e-6));
    CHECK(result.rows[0][2] == Approx(0.0).margin(1e-6));
    CHECK(result.rows[0][3] == Approx(68.0 * 6e-12).epsilon(1e-6));
    std::shuffle(cards.begin(), cards.end(), random);
  }
}

// At DC the diodes of a multiplier are in series from ground to the load, and nothing but leaks flows: v(out) = 0 with a load, each column within the
// drops. Those of a Dickson pump lead from 5 V: a load of 10 kΩ sees 5 V less a drop for each diode.
TEST_CASE("multipliers and pumps start at rest at every value", "[regression]") {
  constexpr double e12[] = {1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.3, 3.9, 4.7, 5.6, 6.8, 8.2};
  std::mt19937 random(5);
  const auto value = [&](int least, int decades) {
    return e12[random() % 12] * std::pow(10.0, static_cast<double>(least) + static_cast<double>(random() % static_cast<unsigned>(decades)));
  };
  for (int run = 0; run < 60; ++run) {
    const int stages = 1 + run % 10;
    std::string text = fmt::format("t\nV1 s 0 SIN(0 10 50 0 0 {})\nRs s a {}\n", run % 3 == 0 ? 90 : -45, value(-2, 4));
    std::string bottom = "0", top = "a";
    for (int k = 0; k < stages; ++k) {
      text += fmt::format("Ca{0} {1} p{0} {3}\nDa{0} {2} p{0} D\nDb{0} p{0} q{0} D\nCb{0} {2} q{0} {4}\n", k, top, bottom, value(-10, 5),
                          value(-10, 5));
      top = fmt::format("p{}", k);
      bottom = fmt::format("q{}", k);
    }
    if (run % 2 == 0) text += fmt::format("RL {} 0 {}\n", bottom, value(2, 5));
    const char* const models[] = {"D", "D(Ron=1m Roff=1e9)", "D(Ron=1m Roff=1e12)", "D(Ron=10m Vfwd=0.6)"};
    text += fmt::format(".model D {}\n.save v({})\n.tran 1u 2u\n", models[run % 4], bottom);
    const DeckRun result = run_text(text);
    CAPTURE(text, result.messages, result.answer.message);
    const bool may_accumulate =
        run % 4 == 2;  // leaks of 10¹² Ω: built by clang, one of them does after 1.7 ns (docs/developer/open-ends.md)
    REQUIRE((result.answer.outcome == engine::Outcome::completed || (may_accumulate && result.answer.id == "E-accumulation")));
    REQUIRE(!result.rows.empty());
    CHECK(starts_at_rest(result));
    if (run % 4 == 0) CHECK(std::abs(result.rows[0][1]) < 1e-9);
  }
  for (int stages = 2; stages <= 6; ++stages) {
    std::string text = "t\nV1 in 0 5\nVc1 c1 0 0\nVc2 c2 0 3.3\n", before = "in";
    for (int k = 0; k < stages; ++k) {
      text += fmt::format("D{0} {1} n{0} D\nC{0} n{0} c{2} {3}\n", k, before, k % 2 + 1, value(-12, 6));
      before = fmt::format("n{}", k);
    }
    text += fmt::format("Do {} out D\nCo out 0 {}\nRL out 0 10k\n.model D D(Vfwd=0.6)\n.save v(out)\n.tran 1u 2u\n", before, value(-9, 3));
    const DeckRun result = run_text(text);
    CAPTURE(text, result.messages, result.answer.message);
    REQUIRE(result.answer.outcome == engine::Outcome::completed);
    CHECK(starts_at_rest(result));
    CHECK(result.rows[0][1] == Approx(5.0 - 0.6 * (stages + 1)).epsilon(1e-9));
  }
}

// At t = 0 the largest of the voltages between two lines, v(b) - v(c) = √3·162.6, is at its peak: the capacitor has it, less two drops, and nothing conducts from then on, since no line voltage
// is larger. What blocks may share the floating side's voltage in many ways.
TEST_CASE("a three-phase rectifier without a load starts in the peak of a line voltage", "[regression]") {
  const DeckRun run = run_text(R"(three-phase bridge
Va a 0 SIN(0 162.6 60)
Vb b 0 SIN(0 162.6 60 0 0 120)
Vc c 0 SIN(0 162.6 60 0 0 240)
D1 a p D
D2 b p D
D3 c p D
D4 n a D
D5 n b D
D6 n c D
C1 p n 1.98m
.model D D(Ron=26m Vfwd=0.8)
.save v(p,n) i(D1) i(D2) i(D3) i(D4) i(D5) i(D6)
.tran 0.1m 50m
.end
)");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  REQUIRE(run.rows.size() == 501);
  const double expected = std::sqrt(3.0) * 162.6 - 1.6;
  const double rounding = 1e-12 * expected;
  for (const auto& row : run.rows) {
    INFO(row[0]);
    CHECK(row[1] == Approx(expected).epsilon(0).margin(rounding));
    for (std::size_t i = 2; i < row.size(); ++i) CHECK(std::abs(row[i]) < rounding / 26e-3);
  }
}

// At rest sources do not move, and what a derivative makes of them is zero: v(n) begins at 0. From then on the low pass of τ = RC has at its input ω T cos(ωt) of 100 V, T = 50 µs:
// v(n) = A (cos ωt + ωτ sin ωt − e^{−t/τ})/(1 + ω²τ²). The same low pass of the source itself, 100 V sin ωt, whose derivative B3 takes without loading it, has
// v(m) = 100 V (sin ωt − ωτ cos ωt + ωτ e^{−t/τ})/(1 + ω²τ²).
TEST_CASE("derivatives of sources are zero at the operating point", "[regression]") {
  const std::string text =
      "t\nV1 s 0 SIN(0 100 8k)\nB2 o 0 V={ddt(v(s))*50u}\nR1 o n 500\nC1 n 0 0.2u\nR2 s m 500\nC2 m 0 0.2u\nB3 q 0 V={ddt(v(m))*50u}\nR3 q "
      "0 1k\n"
      ".save v(n) v(m) v(q)\n.tran 10u 200u\n";
  const double w = 2.0 * std::numbers::pi * 8e3, tau = 500.0 * 0.2e-6, turn = w * tau, size = 1.0 + turn * turn;
  for (const DeckRun& run : {run_text(text), run_text_segments(text)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    for (const auto& row : run.rows) {
      const double sine = std::sin(w * row[0]), cosine = std::cos(w * row[0]), decay = std::exp(-row[0] / tau);
      const double m = 100.0 * (sine - turn * cosine + turn * decay) / size;
      CHECK(row[1] == Approx(100.0 * w * 50e-6 * (cosine + turn * sine - decay) / size).margin(1e-10 * 250.0));
      CHECK(row[2] == Approx(m).margin(1e-10 * 100.0));
      CHECK(row[3] == Approx((100.0 * sine - m) / tau * 50e-6).margin(1e-10 * 100.0));
    }
  }
}

// Nothing flows at rest, so that the capacitor has the voltage of the source. It was 0 V, with W-no-operating-point, by segments and steps: with capacitors in the way 10⁻⁸ S drowned in the rounding of 700 S.
TEST_CASE("a leak that charges a capacitor through its series resistance has an operating point", "[regression]") {
  constexpr double tolerance = 1e-9;
  const char* leak = GENERATE("1meg", "100meg", "10g");
  const std::string text = fmt::format("leak\nV1 s 0 48\nR1 s c {}\nR2 c x 1.43m\nC1 x 0 78n\n.save v(x)\n.tran 1u 10u\n.end\n", leak);
  CAPTURE(leak);
  for (const DeckRun& run : {run_text(text), run_text_segments(text), run_text_sparse(text, 1e-7)}) {
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    CHECK(starts_at_rest(run));
    CHECK(run.rows.front().back() == Approx(48.0).epsilon(tolerance));
  }
}

// The same behind an open switch of 100 MΩ and an inductor; it was 5·10⁻⁴ V off, with W-op-not-unique.
TEST_CASE("a leak of a switch that charges a capacitor through its series resistance has one operating point", "[regression]") {
  constexpr double tolerance = 1e-9;
  const std::string text =
      "boost\n.model SM SW(Ron=0.0333 Roff=1e8 Vt=0.5)\n.model DM D(Ron=0.00449 Roff=1e9 Vfwd=0.3)\nV1 s 0 48\nL1 s d 149u\n"
      "S1 d 0 g 0 SM\nD1 0 d DM\nVg g 0 PULSE(0 1 1u 1n 1n 1u 3u)\nS2 c d h 0 SM\nVh h 0 0\nD2 d c DM\nR1 c x 1.43m\nC1 x 0 78n\n"
      ".save v(x)\n.tran 0.1u 0.9u\n.end\n";
  for (const DeckRun& run : {run_text(text), run_text_segments(text), run_text_sparse(text, 1e-7)}) {
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    const auto& remarks = run.answer.remarks;
    CHECK(std::none_of(remarks.begin(), remarks.end(), [](const auto& remark) { return remark.id == "W-op-not-unique"; }));
    CHECK(run.rows.front().back() == Approx(48.0).epsilon(tolerance));
  }
}

// Two phases are at 162.5 V together. One conducts, and through the other's 6.6 mOhm flows what Roff lets pass at Vfwd: 2 nV more than that turn it on. Beside 10 GOhm, held states hid them, and no mode was left.
TEST_CASE("a diode that blocks nanovolts below its threshold has an operating point", "[regression]") {
  constexpr double tolerance = 1e-9, least = 3e-7;
  const DeckRun run = run_text(
      "two phases\nV1 x n SIN(0 325 50 0 0 30)\nD1 x p DM\nV3 a n SIN(0 325 50 0 0 -210)\nR2 a y 0.006634\nD2 y p DM\nR3 n 0 1e+10\nR7 p n "
      "58.55\n"
      ".model DM D(Ron=0 Vfwd=0.3 Roff=1e+06)\n.save i(D1) i(D2)\n.tran 1e-11 5e-11\n.end\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(starts_at_rest(run));
  CHECK(run.rows.front()[1] == Approx((162.5 - 0.3) / 58.55 - least).epsilon(tolerance));
  CHECK(run.rows.front()[2] == Approx(least).epsilon(1e-4));
}
