/// Switches whose control rests at a threshold, and switches that never change although their control moves, are told; others are not.
#include <catch2/catch.hpp>

#include "engine/threshold_watch.hpp"
#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using Catch::Matchers::Contains;

namespace {

constexpr double reltol = 1e-5;

/// The remarks with that id, one a line.
std::string remarks(const DeckRun& run, const std::string& id) {
  std::string text;
  for (const auto& remark : run.answer.remarks)
    if (remark.id == id) text += remark.text + "\n";
  return text;
}

/// The words of dense modes, implicit steps and segments on S1 in 4 V - S1 - 1 kΩ, with a control at c.
void check(const std::string& control, const std::string& model, const std::string& rests, const std::string& never) {
  const std::string deck = "t\n" + control + "\nV9 in 0 4\nS1 in out c 0 SX\nR9 out 0 1k\n.model SX " + model + "\n.tran 1u 100u\n.end\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, reltol), run_text_segments(deck)}) {
    INFO(deck << run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    const std::string at_rest = remarks(run, "W-switch-at-threshold"), in_vain = remarks(run, "N-never-switches");
    CHECK(at_rest.empty() == rests.empty());
    CHECK(in_vain.empty() == never.empty());
    CHECK_THAT(at_rest, Contains(rests));
    CHECK_THAT(in_vain, Contains(never));
  }
}

const std::string pulse = "V1 c 0 PULSE(0 5 0 1n 1n 5u 10u)";

}  // namespace

TEST_CASE("a control that comes to rest at a threshold is told, with what the switch does there", "[regression]") {
  // PULSE is at 5 V from 1 ns on; what counts there is the contract's rule for each kind of switch.
  check(pulse, "VSWITCH(Von=5 Voff=0)", "the control of S1 stops at its threshold of 5 V at t = 1e-09 s: the switch is on there", "");
  check(pulse, "SW(Vt=5)", "at its threshold of 5 V at t = 1e-09 s: the switch is off there", "S1 is off for the whole run");
  check(pulse, "SW(Vt=4 Vh=1)", "at its threshold of 5 V at t = 1e-09 s: the switch keeps its position", "S1 is off for the whole run");
  check("V1 c 0 5", "SW(Vt=5)", "at its threshold of 5 V at t = 0 s", "");
  // The diode ends the current of L1 before 25 us, and it is zero until the end.
  check("V1 a 0 PULSE(1 -1 10u 1n 1n 1 2)\nD1 a b DI\nL1 b c 10u\nR1 c 0 10\n.model DI D", "SW(Vt=0)", "at its threshold of 0 V", "");
}

TEST_CASE("a control that moves and never passes its threshold is told, with its range", "[regression]") {
  check(pulse, "SW(Vt=5.5)", "",
        "S1 is off for the whole run: its control moves between about 0 and 5 V and never crosses the threshold of 5.5 V");
  check(pulse, "VSWITCH(Von=-1 Voff=7)", "", "between about 0 and 5 V and never crosses the threshold of -1 V");
  check("V1 c 0 SIN(1 2 100k)", "SW(Vt=4 Vh=0.5)", "", "never crosses the threshold of 4.5 V");
  check("V1 a 0 PULSE(0 5 0 1n 1n 5u 10u)\nR1 a c 1k\nC1 c 0 1n", "SW(Vt=6)", "", "never crosses the threshold of 6 V");
}

TEST_CASE("a switch that changes, one at a steady level and one at a rippled supply are not told", "[regression]") {
  check(pulse, "SW(Vt=2.5)", "", "");
  check("V1 c 0 12", "SW(Vt=2)", "", "");
  // From one end of the band to the other, and nowhere else: where segments begin and end.
  check("Vr r 0 1\nE1 c 0 r out 1\nC1 out 0 10n", "SW(Ron=1k Vt=0 Vh=0.25)", "", "");
  check("V1 c 0 SIN(12 0.5 100k)", "SW(Vt=2)", "", "");
  check("V1 a 0 PULSE(0 5 0 1n 1n 5u 10u)\nR1 a c 1k\nC1 c 0 1n", "SW(Vt=2 Vh=0.5)", "", "");
  check("V1 c 0 PWL(0 -1 10u 1)", "SW(Vt=0)", "", "");  // passes, and does not rest
  check("V1 c 0 SIN(0 5 100k)", "VSWITCH(Von=4 Voff=1)", "", "");
}

TEST_CASE("of the gates of a device that the deck wrote as one nothing is told", "[regression]") {
  const DeckRun run = run_text("t\nV1 c 0 PULSE(0 1 0 1n 1n 5u 10u)\nA1 c 0 0 0 0 0 q 0 AND Vhigh=5\nR1 q 0 1k\n.tran 1u 100u\n.end\n");
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(remarks(run, "W-switch-at-threshold").empty());
  CHECK(remarks(run, "N-never-switches").empty());
}

// The pulse begins after the end of the run: its control rests at 0 V. By Krylov segments it is a row of a part with other sources, to rounding.
TEST_CASE("rounding of a control that rests is no motion", "[regression]") {
  const std::vector<engine::WatchedSwitch> switches{{"S1", 0.5, 0.5, model::WrittenControl{}, -1}};
  engine::ThresholdWatch watch(switches, 1.0);
  watch.see(0, -7.66e-15);
  watch.see(0, 1.11e-16);
  CHECK(watch.remarks({0}, true).empty());
  watch.see(0, 1e-3);
  CHECK(watch.remarks({0}, true).size() == 1);
}
