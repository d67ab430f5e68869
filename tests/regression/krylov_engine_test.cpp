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
