/// The decks of netlists/ on the sparse engine, against the same references as the exact one.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"
#include "regression/reference.hpp"

using namespace pwlsim::test;

namespace {

/// A method of order 2 whose steps keep a local error of reltol takes reltol^(−1/3) of them and gathers reltol^(2/3); the factor is that of runs
/// through hundreds of events. (100,000 periods without any damping gather 100,000 errors of phase: that deck is the exact engine's.)
double global_bound(double reltol) { return 20.0 * std::cbrt(reltol * reltol); }
bool gathers_too_much(const std::string& deck) { return deck == "tank_clamp"; }

const std::set<std::string> higher_order = {"case04", "case06"};
/// The sparse engine takes one of them, and says that it has not examined whether there are others.
const std::set<std::string> several_solutions = {"case08"};

/// Kirchhoff's laws hold to rounding, rates included: they come from increments.
constexpr double kirchhoff_bound = 1e-9;

/// Where impulses act: the exact value at the instant itself is another on either side.
constexpr double instant_margin = 1e-12;

/// The worst error over the signals and all rows, but those at an instant that the reference names.
double worst_error(const DeckRun& run, const Reference& reference) {
  double worst = 0.0;
  for (const auto& expected : reference.rows) {
    const bool at_event = std::any_of(reference.events.begin(), reference.events.end(),
                                      [&](const auto& event) { return std::abs(event.time - expected[0]) < instant_margin * run.stop; });
    if (at_event) continue;
    const auto* row = run.row_at(expected[0]);
    if (!row) return INFINITY;
    for (std::size_t signal = 0; signal < reference.signals.size(); ++signal)
      worst = std::max(worst, std::abs((*row)[signal + 1] - expected[signal + 1]) / reference.maximum(signal));
  }
  return worst;
}

void check_deck(const std::filesystem::path& deck, const std::string& name, double reltol) {
  INFO(name << " at " << reltol);
  const DeckRun run = run_deck_sparse(deck, reltol);
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == pwlsim::engine::Outcome::completed);
  CHECK(run.answer.time == run.stop);
  CHECK(run.answer.certificate.complementarity <= reltol);
  CHECK(run.answer.certificate.kcl_kvl <= kirchhoff_bound);
  CHECK(worst_error(run, read_reference(name)) <= global_bound(reltol));
}

std::filesystem::path netlist(const std::string& name) { return std::filesystem::path(PWLSIM_SOURCE_DIR) / "netlists" / (name + ".net"); }

}  // namespace

TEST_CASE("decks of netlists/ agree with their references on the sparse engine", "[regression]") {
  const auto deck = GENERATE(from_range(decks_in("netlists")));
  const std::string name = deck.stem().string();
  if (gathers_too_much(name)) return;
  check_deck(deck, name, GENERATE(1e-4, 1e-6));
}

TEST_CASE("hard cases agree with their references on the sparse engine", "[hard]") {
  const auto deck = GENERATE(from_range(decks_in("tests/hard")));
  const std::string name = deck.stem().string();
  if (higher_order.count(name) != 0 || several_solutions.count(name) != 0) return;
  check_deck(deck, name, GENERATE(1e-4, 1e-6));
}

TEST_CASE("jumps by impulses of higher order are refused by the sparse engine", "[hard]") {
  for (const auto& name : higher_order) {
    const DeckRun run = run_deck_sparse(std::filesystem::path(PWLSIM_SOURCE_DIR) / "tests" / "hard" / (name + ".net"), 1e-4);
    INFO(name << " " << run.answer.message);
    CHECK(run.answer.id == "E-jump-order");
  }
}

// Between tolerances a hundred apart: error ratio = (step ratio)^order.
TEST_CASE("the sparse engine converges with order 2 through events", "[regression]") {
  const auto name = GENERATE(as<std::string>(), "rlcd", "diode_bridge", "flyback_ideal", "freewheel");
  INFO(name);
  const Reference reference = read_reference(name);
  const DeckRun coarse = run_deck_sparse(netlist(name), 1e-5), fine = run_deck_sparse(netlist(name), 1e-8);
  const double order = std::log(worst_error(coarse, reference) / worst_error(fine, reference)) /
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
