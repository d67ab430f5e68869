/// The cases of validation/cases: what each must hold, and those whose decks are tested nowhere else.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/deck_run.hpp"
#include "regression/reference.hpp"
#include "support/scratch.hpp"

using namespace pwlsim::test;
namespace fs = std::filesystem;

namespace {

constexpr double case_bound = 1e-9;  ///< of a signal, relative to its largest reference value

const fs::path folder = fs::path(PWLSIM_SOURCE_DIR) / "validation" / "cases";

}  // namespace

TEST_CASE("every validation case has its deck, its reason and its reference", "[regression]") {
  std::size_t cases = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    INFO(entry.path());
    ++cases;
    for (const char* name : {"circuit.net", "reference.csv", "events.csv"}) CHECK(fs::exists(entry.path() / name));
    CHECK(read_file(entry.path() / "why.md").rfind("Class: ", 0) == 0);
  }
  CHECK(cases >= 20);
}

TEST_CASE("the ladder of 150 sections follows its closed form", "[regression]") {
  const Reference reference = read_rows(folder / "ladder" / "reference.csv");
  const DeckRun run = run_deck(folder / "ladder" / "circuit.net");
  REQUIRE(run.messages.empty());
  REQUIRE(run.signals == reference.signals);
  REQUIRE(run.rows.size() == reference.rows.size());
  for (std::size_t k = 0; k < run.rows.size(); ++k)
    for (std::size_t i = 0; i < reference.signals.size(); ++i)
      CHECK(std::abs(run.rows[k][i + 1] - reference.rows[k][i + 1]) <= case_bound * reference.maximum(i));
}
