/// Converters in closed loop: however a deck is written, the answer is the same.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "regression/closed_loops.hpp"
#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

namespace {

using namespace pwlsim;

/// Of the largest value of a signal. A loop that amplifies rounding from one period to the next loses digits.
constexpr double loop_agreement = 1e-6;
/// V and A beside 12 V: a loop that stays off shows its leaks, and their rounding.
constexpr double least_size = 1e-6;

/// Some cannot go on: a comparator without hysteresis whose switch takes it back, while the clock is high. They must end in every way of writing.
constexpr double least_completed = 0.8;

void check_loops(std::uint64_t first, std::uint64_t count, int ways) {
  std::uint64_t completed = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const test::ClosedLoop plain = test::random_closed_loop(seed, 0);
    INFO("seed " << seed << "\n" << plain.text);
    const test::DeckRun run = test::run_text(plain.text);
    REQUIRE(run.messages == "");
    const bool ends = run.answer.outcome == engine::Outcome::completed;
    if (ends) ++completed;
    for (int way = 1; way < ways; ++way) {
      const test::ClosedLoop other = test::random_closed_loop(seed, way);
      INFO("way " << way << "\n" << other.text);
      const test::DeckRun twin = test::run_text(other.text);
      REQUIRE((twin.answer.outcome == engine::Outcome::completed) == ends);
      REQUIRE(twin.rows.size() == run.rows.size());
      CHECK(test::largest_difference(run, twin, least_size) <= loop_agreement);
    }
  }
  CHECK(static_cast<double>(completed) >= least_completed * static_cast<double>(count));
}

void check_engines(std::uint64_t seed) {
  constexpr double tolerance = 1e-5, most = 1e-2;  // of implicit steps over some 200 events
  const test::ClosedLoop loop = test::random_closed_loop(seed, 0);
  INFO("seed " << seed << "\n" << loop.text);
  const test::DeckRun modes = test::run_text(loop.text), segments = test::run_text_segments(loop.text);
  const test::DeckRun steps = test::run_text_sparse(loop.text, tolerance);
  REQUIRE(modes.answer.outcome == engine::Outcome::completed);
  REQUIRE(segments.answer.outcome == engine::Outcome::completed);
  REQUIRE(steps.answer.outcome == engine::Outcome::completed);
  CHECK(test::largest_difference(modes, segments, least_size) <= loop_agreement);
  CHECK(test::largest_difference(modes, steps, least_size) <= most);
}

}  // namespace

TEST_CASE("converters in closed loop do not depend on how their decks are written", "[regression]") { check_loops(1, 60, 3); }

TEST_CASE("many converters in closed loop do not depend on how their decks are written", "[regression][long]") {
  check_loops(1000, 500, 4);
}

// Dense modes and Krylov segments share no equations. What a leak and a coupling leave of an instant's decays may stand in the row of the start.
TEST_CASE("converters in closed loop agree between dense modes and Krylov segments", "[regression]") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const test::ClosedLoop loop = test::random_closed_loop(seed, 0);
    INFO("seed " << seed << "\n" << loop.text);
    test::DeckRun modes = test::run_text(loop.text), segments = test::run_text_segments(loop.text);
    if (modes.answer.outcome != engine::Outcome::completed) continue;
    REQUIRE(segments.answer.outcome == engine::Outcome::completed);
    REQUIRE(segments.rows.size() == modes.rows.size());
    modes.rows.erase(modes.rows.begin());
    segments.rows.erase(segments.rows.begin());
    CHECK(test::largest_difference(modes, segments, least_size) <= loop_agreement);
  }
}

// A switch of 1 GΩ opens with 14 A in a leakage inductance: 14 GV drive a diode on at 10²² V/s, before time has another digit.
TEST_CASE("a diode that turns on faster than times have digits is on no wrong side by Krylov segments", "[regression]") {
  const test::ClosedLoop loop = test::random_closed_loop(147, 0);
  INFO(loop.text);
  const auto [modes, segments] = test::run_both(loop.text);
  CHECK(test::largest_difference(modes, segments, least_size) <= loop_agreement);
}

// Half bridges of ideal switches: what opens one is an inverter of what closes the other, so that both short-circuit the source while the logic is on its way.
TEST_CASE("complementary switches change by their logic, whatever they short-circuit on its way", "[regression]") {
  for (const std::uint64_t seed : {77, 88, 98, 105, 112, 132}) check_engines(seed);
}

// Between two gates of the logic both switches of a half bridge are open: the current of its inductor would be cut off, and what reads it would take the logic back. 36: a guard beside zero
// that no bound decides, 400 times at one instant.
TEST_CASE("logic settles before the parts that it switches", "[regression]") {
  for (const std::uint64_t seed : {36, 82, 84, 102, 114, 128, 143}) check_engines(seed);
}

// Set and reset fall at one instant, one by its source and the other through a gate without delay: there is no time in which the latch is set alone. By implicit steps it was set.
TEST_CASE("a latch waits for the gates before it", "[regression]") {
  const std::string deck =
      "latch\nVr r 0 PULSE(1 0 1u 10n 10n 4u 10u)\nA1 r 0 0 0 0 0 s 0 BUF\nA2 s r 0 0 0 0 q 0 SRFLOP\nR1 q o 1k\nC1 o 0 1n ic=0\n"
      ".tran 1u 20u uic\n.save v(q)\n.end\n";
  for (const test::DeckRun& run : {test::run_text(deck), test::run_text_sparse(deck, 1e-5), test::run_text_segments(deck)}) {
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    REQUIRE(run.rows.size() == 21);
    for (const auto& row : run.rows) CHECK(std::abs(row[1]) < 0.5);
  }
}

// A voltage begins to rise behind an inductor that only a leak of 1 GOhm carries: the inductor's lag has the other sign for 1e-14 s, and the deck was refused as not unique. The leak takes
// 112 V/1 GOhm for 200 us from 10 uF: 2 uV, which the loop's duty may change a few times.
TEST_CASE("a rectifier with feedback starts from the zero of its line", "[regression]") {
  const auto last_voltage = [](const std::string& leak) {
    const test::DeckRun run = test::run_text(
        "line at zero\nVac a1 b1 SIN(0 12 10k)\nDa a1 rect DX\nDb b1 rect DX\nDc 0 a1 DX\nDd 0 b1 DX\nCrect rect 0 1u\nL1 rect sw 10u\nS1 "
        "sw 0 q 0 SX\n"
        "DS1 0 sw DX\nD2 sw out DX\nC1 out cx 10u\nRx cx 0 5m\nR1 out 0 100\nVrf rf 0 15.3454\nBi 0 xi I=(v(rf)-v(out))*1u\nCi xi 0 25p "
        "ic=0.4\n"
        "Bctl ctl 0 V=limit(v(xi)+0.02*(v(rf)-v(out)),0.05,0.95)\nVtr0 tr0 0 PULSE(0 1 0 4.95u 0.05u 0 5u)\nBq q 0 "
        "V={if(v(ctl)>v(tr0),1,0)}\n"
        ".model SX SW(Ron=10m" +
        leak + " Vt=0.5)\n.model DX D(Ron=1m Vfwd=0)\n.tran 10u 200u uic\n.save v(out)\n.end\n");
    REQUIRE(run.messages == "");
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    return run.rows.back()[1];
  };
  CHECK(last_voltage(" Roff=1G") == Approx(last_voltage("")).margin(20e-6).epsilon(0));
}
