/// A switch changes where its control passes a threshold, and nowhere else: at no row, before and behind events too, is a closed one below Vt − Vh or an
/// open one above Vt + Vh.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

/// Three tanks of very different time constants at one source, a fourth behind one of them, and a switch between two that closes by the voltage between two.
std::string tanks(std::uint64_t seed, double& threshold, double hysteresis, double resistance) {
  std::mt19937_64 engine(seed);
  const auto about = [&](double value) { return value * std::exp(0.6 * (static_cast<double>(engine() >> 11U) * 0x1p-53 - 0.5)); };
  threshold = about(1.1);
  return fmt::format(
      "t\nV1 n0 0 SIN(0 10 43.55)\nR1 n0 m1 {}\nL1 m1 n1 {}\nC1 n1 0 {}\nR5 n1 0 {}\nR2 n0 m2 {}\nL2 m2 n2 {}\nC2 n2 0 {}\nR6 n2 0 {}\nR3 "
      "n0 m3 {}\nL3 m3 n3 {}\n"
      "C3 n3 0 {}\nR4 n1 m4 {}\nL4 m4 n4 {}\nC4 n4 0 {}\nR7 n4 0 {}\nS0 n3 n4 n3 n1 M\n.model M SW(Vt={} Vh={} Ron={} Roff=1e6)\n"
      ".save v(n3,n1) v(n3,n4) i(S0)\n.tran 0.5m 0.55 uic\n",
      about(11.0), about(2.7), about(7e-5), about(1.5e3), about(0.24), about(2.3e-3), about(3e-5), about(48.0), about(0.05), about(1.1e-3),
      about(4e-5), about(0.042), about(8.6e-4), about(8e-4), about(69.0), threshold, hysteresis, resistance);
}

}  // namespace

TEST_CASE("a switch changes where its control passes a threshold", "[property]") {
  constexpr double hysteresis = 0.2, resistance = 1.5;
  constexpr double rounding = 1e-9;  ///< of a control at its threshold, V
  int changes = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    double threshold = 0.0;
    const DeckRun run = run_text(tanks(seed, threshold, hysteresis, resistance), true);
    INFO("seed " << seed << ": " << run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    changes += static_cast<int>(run.answer.statistics.events);
    int wrong = 0;
    for (const auto& row : run.rows) {
      if (std::abs(row[2]) < rounding) continue;  // no current tells
      const bool closed = std::abs(row[3]) > 0.5 * std::abs(row[2]) / resistance;
      wrong += closed ? row[1] < threshold - hysteresis - rounding : row[1] > threshold + hysteresis + rounding;
    }
    CHECK(wrong == 0);
  }
  CHECK(changes > 10000);
}

// While a rectifier conducts, its current closes a switch that charges a capacitor by 1001 Ohm; a load of 10 kOhm discharges it. Blocked, the current is at the switch's threshold of zero, and stays there: without
// hysteresis the switch is off (by the contract of controls at rest). Capacitor by hand: exponentials of both time constants.
TEST_CASE("a switch is off while its control rests at the threshold", "[regression]") {
  const std::string text =
      "t\nV1 in 0 SIN(0 10 50)\nD1 in a DI\nVS a b 0\nR1 b 0 10\nV2 s 0 5\nW1 s q VS WM\nR2 q c 1k\nC2 c 0 1u\nR3 c 0 10k\n.model DI D\n"
      ".model WM CSW(Ron=1 Roff=inf It=0 Ih=0)\n.tran 5m 20m\n.save v(c)\n.end\n";
  const double charged = 5.0 * 1e4 / 11001.0, charging = 1e-6 * 1001.0 * 1e4 / 11001.0, discharging = 1e-6 * 1e4;
  const double peak = charged * (1.0 - std::exp(-10e-3 / charging));
  const auto check = [&](const DeckRun& run, double error) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.rows.size() == 5);
    CHECK(run.rows[2][1] == Approx(peak).epsilon(error));
    CHECK(run.rows[3][1] == Approx(peak * std::exp(-5e-3 / discharging)).epsilon(error));
    CHECK(run.rows[4][1] == Approx(peak * std::exp(-10e-3 / discharging)).epsilon(error));
  };
  check(run_text(text), 1e-12);
  check(run_text_segments(text), 1e-12);
  check(run_text_sparse(text, 1e-6), 1e-4);
}
