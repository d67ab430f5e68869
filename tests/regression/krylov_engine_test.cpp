/// The decks of passive parts by exact segments (`--engine krylov`), against the same references as the exact engine.
#include <catch2/catch.hpp>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"
#include "regression/reference.hpp"

using namespace pwlsim::test;

namespace {

constexpr double bound = 3e-8;  ///< of a signal's largest value

bool is_of_passive_parts(const DeckRun& run) { return run.answer.message.find("runs passive networks only") == std::string::npos; }

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
