/// LTspice's SAMPLEHOLD and OTA beside closed forms.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "regression/deck_run.hpp"

using pwlsim::test::DeckRun;
using pwlsim::test::run_text;

TEST_CASE("a sample-and-hold takes its input at the clock's edge, and follows it while S/H is high", "[regression]") {
  // The input rises by 0.1 V a millisecond; edges of the clock at 2 ms + k·4 ms; S/H is high from 9 to 11 ms, while the clock is low and then high.
  const DeckRun run = run_text(
      "sample and hold\nV1 in 0 PWL(0 0 20m 2)\nV2 clk 0 PULSE(0 1 2m 0 0 1m 4m)\nV3 sh 0 PULSE(0 1 9m 0 0 2m 100m)\n"
      "A1 in 0 clk 0 0 0 a 0 SAMPLEHOLD\nA2 in 0 clk sh 0 0 b 0 SAMPLEHOLD Vhigh=1.5\nA3 0 in 0 sh 0 0 c 0 SAMPLEHOLD\n"
      ".save v(a) v(b) v(c)\n.tran 0.2m 19.9m 0.1m\n.end\n");
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() == 100);
  for (const auto& row : run.rows) {
    const double t = row[0], input = 100.0 * t;
    const double edge = 2e-3 + 4e-3 * std::floor((t - 2e-3) / 4e-3);  // the last one
    const double sampled = t < 2e-3 ? 0.0 : 100.0 * edge;
    INFO(t);
    CHECK(row[1] == Approx(sampled).margin(1e-10));
    CHECK(row[2] == Approx(std::min(t < 9e-3 || t > 14e-3 ? sampled : std::min(input, 1.1), 1.5)).margin(1e-10));
    CHECK(row[3] == Approx(t < 9e-3 ? 0.0 : -std::min(input, 1.1)).margin(1e-10));
  }
}

TEST_CASE("an OTA is a current G times its input, within its limits", "[regression]") {
  const DeckRun run = run_text(
      "ota\nV1 in 0 SIN(0 1 50)\n"
      "A1 0 in 0 0 0 0 a 0 OTA G=1m Iout=0.5m Rout=10k Vhigh=3 Vlow=-2\n"
      "A2 in 0 0 0 0 0 b 0 OTA G=2m linear Rout=1k Ref=0.25 Vhigh=1e308 Vlow=-1e308 en=10n\n"
      "A3 0 in 0 0 0 0 c 0 OTA G=1m linear Cout=1u Rout=1k Vhigh=1e308 Vlow=-1e308\n"
      "A4 0 in 0 0 0 0 d 0 OTA G=1m Isource=0.3m Isink=-0.6m Vhigh=1e308 Vlow=-1e308\nR4 d 0 1k\n"
      ".save v(a) v(b) v(c) v(d)\n.tran 0.3m 20m uic\n.end\n");
  REQUIRE(run.messages.empty());
  constexpr double omega = 2.0 * std::numbers::pi * 50.0, tau = 1e-3;
  for (const auto& row : run.rows) {
    const double t = row[0], x = std::sin(omega * t);
    INFO(t);
    CHECK(row[1] == Approx(std::clamp(10.0 * std::clamp(x, -0.5, 0.5), -2.0, 3.0)).margin(1e-10));
    CHECK(row[2] == Approx(2.0 * (0.25 - x)).margin(1e-10));
    // The low pass of a sine from rest.
    const double wt = omega * tau;
    CHECK(row[3] == Approx((x - wt * std::cos(omega * t) + wt * std::exp(-t / tau)) / (1.0 + wt * wt)).margin(1e-10));
    CHECK(row[4] == Approx(std::clamp(x, -0.6, 0.3)).margin(1e-10));
  }
}

TEST_CASE("a sample-and-hold with Td= puts its sample out that much later, after pulses shorter and longer than Td", "[regression]") {
  // The input rises by 0.1 V a millisecond; edges of both clocks at 2 ms + k·4 ms.
  const DeckRun run = run_text(
      "late samples\nV1 in 0 PWL(0 0 20m 2)\nV2 clk 0 PULSE(0 1 2m 0 0 1m 4m)\nV3 long 0 PULSE(0 1 2m 0 0 3m 4m)\n"
      "A1 in 0 clk 0 0 0 a 0 SAMPLEHOLD Td=1.5m\nA2 in 0 long 0 0 0 b 0 SAMPLEHOLD Td=1.5m\nA3 in 0 clk 0 0 0 c 0 SAMPLEHOLD Td=0\n"
      ".save v(a) v(b) v(c)\n.tran 0.2m 19.9m 0.1m uic\n.end\n");
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() == 100);
  for (const auto& row : run.rows) {
    const double t = row[0];
    const auto sampled = [](double at) { return at < 2e-3 ? 0.0 : 0.2 + 0.4 * std::floor((at - 2e-3) / 4e-3); };
    INFO(t);
    CHECK(row[1] == Approx(sampled(t - 1.5e-3)).margin(1e-10));
    CHECK(row[2] == Approx(sampled(t - 1.5e-3)).margin(1e-10));
    CHECK(row[3] == Approx(sampled(t)).margin(1e-10));
  }
}

TEST_CASE("the second pair of inputs of an OTA is a factor where constant sources or gates hold it", "[regression]") {
  // Pins A- A+ B- B+ (LTspice's symbol of the multiplying OTA).
  const DeckRun run = run_text(
      "multiplying ota\nV1 in 0 SIN(0 1 50)\nVk k 0 3\nVm m 0 0.5\nVg g 0 PULSE(0 2 10m 0 0 1)\n"
      "A1 0 in m k 0 0 a 0 OTA G=1m Iout=2m Vhigh=1e308 Vlow=-1e308\nR1 a 0 1k\n"
      "A2 in 0 0 g 0 0 b 0 OTA G=1m linear Rout=1k Vhigh=1e308 Vlow=-1e308\n"
      ".save v(a) v(b)\n.tran 0.3m 20m uic\n.end\n");
  REQUIRE(run.messages.empty());
  for (const auto& row : run.rows) {
    const double t = row[0], x = std::sin(2.0 * std::numbers::pi * 50.0 * t);
    INFO(t);
    CHECK(row[1] == Approx(std::clamp(2.5 * x, -2.0, 2.0)).margin(1e-10));
    CHECK(row[2] == Approx(t < 10e-3 ? 0.0 : -2.0 * x).margin(1e-10));
  }
}
