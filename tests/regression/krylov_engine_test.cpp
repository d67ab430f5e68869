/// The decks of passive parts by exact segments (`--engine krylov`), against the same references as the exact engine.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"
#include "regression/reference.hpp"

using namespace pwlsim::test;

namespace {

constexpr double bound = 3e-8;            ///< of a signal's largest value
constexpr double instant_margin = 1e-12;  ///< of the run: where impulses act, the value at the instant itself is another on either side

bool is_of_passive_parts(const DeckRun& run) { return run.answer.message.find("networks of passive parts alone") == std::string::npos; }

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

void check_deck(const std::filesystem::path& deck) {
  INFO(deck.stem().string());
  const DeckRun run = run_deck_segments(deck);
  if (!is_of_passive_parts(run)) return;
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
