/// Random passive networks: see random_network.hpp for what they are, examination.hpp for what must hold.
#include <catch2/catch.hpp>
#include <cstdint>

#include "property/examination.hpp"

using namespace pwlsim::test;

namespace {

constexpr double most_refused = 0.3;   ///< share of networks whose linear equations may be singular
constexpr int most_printed = 3;        ///< failures that are minimised and printed

/// `known`: networks of this family that are known to fail today (LIMITS.md says how); the number may only go down.
void check_family(const Recipe& recipe, std::uint64_t first_seed, int networks, int known) {
  int refused = 0, wrong = 0;
  for (int i = 0; i < networks; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    const RandomNetwork network = make_random_network(seed, recipe);
    const Finding finding = examine(network, seed);
    if (finding.kind == Finding::Kind::refused) ++refused;
    if (finding.kind != Finding::Kind::wrong) continue;
    if (++wrong > most_printed) continue;
    const RandomNetwork small = minimised(network, seed, finding);
    const Finding of_small = examine(small, seed);
    UNSCOPED_INFO("seed " << seed << ": " << finding.what << ": " << finding.detail << "\nsmallest: " << of_small.detail << "\n" << to_deck(small));
  }
  INFO(wrong << " of " << networks << " networks failed, " << refused << " were refused");
  CHECK(wrong <= known);
  CHECK(refused < most_refused * networks);
}

}  // namespace

TEST_CASE("networks of all parts", "[property]") { check_family({}, 1, 600, 0); }

TEST_CASE("networks without sources never gain energy", "[property]") {
  Recipe recipe;
  recipe.voltage = recipe.current = 0.0;
  check_family(recipe, 10'001, 500, 0);
}

TEST_CASE("networks of stores and diodes with little resistance: capacitor loops, inductor cutsets, jumps", "[property]") {
  Recipe recipe;
  recipe.resistor = 1.0;
  recipe.capacitor = 4.0;
  recipe.inductor = 3.0;
  recipe.diode = 4.0;
  recipe.stiff_source = 0.8;
  check_family(recipe, 20'001, 500, 0);
}

TEST_CASE("networks of many diodes", "[property]") {
  Recipe recipe;
  recipe.diode = 8.0;
  recipe.most_nodes = 5;
  check_family(recipe, 30'001, 500, 0);
}

TEST_CASE("networks that float when their diodes and switches block", "[property]") {
  Recipe recipe;
  recipe.floating = 1.0;
  recipe.diode = 5.0;
  recipe.switch_ = 2.0;
  check_family(recipe, 40'001, 400, 0);
}

TEST_CASE("networks of diodes with forward and reverse resistance: modes up to 10^12 times faster than what one looks at", "[property]") {
  Recipe recipe;
  recipe.diode = 5.0;
  recipe.real_diodes = 0.8;
  check_family(recipe, 50'001, 500, 6);
}
