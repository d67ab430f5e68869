// Corners and jumps of measured expressions that the points of a piece do not see, against closed forms.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "measure/measured.hpp"

using pwlsim::test::exact;
using pwlsim::test::measure_deck;
using pwlsim::test::Measured;
using pwlsim::test::near;
using std::numbers::pi;

// A part that its points did not see change, twice in a row, counted as resolved, whatever was between an end and its first point.
TEST_CASE("a condition changes soon after a piece begins", "[regression]") {
  constexpr double end = 5e-3, fast = 1e-3, slow = 2.7e-3;
  std::string deck =
      "charging\nV1 in 0 PULSE(0 1 0 0 0 1 2)\nR1 in out 1k\nC1 out 0 1u\nR2 in slow 1k\nC2 slow 0 2.7u\n.tran 1m 5m\n.save v(in)\n";
  std::vector<double> changes;
  for (int k = 8; k < 60; ++k) changes.push_back(end * std::pow(10.0, -k / 15.0));
  for (std::size_t i = 0; i < changes.size(); ++i)
    deck += fmt::format(".meas m{} INTEG if(v(out)>{:.17g},1+v(slow),0)\n", i, 1.0 - std::exp(-changes[i] / fast));
  const Measured m = measure_deck(deck);
  REQUIRE(m.messages.empty());
  for (std::size_t i = 0; i < changes.size(); ++i) {
    INFO("at " << changes[i] << " s");
    const double rest = std::exp(-changes[i] / slow) - std::exp(-end / slow);
    CHECK(m.value.at(fmt::format("m{}", i)) == near(2.0 * (end - changes[i]) - slow * rest));
  }
}

// Neither the points of a piece nor its ends see a sine above a level near its peak.
TEST_CASE("conditions and corners lie between the points of a piece", "[regression]") {
  std::string deck = "peaks\nV1 a 0 SIN(0 1 1)\nR1 a 0 1\n.tran 10m 1\n.save v(a)\n";
  std::vector<double> levels;
  for (int k = 3; k < 24; ++k) levels.push_back(1.0 - std::pow(10.0, -k / 3.0));
  for (std::size_t i = 0; i < levels.size(); ++i) {
    deck += fmt::format(".meas time{} INTEG if(v(a)>{:.17g},1,0)\n", i, levels[i]);
    deck += fmt::format(".meas above{} INTEG max(v(a),{:.17g})-{:.17g}\n", i, levels[i], levels[i]);
    deck += fmt::format(".meas most{} MAX floor(v(a)+1-{:.17g})\n", i, levels[i]);
  }
  const Measured m = measure_deck(deck);
  REQUIRE(m.messages.empty());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    INFO("above " << levels[i]);
    const double width = 2.0 * std::acos(levels[i]);                                                          // rad
    const double area = 2.0 * std::sin(0.5 * width) - width * levels[i], digits = 1e-15 / (1.0 - levels[i]);  // of the level's own rounding
    CHECK(m.value.at(fmt::format("time{}", i)) == near(width / (2.0 * pi), exact + digits));
    CHECK(m.value.at(fmt::format("above{}", i)) == Approx(area / (2.0 * pi)).epsilon(0.0).margin(1e-14 * width));
    CHECK(m.value.at(fmt::format("most{}", i)) == 1.0);
  }
}
