/// Parts that others drive, and that nothing saved reads, do not run.
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double filter_bound = 1e-13;

std::string deck(const std::string& behind_buffer, const std::string& saved) {
  return "idle\nV1 a 0 DC 1\nR1 a b 1k\nC1 b 0 1u ic=0\nE1 c 0 b 0 10\n" + behind_buffer + ".model DI D\n.save " + saved +
         "\n.tran 1m 5m uic\n.end\n";
}

const std::string filter = "R2 c d 1k\nC2 d 0 1u ic=0\nD1 d e DI\nR3 e 0 1k\n";

std::string left_out(const DeckRun& run) {
  std::string names;
  for (const auto& remark : run.answer.remarks)
    if (remark.id == "N-left-out") names += remark.text.substr(remark.text.find(": "));
  return names;
}

}  // namespace

// v(b) = 1 − e^(−t/RC), RC = 1 ms, whatever the buffer drives.
TEST_CASE("a filter behind a buffer that nobody saves is left out", "[unit]") {
  const DeckRun run = run_text(deck(filter, "v(b)"));
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.states == 1);
  CHECK(run.answer.statistics.ports == 0);
  const std::string names = left_out(run);
  for (const char* name : {"E1", "R2", "C2", "D1", "R3"}) CHECK(names.find(name) != std::string::npos);
  for (const auto& row : run.rows) CHECK(row[1] == Approx(-std::expm1(-row[0] / 1e-3)).epsilon(filter_bound).margin(filter_bound));
}

TEST_CASE("a part that is read runs, and what drives it", "[unit]") {
  const DeckRun saved = run_text(deck(filter, "v(e)"));
  REQUIRE(saved.answer.outcome == engine::Outcome::completed);
  CHECK(saved.answer.statistics.states == 2);
  CHECK(saved.answer.statistics.ports == 1);
  CHECK(left_out(saved).empty());
  // Fed back, the filter is needed though it is not saved.
  const DeckRun fed_back = run_text(deck(filter + "G1 0 b e 0 1u\n", "v(b)"));
  REQUIRE(fed_back.answer.outcome == engine::Outcome::completed);
  CHECK(fed_back.answer.statistics.states == 2);
  CHECK(left_out(fed_back).empty());
}

TEST_CASE("a switch that a part drives makes the part needed", "[unit]") {
  const DeckRun run = run_text(deck("R2 c d 1k\nC2 d 0 1u ic=0\nS1 b 0 d 0 SW\n.model SW SW(Ron=1k Vt=5)\n", "v(b)"));
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.states == 2);
  CHECK(left_out(run).empty());
}

// A current that a diode blocks has no solution, whether anybody looks or not.
TEST_CASE("a part without solution runs although nobody saves it", "[unit]") {
  const DeckRun run = run_text(deck("G1 0 f b 0 1\nD1 0 f DI\n", "v(b)"));
  CHECK(run.answer.outcome == engine::Outcome::no_solution);
}

TEST_CASE("an idle part is still checked", "[unit]") {
  const DeckRun run = run_text(deck("R2 c d 1k\nC2 d f 1u\nC3 f g 1u\n", "v(b)"));
  const DeckRun loop = run_text(deck("E2 c 0 b 0 5\n", "v(b)"));
  CHECK(loop.messages.find("E-source-loop") != std::string::npos);
  CHECK(run.messages.empty());  // a dangling capacitor is none of those
}
