/// Decks by exact segments (`--engine krylov`), against the same references as the exact engine.
#include <catch2/catch.hpp>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"
#include "regression/reference.hpp"

using namespace pwlsim::test;

namespace {

constexpr double bound = 3e-8;  ///< of a signal's largest value
constexpr const char* several_solutions = "case08";

void check_deck(const std::filesystem::path& deck) {
  if (deck.stem() == several_solutions) return;
  INFO(deck.stem().string());
  const DeckRun run = run_deck_segments(deck);
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  CHECK(worst_error(run, read_reference(deck.stem().string())) <= bound);
}

}  // namespace

TEST_CASE("decks of netlists/ agree with their references by Krylov segments", "[regression]") {
  check_deck(GENERATE(from_range(decks_in("netlists"))));
}

TEST_CASE("hard cases agree with their references by Krylov segments", "[hard]") {
  check_deck(GENERATE(from_range(decks_in("tests/hard"))));
}

// The fall of each pulse is cut off at the end of its period, 1 ps before its own, and jumps by 4 nV: 200 edges. The rise and the fall are 1 ps apart, which for implicit steps over 100 ms is one instant.
TEST_CASE("corners of a source that are a picosecond apart are two by Krylov segments", "[regression]") {
  const std::string deck = "corners\nV1 a 0 PULSE(0 1 0 .25m .25m 1p .5m)\nR1 a b 1\nC1 b 0 1u\n.save v(b)\n.tran 1m 100m uic\n";
  for (const DeckRun& run : {run_text(deck), run_text_segments(deck)}) {
    REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
    CHECK(run.answer.statistics.events == 200);
  }
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
