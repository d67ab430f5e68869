/// Runs through infinitely many events (hard case 13, twisting).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "regression/deck_run.hpp"
#include "regression/twisting.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double accumulation_bound = 1e-12;  ///< of values and times of order one

}  // namespace

TEST_CASE("case 13: twisting comes to rest at t = 1 + 2/sqrt 3, through infinitely many events", "[hard]") {
  const DeckRun run = run_text(twisting_deck("", "0.01 3"));
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.accumulations == 1);
  REQUIRE(run.rows.size() == 301);
  for (const auto& row : run.rows) {
    INFO("t = " << row[0]);
    const Place expected = twisted(row[0]);
    CHECK(std::abs(row[1] - expected.x) <= accumulation_bound);
    CHECK(std::abs(row[2] - expected.v) <= accumulation_bound);
  }
  CHECK(run.answer.certificate.complementarity <= accumulation_bound);
  CHECK(run.answer.certificate.kcl_kvl <= accumulation_bound);
  CHECK(run.answer.certificate.energy <= accumulation_bound);
}

TEST_CASE("case 13: the limit has a row before and after, at its time", "[hard]") {
  const DeckRun run = run_text(twisting_deck("", "0.25 3"), true);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const double limit = 1.0 + 2.0 / std::sqrt(3.0);
  int found = 0;
  for (const auto& row : run.rows)
    if (std::abs(row[0] - limit) <= accumulation_bound * limit) {
      ++found;
      CHECK(std::abs(row[1]) <= accumulation_bound);
      CHECK(std::abs(row[2]) <= accumulation_bound);
    }
  CHECK(found == 2);
}

TEST_CASE("case 13 by segments, beside a passive part with events of its own: through the same limit, with the same rows", "[hard]") {
  const std::string deck = twisting_deck("", "0.01 3"),
                    more = "V1 s 0 SIN(0 1 0.7)\nD1 s r DI\nR1 r 0 1k\nC3 r 0 1m\n.model DI D(Ron=1)\n.save v(r)\n.end\n";
  const DeckRun alone = run_text_segments(deck), beside = run_text_segments(deck.substr(0, deck.rfind(".end")) + more);
  for (const DeckRun* run : {&alone, &beside}) {
    INFO(run->messages << run->answer.message);
    REQUIRE(run->answer.outcome == engine::Outcome::completed);
    CHECK(run->answer.statistics.accumulations == 1);
    CHECK(run->answer.statistics.events < 100);
    REQUIRE(run->rows.size() == 301);
    for (const auto& row : run->rows) {
      INFO("t = " << row[0]);
      const Place expected = twisted(row[0]);
      CHECK(std::abs(row[1] - expected.x) <= accumulation_bound);
      CHECK(std::abs(row[2] - expected.v) <= accumulation_bound);
    }
  }
}

// With a term -0.3 v the times between events shrink by a ratio that only tends to 1/3. The limit is from 200 turns of the closed form
// v = f/k + (v0 - f/k) e^(-k t) between events, with 60 digits (mpmath).
TEST_CASE("case 13 with friction: the ratio is not constant", "[hard]") {
  const DeckRun run = run_text(twisting_deck(" - 0.3*V(v)", "0.25 3"), true);
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  double last = 0.0;
  for (std::size_t i = 1; i < run.rows.size(); ++i)
    if (run.rows[i][0] == run.rows[i - 1][0]) last = run.rows[i][0];
  constexpr double crossing_error = 1e-11, limit = 1.9795625684615682159;  // of the limit, which is found a millionth of the run ahead
  CHECK(last == Approx(limit).epsilon(0).margin(crossing_error));
  CHECK(std::abs(run.rows.back()[1]) <= accumulation_bound);
  CHECK(std::abs(run.rows.back()[2]) <= accumulation_bound);
  const DeckRun segments = run_text_segments(twisting_deck(" - 0.3*V(v)", "0.25 3"));
  INFO(segments.messages << segments.answer.message);
  REQUIRE(segments.answer.outcome == engine::Outcome::completed);
  REQUIRE(segments.answer.statistics.accumulations == 1);
  const auto remark = std::find_if(segments.answer.remarks.begin(), segments.answer.remarks.end(),
                                   [](const engine::Remark& each) { return each.id == "N-accumulation"; });
  REQUIRE(remark != segments.answer.remarks.end());
  constexpr double told_error = 1e-9;  // from a group of events earlier, as nearer ones have fewer digits there
  CHECK(std::stod(remark->text.substr(remark->text.find("= ") + 2)) == Approx(limit).epsilon(0).margin(told_error));
  CHECK(std::abs(segments.rows.back()[1]) <= accumulation_bound);
  CHECK(std::abs(segments.rows.back()[2]) <= accumulation_bound);
}

// The spring of the first term only acts beyond 3e-5: the motion comes to rest inside the play after finitely many events, however long the run.
TEST_CASE("a sequence that ends is no accumulation, in a run of any length", "[unit]") {
  const auto play = [](const std::string& tran) {
    return run_text(
        "play\nB1 0 x I={V(v)}\nC1 x 0 1 ic=0\nB2 0 v I={-2*limit(V(x)/3e-5,-1,1) - sgn(V(v))}\nC2 v 0 1 ic=1\n.save v(x) v(v)\n.tran " +
        tran + " uic\n.end\n");
  };
  const DeckRun brief = play("10 10"), endless = play("1e5 1e5");
  REQUIRE(brief.answer.outcome == engine::Outcome::completed);
  REQUIRE(endless.answer.outcome == engine::Outcome::completed);
  CHECK(brief.answer.statistics.accumulations == 0);
  CHECK(endless.answer.statistics.accumulations == 0);
  CHECK(std::abs(brief.rows.back()[1] - endless.rows.back()[1]) <= accumulation_bound);
  CHECK(std::abs(brief.rows.back()[1]) <= 1.5e-5);  // where the spring is weaker than the friction
}

// v(C1), v(C2) are 0 before the source steps at t = 0, as they are where it steps later.
TEST_CASE("a jump at the start tells what was before the source stepped", "[unit]") {
  const auto run_at = [](const std::string& delay) {
    return run_text(
        "start\nV1 a 0 PULSE(0 3 " + delay +
            " 0 0 10 20)\nC1 a b 1 ic=0\nC2 b 0 2 ic=0\nD1 b c DI\nC3 c 0 1 ic=0\n.model DI D\n.save v(b) v(c)\n.tran 0.5 2 uic\n.end\n",
        true);
  };
  for (const char* delay : {"0", "1"}) {
    INFO("step at " << delay);
    const DeckRun run = run_at(delay);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    REQUIRE(run.answer.jumps.size() == 1);
    CHECK(std::abs(run.answer.jumps[0].energy_before) <= accumulation_bound);
    for (const auto& state : run.answer.jumps[0].states) CHECK(std::abs(state.before) <= accumulation_bound);
    // C1 in series with C2 and C3 in parallel: v(b) = 3·1/(1 + 3).
    CHECK(std::abs(run.rows.back()[1] - 0.75) <= accumulation_bound);
  }
}

TEST_CASE("a run that ends, or a source that moves, before the limit follows the events", "[unit]") {
  for (const DeckRun& run : {run_text(twisting_deck("", "0.01 2.1")), run_text_segments(twisting_deck("", "0.01 2.1"))}) {
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    CHECK(run.answer.statistics.accumulations == 0);
    const Place expected = twisted(2.1);
    CHECK(std::abs(run.rows.back()[1] - expected.x) <= accumulation_bound);
    CHECK(std::abs(run.rows.back()[2] - expected.v) <= accumulation_bound);
  }
}

// Events closer than 1e-14 of the run are one instant: a gate's pulse of 1e-15 s in a run of 1 s has no effect, a hundred of them do not accumulate, and nothing
// leaves zero.
TEST_CASE("pulses far below the resolution of a run are no accumulation on either engine", "[regression]") {
  const std::string deck =
      "t\nV1 in 0 10\nVg g 0 PULSE(0 1 1m 1f 1f 1f 10m)\nS1 in a g 0 SX\nD1 0 a DX\nL1 a out 1m\nC1 out 0 100u\nR1 out 0 10\n"
      ".model SX SW(Ron=1m Vt=0.5)\n.model DX D\n.save v(out) i(L1)\n.tran 10m 1 uic\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    REQUIRE(run.rows.size() == 101);
    for (const auto& row : run.rows) CHECK((row[1] == 0.0 && row[2] == 0.0));
  }
}
