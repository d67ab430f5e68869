/// The decks of netlists/ on the sparse engine, against the same references as the exact one.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"
#include "regression/reference.hpp"

using namespace pwlsim::test;

namespace {

/// A method of order 2 whose steps keep a local error of reltol takes reltol^(−1/3) of them and gathers reltol^(2/3); the factor is that of runs
/// through hundreds of events. (100,000 periods without any damping gather 100,000 errors of phase: that deck is the exact engine's.)
double global_bound(double reltol) { return 20.0 * std::cbrt(reltol * reltol); }
bool gathers_too_much(const std::string& deck) { return deck == "tank_clamp"; }

/// Kirchhoff's laws hold to rounding, but for rates: rounding of a charge over the shortest step, which is 10⁻⁷ of the others.
constexpr double kirchhoff_bound = 1e-5;

/// So near to an event, as a part of the run, a row may hold what stands on its other side.
constexpr double event_margin = 1e-3;

bool near_event(const Reference& reference, double time, double stop) {
  return std::any_of(reference.events.begin(), reference.events.end(),
                     [&](const auto& event) { return std::abs(event.time - time) < event_margin * stop; });
}

/// The worst error over the signals and all rows that are not near an event.
double worst_error(const DeckRun& run, const Reference& reference, bool near_events) {
  double worst = 0.0;
  for (const auto& expected : reference.rows) {
    if (!near_events && near_event(reference, expected[0], run.stop)) continue;
    const auto* row = run.row_at(expected[0]);
    if (!row) return INFINITY;
    for (std::size_t signal = 0; signal < reference.signals.size(); ++signal)
      worst = std::max(worst, std::abs((*row)[signal + 1] - expected[signal + 1]) / reference.maximum(signal));
  }
  return worst;
}

std::filesystem::path netlist(const std::string& name) { return std::filesystem::path(PWLSIM_SOURCE_DIR) / "netlists" / (name + ".net"); }

}  // namespace

TEST_CASE("decks of netlists/ agree with their references on the sparse engine", "[regression]") {
  const auto deck = GENERATE(from_range(decks_in("netlists")));
  const std::string name = deck.stem().string();
  if (gathers_too_much(name)) return;
  const double reltol = GENERATE(1e-4, 1e-6);
  INFO(name << " at " << reltol);
  const DeckRun run = run_deck_sparse(deck, reltol);
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  CHECK(run.answer.time == run.stop);
  CHECK(run.answer.certificate.complementarity <= reltol);
  CHECK(run.answer.certificate.kcl_kvl <= kirchhoff_bound);
  // Many events a row: there is no row that is not near one.
  const bool only_events = name == "buck_parasitic" || name == "flyback" || name == "buck_dcm" || name == "boost" || name == "buck" ||
                           name == "hbridge" || name == "hysteretic_buck" || name == "flyback_ideal";
  CHECK(worst_error(run, read_reference(name), only_events) <= global_bound(reltol));
}

// Between tolerances a hundred apart: error ratio = (step ratio)^order.
TEST_CASE("the sparse engine converges with order 2 through events", "[regression]") {
  const auto name = GENERATE(as<std::string>(), "rlcd", "diode_bridge", "flyback_ideal", "freewheel");
  INFO(name);
  const Reference reference = read_reference(name);
  const DeckRun coarse = run_deck_sparse(netlist(name), 1e-5), fine = run_deck_sparse(netlist(name), 1e-8);
  const double order = std::log(worst_error(coarse, reference, true) / worst_error(fine, reference, true)) /
                       std::log(static_cast<double>(fine.answer.statistics.steps) / static_cast<double>(coarse.answer.statistics.steps));
  CHECK(order > 1.7);
}

TEST_CASE("the sparse engine writes rows before and after an event", "[regression]") {
  const DeckRun run = run_deck_sparse(netlist("halfwave"), 1e-4, true);
  std::vector<double> times;
  for (std::size_t i = 1; i < run.rows.size(); ++i)
    if (run.rows[i][0] == run.rows[i - 1][0]) times.push_back(run.rows[i][0]);
  std::vector<double> expected;
  for (const auto& event : read_reference("halfwave").events)
    if (event.counts()) expected.push_back(event.time);
  REQUIRE(times.size() == expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) CHECK(std::abs(times[i] - expected[i]) <= 1e-4 * run.stop);
}
