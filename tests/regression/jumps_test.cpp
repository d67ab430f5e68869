/// What --stats and --events tell of a jump.
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double jump_bound = 1e-13;  ///< of values of order one

const engine::Jump::State* state(const engine::Jump& jump, const std::string& name) {
  for (const auto& s : jump.states)
    if (s.name == name) return &s;
  return nullptr;
}

/// A run of either engine with its jumps, and what its values are good for.
std::pair<DeckRun, double> run_on_either_engine(const std::string& text) {
  constexpr double reltol = 1e-8;
  if (GENERATE(false, true)) return {run_text_sparse(text, reltol, true), 100.0 * reltol};
  return {run_text(text, true), jump_bound};
}

}  // namespace

// 3 V on 1 F and 0 V on 2 F: one volt each, 2 C through the diode, 4.5 J before and 1.5 J after.
TEST_CASE("19: a jump tells its charge, its stores and its energy", "[hard]") {
  const auto result =
      run_on_either_engine("caps\nC1 a 0 1 ic=3\nD1 a b DI\nC2 b 0 2 ic=0\n.model DI D\n.save v(a)\n.tran 0.1 1 uic\n.end\n");
  const DeckRun& run = result.first;
  const double tolerance = result.second;
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  REQUIRE(run.answer.jumps.size() == 1);
  const engine::Jump& jump = run.answer.jumps[0];
  CHECK(jump.time == 0.0);
  CHECK_FALSE(jump.higher_order);
  REQUIRE(jump.impulses.size() == 1);
  CHECK(jump.impulses[0].element == "D1");
  CHECK(jump.impulses[0].unit == "C");
  CHECK(jump.impulses[0].value == Approx(2.0).epsilon(tolerance));
  REQUIRE(jump.states.size() == 2);
  REQUIRE(state(jump, "v(C1)"));
  CHECK(state(jump, "v(C1)")->before == Approx(3.0).epsilon(tolerance));
  CHECK(state(jump, "v(C1)")->after == Approx(1.0).epsilon(tolerance));
  REQUIRE(state(jump, "v(C2)"));
  CHECK(state(jump, "v(C2)")->after == Approx(1.0).epsilon(tolerance));
  CHECK(jump.energy_before == Approx(4.5).epsilon(tolerance));
  CHECK(jump.energy_after == Approx(1.5).epsilon(tolerance));
}

// 2 A in 1 H and -1 A in 3 H meet where a diode lets no voltage be negative: the flux 2 - 3 = -1 Vs is kept by 4 H, i = -1/4 A. The
// diode takes the flux 9/4 Vs that the first inductor loses.
TEST_CASE("22: inductors meet, and the diode takes the flux", "[hard]") {
  const auto result =
      run_on_either_engine("coils\nL1 0 a 1 ic=2\nL2 a 0 3 ic=-1\nD1 0 a DI\n.model DI D\n.save i(L1) i(L2)\n.tran 0.1 1 uic\n.end\n");
  const DeckRun& run = result.first;
  const double tolerance = result.second;
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  REQUIRE(run.answer.jumps.size() == 1);
  const engine::Jump& jump = run.answer.jumps[0];
  REQUIRE(state(jump, "i(L1)"));
  CHECK(state(jump, "i(L1)")->before == Approx(2.0).epsilon(tolerance));
  CHECK(state(jump, "i(L1)")->after == Approx(-0.25).epsilon(tolerance));
  REQUIRE(state(jump, "i(L2)"));
  CHECK(state(jump, "i(L2)")->after == Approx(-0.25).epsilon(tolerance));
  REQUIRE(jump.impulses.size() == 1);
  CHECK(jump.impulses[0].unit == "Vs");
  CHECK(jump.impulses[0].value == Approx(2.25).epsilon(tolerance));
  CHECK(jump.energy_before == Approx(3.5).epsilon(tolerance));
  CHECK(jump.energy_after == Approx(0.125).epsilon(tolerance));
}

// Perfectly coupled inductors carry one flux: L = 1 H and 4 H, M = 2 H; 3 A in the first is a flux of 3 Vs and 6 Vs.
TEST_CASE("a switch that moves the current to a coupled winding does not change the flux", "[unit]") {
  const DeckRun run = run_text(
      "flyback\nL1 a 0 1 ic=3\nL2 b 0 4 ic=0\nK1 L1 L2 1\nS1 a 0 c 0 SW\nVC c 0 PULSE(1 0 0.5 0 0 1 2)\nR1 b 0 2\n.model SW SW(Ron=0 "
      "Vt=0.5)\n"
      ".save i(L1) i(L2)\n.tran 0.1 1 uic\n.end\n",
      true);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.jumps.empty());
  // i(L2) = 1.5 A e^(-t/2) after the switch has opened: L2 carries the flux into 2 Ohm, tau = 4/2.
  REQUIRE(run.rows.back()[0] == 1.0);
  CHECK(run.rows.back()[1] == Approx(0.0).margin(jump_bound));
  CHECK(std::abs(run.rows.back()[2]) == Approx(1.5 * std::exp(-0.25)).epsilon(jump_bound));
}

// What is behind a controlled source takes its charge from the source: v(a) = 5 e^(−t/RC) whatever copies or differentiates it. Dense modes shared the charge of C1 with the capacitor of the copy: 2.5 V,
// and 5 uV beside that of a derivative, 1 F.
TEST_CASE("a start that a copy of a voltage contradicts leaves the voltage where it is", "[regression]") {
  const std::string store = "copied\nC1 a 0 1u ic=5\nR1 a 0 1k\n", end = ".save v(a) v(x)\n.tran 10u 1m uic\n";
  const std::string copy = "E1 x 0 a 0 1\nC2 x 0 1u\nR2 x 0 1k\n", derivative = "B1 x 0 V={-1m*ddt(v(a))}\nR2 x 0 1k\n";
  for (const std::string& reads : {copy, derivative}) {
    const std::string deck = store + reads + end;
    for (const DeckRun& run : {run_text(deck), run_text_segments(deck)}) {
      INFO(deck << run.answer.id << " " << run.answer.message);
      REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
      for (const auto& row : run.rows) {
        const double expected = 5.0 * std::exp(-row[0] / 1e-3);
        CHECK(row[1] == Approx(expected).epsilon(1e-11));
        CHECK(row[2] == Approx(expected).epsilon(1e-9));
      }
    }
  }
}
