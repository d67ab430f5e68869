/// Switches that one or two pulses drive, at thresholds of every size, stand where the formula of a pulse says.

#include <fmt/format.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/deck_run.hpp"
#include "support/random.hpp"

namespace {

using namespace pwlsim;
using test::DeckRun;
using test::Random;

/// PULSE(v1 v2 td tr tf pw per) of SPICE.
struct Pulse {
  double v1, v2, delay, rise, fall, width, period;

  [[nodiscard]] std::string text() const { return fmt::format("PULSE({} {} {} {} {} {} {})", v1, v2, delay, rise, fall, width, period); }
  [[nodiscard]] double at(double time) const {
    if (time < delay) return v1;
    const double t = std::fmod(time - delay, period);
    if (t < rise) return v1 + (v2 - v1) * t / rise;
    if (t < rise + width) return v2;
    if (t < rise + width + fall) return v2 + (v1 - v2) * (t - rise - width) / fall;
    return v1;
  }
};

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

/// Of round numbers, so that corners and crossings meet.
Pulse random_pulse(Random& random) {
  constexpr std::array<double, 6> levels{-10, -5, 0, 3.3, 5, 10};
  const auto time = [&](double low, double high, double unit) { return rounded(random.between(low, high), unit); };
  return {random.one_of(levels), random.one_of(levels), time(0.0, 0.1, 1e-3), time(0.01, 0.2, 0.01),
          time(0.01, 0.2, 0.01), time(0.0, 0.2, 0.01),  time(0.7, 1.0, 1e-3)};
}

}  // namespace

// From 0.1 s on the slopes of 10 V/s cancel, but for rounding, while the control lies on its threshold: it has not passed until V2 rests at 0.17 s.
TEST_CASE("a control whose slopes cancel on its threshold has not passed", "[regression]") {
  const std::string deck = R"(cancelling slopes
V1 c d PWL(0 2 0.1 2.5 0.2 3.5)
V2 d 0 PWL(0 0 0.1 0 0.17 -0.7 0.3 -0.7)
S1 a 0 c 0 SWI
I1 0 a 1
R1 a 0 1
.model SWI SW(Vt=2.5 Ron=0)
.tran 10m 0.25 uic
)";
  for (const std::string save : {".save v(a)\n", ".save v(a) v(c)\n"})
    for (const bool sparse : {false, true}) {
      INFO(save << (sparse ? "sparse" : "exact"));
      const DeckRun run = sparse ? test::run_text_sparse(deck + save, 1e-4) : test::run_text(deck + save);
      REQUIRE(run.answer.outcome == engine::Outcome::completed);
      for (const auto& row : run.rows) {
        if (std::abs(row[0] - 0.17) < 1e-9) continue;
        INFO("t = " << row[0]);
        CHECK(row[1] == Approx(row[0] < 0.17 ? 1.0 : 0.0).margin(1e-12));
      }
    }
}

TEST_CASE("switches that pulses drive stand where the pulses are", "[regression]") {
  constexpr double clearly = 1e-8;  // V: a control this far from its threshold is on one side of it by the formula, too
  constexpr std::array<double, 6> thresholds{1e-9, -1e-9, 1e-11, 1e-6, 0.0, 2.5};
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const bool two = random.chance(0.5), saved = random.chance(0.5);
    const double threshold = random.one_of(thresholds);
    const Pulse first = random_pulse(random), second = random_pulse(random);
    std::string text = fmt::format("driven\nV1 c {} {}\n", two ? "d" : "0", first.text());
    if (two) text += fmt::format("V2 d 0 {}\n", second.text());
    // With the sources' voltages saved they are a part of their own; without, the switch is a clock.
    text += fmt::format("S1 a 0 c 0 SWI\nI1 0 a 1\nR1 a 0 1\n.model SWI SW(Vt={} Ron=0)\n.save v(a){}\n.tran 11m 20 uic\n", threshold,
                        saved ? " v(c)" : "");
    for (const bool sparse : {false, true}) {
      INFO("seed " << seed << (sparse ? ", sparse" : ", exact") << "\n" << text);
      const DeckRun run = sparse ? test::run_text_sparse(text, 1e-4) : test::run_text(text);
      REQUIRE(run.answer.outcome == engine::Outcome::completed);
      for (const auto& row : run.rows) {
        const double margin = first.at(row[0]) + (two ? second.at(row[0]) : 0.0) - threshold;
        if (row[0] == 0.0 || std::abs(margin) < clearly) continue;
        INFO("t = " << row[0] << ", margin " << margin);
        REQUIRE(row[1] == Approx(margin > 0.0 ? 0.0 : 1.0).margin(1e-12));
      }
    }
  }
}
