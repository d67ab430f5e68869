/// The hard cases that the netlist language can state, each against a closed form or, where that is long, a solution of 20 digits
/// (validation/references/closed_forms.py). Their numbers are those of the decks tests/hard/caseNN.net; letters are variants.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double exact_touch = 1e-6;  ///< where a stop is touched with no speed, the double root of the crossing costs half the digits

Bounds bounds_of_case(const std::string& name) {
  Bounds bounds;
  if (name == "case31c") bounds = {exact_touch, exact_touch, true};
  return bounds;
}

/// "case31c" -> 31
int number_of(const std::filesystem::path& deck) { return std::stoi(deck.stem().string().substr(std::string("case").size())); }

/// Several continuations: what a run must do there is tested below.
constexpr int not_unique_case = 8;

std::vector<std::filesystem::path> decks_with_reference() {
  auto decks = decks_in("tests/hard");
  decks.erase(std::remove_if(decks.begin(), decks.end(), [](const auto& deck) { return number_of(deck) == not_unique_case; }), decks.end());
  return decks;
}

}  // namespace

TEST_CASE("hard cases agree with their closed forms", "[hard]") {
  const auto deck = GENERATE(from_range(decks_with_reference()));
  INFO(deck.string());
  compare_with_reference(deck, bounds_of_case(deck.stem().string()));
}

TEST_CASE("every hard case that the language can state has a deck", "[hard]") {
  std::set<int> present;
  for (const auto& deck : decks_in("tests/hard")) present.insert(number_of(deck));
  for (const int number : {1, 3, 4, 7, 8, 9, 10, 12, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 31, 32, 33}) {
    INFO("case " << number);
    CHECK(present.count(number) == 1);
  }
}

// x' = sgn x from 0: t, −t and 0 all solve it.
TEST_CASE("case 8: three solutions are reported, not chosen", "[hard]") {
  const DeckRun run = run_deck(std::filesystem::path(PWLSIM_SOURCE_DIR) / "tests" / "hard" / "case08.net");
  REQUIRE(run.messages.empty());
  CHECK(run.answer.outcome == engine::Outcome::not_unique);
  CHECK(run.answer.time == 0.0);
  CHECK_FALSE(run.answer.message.empty());
  CHECK_FALSE(run.answer.elements.empty());
  CHECK(run.answer.message.find(" in 3 ways") != std::string::npos);
}
