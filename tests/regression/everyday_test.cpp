/// Everyday decks (validation/everyday) by Krylov segments as by dense modes, which share no equations.

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

using namespace pwlsim;

// The potential of a floating winding of llc.net at t = 0 is a tie, which the two decide differently.
TEST_CASE("everyday decks agree between dense modes and Krylov segments", "[regression][long]") {
  constexpr double expected = 1e-9;  // of the largest value of a signal
  constexpr double least = 1e-3;     // V and A: smaller ones are the last places of others
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(PWLSIM_SOURCE_DIR) / "validation/everyday")) {
    const std::filesystem::path& deck = entry.path();
    if ((deck.extension() != ".net" && deck.extension() != ".cir") || deck.stem() == "llc") continue;
    INFO(deck);
    const test::DeckRun modes = test::run_deck(deck), segments = test::run_deck_segments(deck);
    REQUIRE(modes.answer.outcome == engine::Outcome::completed);
    REQUIRE(segments.answer.outcome == engine::Outcome::completed);
    CHECK(test::largest_difference(modes, segments, least) <= expected);
    ++compared;
  }
  CHECK(compared == 19);
}
