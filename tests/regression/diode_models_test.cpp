#include <catch2/catch.hpp>

#include <cmath>
#include <string>

#include "regression/deck_run.hpp"

namespace pwlsim::test {

namespace {

/// k·T/q at 27 °C by the exact constants of the SI.
constexpr double thermal_voltage = 1.380649e-23 * 300.15 / 1.602176634e-19;
/// N·Vt·(ln(I0/IS) − 1) and N·Vt/I0 with SPICE's IS = 1e-14, N = 1, at I0 = 1 A.
const double default_drop = thermal_voltage * (std::log(1e14) - 1.0);
constexpr double default_resistance = thermal_voltage;
constexpr double model_rounding = 1e-12;

double current_of(const std::string& cards) {
  const DeckRun run = run_text("diode\n" + cards + ".save i(D1)\n.tran 1m 1m\n");
  CAPTURE(cards, run.messages, run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  return run.rows.back()[1];
}

}  // namespace

TEST_CASE("the series resistance of a diode stands behind its breakdown voltage", "[regression]") {
  const double current = current_of("V1 a 0 -30\nR1 a b 1\nD1 b 0 DM\n.model DM D(RS=10 BV=10)\n");
  CHECK(current == Approx(-(30.0 - 10.0) / (1.0 + 10.0)).epsilon(model_rounding));
}

TEST_CASE("LTspice's own line .model D D is SPICE's default diode", "[regression]") {
  const std::string circuit = "V1 a 0 5\nR1 a b 1k\nD1 b 0 D\n.model D D\n";
  const double exponential = (5.0 - default_drop) / (1e3 + default_resistance), ideal = 5.0 / 1e3;
  CHECK(current_of(circuit) == Approx(ideal).epsilon(model_rounding));
  CHECK(current_of(circuit + ".backanno\n") == Approx(exponential).epsilon(model_rounding));
  CHECK(current_of(circuit + ".lib C:\\LTC\\lib\\cmp\\standard.dio\n") == Approx(exponential).epsilon(model_rounding));
  CHECK(current_of("V1 a 0 5\nR1 a b 1k\nD1 b 0 DX\n.model DX D\n.backanno\n") == Approx(ideal).epsilon(model_rounding));
}

}  // namespace pwlsim::test
