#include <catch2/catch.hpp>
#include <cmath>

#include "spice/comparison.hpp"
#include "spice/smooth.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

TEST_CASE("the times at which a control passes its levels lie on straight lines between points", "[unit]") {
  const waveform::RawFile raw{{"time", "v(c)"}, {0, 0, 1, 2, 2, 2, 3, -2, 4, -2}};
  const spice::SwitchingPart part{{"S1", {{"v(c)", 1.0}}}, 1.0, -1.0};
  const auto times = spice::switching_times(part, raw).times;  // up through 1 between 0 and 1, down through -1 between 2 and 3
  REQUIRE(times.size() == 2);
  CHECK(times[0] == Approx(0.5).epsilon(1e-14));
  CHECK(times[1] == Approx(2.75).epsilon(1e-14));
}

TEST_CASE("an exact run is compared at the sample times and by its switching", "[unit]") {
  spice::Study study;
  spice::SignalStudy signal;
  signal.name = "v(a)";
  signal.values = {1.0, 2.1, 3.0};
  signal.discretisation = 0.04;
  signal.smoothing = 0.01;
  signal.settled = true;
  study.signals = {signal};
  study.finest.switching = {{{"S1", {{"v(c)", 1.0}}}, 1.0, -1.0}};
  study.waveforms = {{"time", "v(c)"}, {0, 0, 1, 2, 2, 2, 3, -2, 4, -2}};
  const spice::Comparison comparison = spice::compare(study, {0.1, 0.2, 0.3}, {{{1.0, 2.0, 4.0}}, {{"S1", {0.5, 2.5}}}});
  REQUIRE(comparison.signals.size() == 1);
  CHECK(comparison.signals[0].scale == 4.0);
  CHECK(comparison.signals[0].difference == Approx(0.25).epsilon(1e-14));  // |3 - 4| of 4
  CHECK(comparison.signals[0].time == 0.3);
  CHECK(comparison.signals[0].discretisation == Approx(0.01).epsilon(1e-14));
  CHECK_FALSE(comparison.signals[0].explained);
  REQUIRE(comparison.events.size() == 1);
  CHECK(comparison.events[0].worst == Approx(0.25).epsilon(1e-14));
  CHECK(comparison.events[0].at == 2.5);
}

TEST_CASE("a refined RC circuit comes within its own estimate of the closed form", "[unit]") {
  if (!has_ngspice()) return;
  const CompiledDeck deck = keep_circuit("V1 a 0 SIN(0 1 1)\nR1 a b 1\nC1 b 0 1\n.save v(b)\n.tran 10m 2\n");
  REQUIRE(deck.compiled);
  spice::StudySettings settings;
  settings.sample_times = {0.3, 0.9, 1.7};
  Diagnostics diagnostics;
  const spice::Study study = spice::refine(*deck.compiled->circuit, *spice::find_ngspice(), settings, diagnostics);
  REQUIRE(study.signals.size() == 1);
  CHECK(study.signals[0].settled);
  const double w = 2.0 * std::acos(-1.0);
  for (std::size_t k = 0; k < settings.sample_times.size(); ++k) {
    const double t = settings.sample_times[k];
    // x' = sin wt - x, x(0) = 0
    const double exact = (std::sin(w * t) - w * std::cos(w * t) + w * std::exp(-t)) / (1.0 + w * w);
    CHECK(std::abs(study.signals[0].values[k] - exact) <=
          spice::safety * (study.signals[0].discretisation + study.signals[0].smoothing) + 1e-9);
  }
}
