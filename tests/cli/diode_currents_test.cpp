/// The current at which the tangent of an exponential diode is taken.

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <cmath>

#include "cli/run_in.hpp"

namespace {

using namespace pwlsim::test;

constexpr double thermal_voltage = 1.380649e-23 / 1.602176634e-19 * 300.15;  // SI 2019, at 27 °C
constexpr double saturation = 2.52e-9, emission = 1.752, series = 0.568;     // a 1N4148

/// i of  source = resistance·i + series·i/m + emission·Vt·ln(i/(m·saturation)),  by Newton's method on ln i.
double exact_current(double source, double resistance, double m) {
  double logarithm = std::log(source / resistance);
  for (int k = 0; k < 200; ++k) {
    const double i = std::exp(logarithm);
    const double total = resistance + series / m;
    const double value = total * i + emission * thermal_voltage * (logarithm - std::log(m * saturation)) - source;
    logarithm -= value / (total * i + emission * thermal_voltage);
  }
  return std::exp(logarithm);
}

Finished run_diode(double source, double resistance, int m, const std::string& more) {
  const Scratch scratch;
  scratch.write("d.net",
                fmt::format("a diode\nV1 a 0 {}\nR1 a b {}\nD1 b 0 DX m={}\n.model DX D(IS=2.52n N=1.752 RS=0.568)\n.meas tran i FIND "
                            "i(R1) AT=5u\n.tran 1u 10u\n{}.end\n",
                            source, resistance, m, more));
  return run_in(scratch, {"d.net"});
}

double measured(const Finished& finished) { return value_of(finished.out, "i"); }

}  // namespace

TEST_CASE("a diode's tangent is taken at the current it carries", "[unit]") {
  for (const double source : {0.35, 1.0, 5.0})
    for (const double resistance : {10.0, 1e3, 1e6})
      for (const int m : {1, 4}) {
        INFO(source << " V, " << resistance << " ohm, m = " << m);
        const Finished finished = run_diode(source, resistance, m, "");
        REQUIRE(finished.status == 0);
        // Two digits of the current: the drop is off by at most slope·(5 %)²/2.
        const double expected = exact_current(source, resistance, m);
        const double off = emission * thermal_voltage * 0.05 * 0.05 / 2.0 / resistance;
        CHECK(std::abs(measured(finished) - expected) <= off + 1e-5 * expected);
        CHECK(finished.err.find("N-diode-current") != std::string::npos);
      }
}

TEST_CASE("a current that the deck gives for tangents is kept", "[unit]") {
  const Finished finished = run_diode(5.0, 1e3, 1, ".options i0=1\n");
  REQUIRE(finished.status == 0);
  const double drop = emission * thermal_voltage * (std::log(1.0 / saturation) - 1.0), slope = series + emission * thermal_voltage;
  CHECK(measured(finished) == Approx((5.0 - drop) / (1e3 + slope)).epsilon(1e-5));
  CHECK(finished.err.find("N-diode-current") == std::string::npos);
}

TEST_CASE("a diode that never conducts is left as it is", "[unit]") {
  const Finished finished = run_diode(-5.0, 1e3, 1, "");
  CHECK(finished.status == 0);
  CHECK(std::abs(measured(finished)) < 1e-12);
  CHECK(finished.err.find("N-diode-current") == std::string::npos);
}
