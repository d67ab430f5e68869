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

// The diodes carry milliamperes and amperes, so that each has three tangents. By Krylov segments the first was 4.8 mA and not 4.3 mA for D1, and 19 mA and not 17 mA for D2.
TEST_CASE("the tangents of diodes do not depend on how the exact solution is found", "[unit]") {
  const Scratch scratch;
  scratch.write("pump.net",
                "Dickson pump\nV1 in 0 5\nVC1 p1 0 PULSE(0 5 0 10n 10n 4.98u 10u)\nVC2 p2 0 PULSE(5 0 0 10n 10n 4.98u 10u)\nD1 in n1 DX\n"
                "C1 n1 p1 100n\nD2 n1 n2 DX\nC2 n2 p2 100n\nD3 n2 out DX\nC3 out 0 1u\nR1 out 0 10k\n"
                ".model DX D(IS=2.52n N=1.752 RS=0.568)\n.tran 1u 1m\n.end\n");
  const auto note = [&](const std::string& engine) {
    const Finished finished = run_in(scratch, {"pump.net", "--engine", engine});
    REQUIRE(finished.status == 0);
    const std::size_t first = finished.err.find("note[N-diode-current]");
    REQUIRE(first != std::string::npos);
    return finished.err.substr(first, finished.err.find('\n', first) - first);
  };
  const std::string exact = note("exact");
  CHECK(exact.find(" and ") != std::string::npos);
  CHECK(note("krylov") == exact);
  CHECK(note("modes") == exact);
}

TEST_CASE("a diode that never conducts is left as it is", "[unit]") {
  const Finished finished = run_diode(-5.0, 1e3, 1, "");
  CHECK(finished.status == 0);
  CHECK(std::abs(measured(finished)) < 1e-12);
  CHECK(finished.err.find("N-diode-current") == std::string::npos);
}

TEST_CASE("a diode whose current spans much has two or three tangents", "[unit]") {
  // Rectifiers with their inrush; the numbers are those of ngspice-39 for the exponential diodes. With one tangent each the means are 0.7 % and 1 % off.
  const auto run_deck = [](const std::string& deck) {
    const Scratch scratch;
    scratch.write("d.net", deck);
    return run_in(scratch, {"d.net"});
  };
  const Finished bridge = run_deck(
      "1N4007\nV1 ac1 ac2 SIN(0 17 50)\nD1 ac1 out DX\nD2 ac2 out DX\nD3 0 ac1 DX\nD4 0 ac2 DX\nC1 out 0 1000u\nR1 out 0 100\n"
      ".model DX D(IS=7.02767n RS=0.0341512 N=1.80803)\n.tran 0.1m 200m\n.meas v AVG v(out) FROM=100m TO=200m\n");
  REQUIRE(bridge.status == 0);
  CHECK(value_of(bridge.out, "v") == Approx(14.741).epsilon(3e-3));
  CHECK_THAT(bridge.err, Catch::Matchers::Contains(" and "));
  const Finished lamp = run_deck(
      "a LED\nV1 a b SIN(0 10 60)\nD1 a p DX\nD2 b p DX\nD3 0 a DX\nD4 0 b DX\n.model DX D(Is=2.682n N=1.836 Rs=.5664)\nR1 p q 1k\n"
      "D5 q 0 LED\n.model LED D(IS=93.2P RS=42M N=3.73)\nC1 p 0 10u\n.tran 10u 100m\n.meas v AVG v(p) FROM=50m TO=100m\n");
  REQUIRE(lamp.status == 0);
  CHECK(value_of(lamp.out, "v") == Approx(7.142).epsilon(3e-3));
}

TEST_CASE("junctions of transistors have their tangents at what they carry", "[unit]") {
  const Scratch scratch;
  // A diode of a transistor: emitter and base drive 1 mA; v = Vt ln(i/IS), the collector open at the base.
  scratch.write("d.net",
                "junction\nI1 0 b 1m\nQ1 b b 0 QX\n.model QX NPN(IS=1e-14 BF=100)\nM1 0 0 s 0 MX\nI2 0 s 10m\n.model MX VDMOS(Ron=1m Vto=3 "
                "Is=1e-12 N=1.2)\n"
                ".tran 1u 10u\n.meas q FIND v(b) AT=5u\n.meas m FIND v(s) AT=5u\n");
  const Finished finished = run_in(scratch, {"d.net"});
  INFO(finished.err);
  REQUIRE(finished.status == 0);
  // Nearly all of the milliampere is the transport current: collector and base are one node.
  CHECK(value_of(finished.out, "q") == Approx(thermal_voltage * std::log(1e-3 / 1.01 / 1e-14)).epsilon(2e-3));
  CHECK(value_of(finished.out, "m") == Approx(1.2 * thermal_voltage * std::log(10e-3 / 1e-12)).epsilon(2e-3));
}

TEST_CASE("a MOSFET's resistance is taken at the gate voltage it has", "[unit]") {
  const Scratch scratch;
  const auto run = [&](const std::string& gate, const std::string& model, const std::string& options) {
    return run_deck(scratch, "gate\nV1 in 0 12\nV2 g 0 " + gate + "\nR1 in d 10\nM1 d g 0 0 NM\n.model NM " + model + "\n" + options +
                                 ".tran 1u 100u\n.meas low FIND v(d) AT=52u\n");
  };
  // Rd + 1/(Kp (v(g,s) - Vto)) beside 10 ohm, as in SPICE's linear region: 1/(10 A/V² · 2 V) and 20 mohm.
  const auto low = [](double resistance) { return 12.0 * resistance / (10.0 + resistance); };
  const std::string model = "VDMOS(Vto=3 Kp=10 Rd=20m", pulse = "PULSE(0 5 0 0.2u 0.2u 4u 10u)";
  const Finished driven = run(pulse, model + ")", "");
  REQUIRE(driven.status == 0);
  // Edges count where they are nearly up.
  CHECK(value_of(driven.out, "low") == Approx(low(0.07)).epsilon(1e-2));
  CHECK_THAT(driven.err, Catch::Matchers::Contains("note[N-gate-drive]") && Catch::Matchers::Contains("M1 at 5 V"));
  CHECK(value_of(run("5", "NMOS(Vto=3 Kp=5 Rd=20m W=2 L=1)", "").out, "low") == Approx(low(0.07)).epsilon(1e-3));
  // What the deck says itself is kept.
  for (const Finished& given : {run(pulse, model + " Vdrive=8)", ""), run(pulse, model + ")", ".options vdrive=8\n")}) {
    CHECK(value_of(given.out, "low") == Approx(low(0.04)).epsilon(1e-9));
    CHECK(given.err.find("N-gate-drive") == std::string::npos);
  }
  CHECK(value_of(run(pulse, model + " Ron=1)", "").out, "low") == Approx(low(1.0)).epsilon(1e-9));
  // A P channel on the high side, 5 V below its source.
  const Finished high =
      run_deck(scratch,
               "high side\nV1 in 0 12\nV2 g 0 7\nR1 d 0 10\nM1 d g in in PM\n.model PM VDMOS(pchan Vto=-3 Kp=10 Rd=20m)\n.tran 1u "
               "100u\n.meas low FIND v(in,d) AT=50u\n");
  REQUIRE(high.status == 0);
  CHECK(value_of(high.out, "low") == Approx(low(0.07)).epsilon(1e-3));
  CHECK_THAT(high.err, Catch::Matchers::Contains("M1 at -5 V"));
}
