/// Every deck of netlists/ against reference numbers of 20 digits that come from another method (validation/references).
#include <algorithm>
#include <catch2/catch.hpp>

#include "regression/comparison.hpp"
#include "regression/reference.hpp"

using namespace pwlsim::test;

namespace {

constexpr double lossless = 1e-8;  ///< nothing damps the rounding of many periods

Bounds bounds_of_netlist(const std::string& name) {
  Bounds bounds;
  if (name == "tank_clamp" || name == "buck_parasitic") bounds.value = lossless;
  return bounds;
}

}  // namespace

TEST_CASE("decks of netlists/ agree with their references", "[regression]") {
  const auto deck = GENERATE(from_range(decks_in("netlists")));
  INFO(deck.string());
  compare_with_reference(deck, bounds_of_netlist(deck.stem().string()));
}

TEST_CASE("every reference belongs to a deck", "[regression]") {
  std::vector<std::string> names;
  for (const auto* folder : {"netlists", "tests/hard"})
    for (const auto& deck : decks_in(folder)) names.push_back(deck.stem().string());
  for (const auto& entry : std::filesystem::directory_iterator(reference_folder())) {
    std::string name = entry.path().stem().string();
    if (name.ends_with(".events")) name.resize(name.size() - std::string(".events").size());
    INFO(entry.path().string());
    CHECK(std::find(names.begin(), names.end(), name) != names.end());
  }
}
