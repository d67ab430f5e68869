/// M, J and Q idealised: what a switch with diodes, or straight diodes with current gains, make of simple circuits.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "regression/cards.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

/// kT/q at 27 °C from the constants of the SI.
constexpr double thermal = 1.380649e-23 * 300.15 / 1.602176634e-19;

/// The tangent of RS·i + N·Vt·ln(i/IS) at i0.
double drop(double saturation, double i0) { return thermal * (std::log(i0 / saturation) - 1.0); }

}  // namespace

TEST_CASE("a MOSFET closes at its threshold with the resistance of its model", "[regression]") {
  struct Form {
    std::string model;
    double resistance;
  };
  const Form form =
      GENERATE(Form{"VDMOS(Rg=3 Vto=4 Rd=16m Rs=12m Kp=25 Cgdmax=1n mfg=IR Vds=100 Ron=44m Qg=71n)", 44e-3},
               Form{"VDMOS nchan Vto=4 Rd=16m Rs=12m Kp=25", 28e-3 + 1.0 / (25.0 * 6.0)},
               Form{"NMOS(level=1 VTO=4 KP=2e-5 W=1 L=1u LAMBDA=0.01)", 1.0 / (2e-5 * 1e6 * 6.0)},
               Form{"NMOS(level=3 VTO=4 TOX=50n UO=500 W=1 L=1u)", 1.0 / (0.05 * 3.9 * 8.8541878128e-12 / 50e-9 * 1e6 * 6.0)});
  const std::string nodes = GENERATE("d g 0", "d g 0 0");
  const DeckRun run = run_cards("V1 a 0 10\nR1 a d 10\nM1 " + nodes + " MX\n.model MX " + form.model +
                                "\nVG g 0 PWL(0 0 1 10)\n.save v(d) i(M1)\n.tran 0.0625 1\n");
  const auto on = [](double t) { return 10.0 * t > 4.0; };
  check_signal(run, 1, 10.0, [&](double t) { return on(t) ? 10.0 * form.resistance / (10.0 + form.resistance) : 10.0; });
  check_signal(run, 2, 1.0, [&](double t) { return on(t) ? 10.0 / (10.0 + form.resistance) : 0.0; });
}

TEST_CASE("a MOSFET's shape and number count where its model has no resistance of its own", "[regression]") {
  const DeckRun run = run_cards(
      "V1 a 0 10\nR1 a d 10\nM1 d g 0 0 MX W=0.1 L=2u m=4\n.model MX NMOS(KP=2e-5 VTO=1 RD=0.2 RS=0.3)\nVG g 0 10\n.options vdrive=6\n"
      ".save v(d)\n.tran 1 1\n");
  const double resistance = (0.5 + 1.0 / (2e-5 * 0.1 / 2e-6 * 5.0)) / 4.0;
  check_signal(run, 1, 10.0, [&](double) { return 10.0 * resistance / (10.0 + resistance); });
}

// SPICE's current at the threshold is zero: the usual Vto = 0, or none, with a drive that rests at 0 V.
TEST_CASE("a MOSFET whose gate rests at the threshold is open", "[regression]") {
  struct Form {
    std::string model, drive;  ///< which rests from 2 s to 4 s
  };
  const Form form = GENERATE(Form{"NMOS(Ron=1)", "PULSE(0 10 0 0 0 2 4)"}, Form{"NMOS(Ron=1)", "PULSE(0 10 0 0.1 0.1 1.8 4)"},
                             Form{"NMOS(Vto=2 Ron=1)", "PULSE(2 10 0 0 0 2 4)"});
  const DeckRun run = run_cards("V1 a 0 10\nR1 a d 9\nM1 d g 0 MX\n.model MX " + form.model + "\nVG g 0 " + form.drive +
                                "\n.save v(d)\n.tran 0.75 7.5 0.75\n");
  check_signal(run, 1, 10.0, [&](double t) { return std::fmod(t, 4.0) < 2.0 ? 1.0 : 10.0; });
}

TEST_CASE("a P-channel MOSFET closes below its source", "[regression]") {
  const std::string model = GENERATE("VDMOS(pchan Vto=-3 Ron=1)", "PMOS(VTO=-3 Ron=1)");
  const DeckRun run =
      run_cards("V1 s 0 12\nM1 d g s MX\nR1 d 0 11\n.model MX " + model + "\nVG g 0 PWL(0 12 1 0)\n.save v(d) i(M1)\n.tran 0.0625 1\n");
  const auto on = [](double t) { return 12.0 * t > 3.0; };
  check_signal(run, 1, 11.0, [&](double t) { return on(t) ? 11.0 : 0.0; });
  check_signal(run, 2, 1.0, [&](double t) { return on(t) ? -1.0 : 0.0; });
}

TEST_CASE("the body diode of a MOSFET is that of its model, or ideal", "[regression]") {
  struct Form {
    std::string parameters;
    double drop, resistance, breakdown;
  };
  const double infinite = INFINITY;
  const Form form = GENERATE_COPY(Form{"", 0.0, 0.0, infinite}, Form{" Vfwd=0.8 Rfwd=0.5", 0.8, 0.5, infinite},
                                  Form{" Is=1n N=1 Rb=0.5 BV=3", drop(1e-9, 1.0), 0.5 + thermal, 3.0});
  const std::string type = GENERATE("nchan", "pchan");
  // 1 ohm between a sine of 5 V and a transistor that is off; its diode conducts at negative voltage (P channel: with drain and source exchanged).
  const DeckRun run =
      run_cards("V1 s 0 SIN(0 5 1)\nR1 s a 1\nM1 " + std::string(type == "nchan" ? "a 0 0" : "0 0 a") + " MX\n.model MX VDMOS(" + type +
                " Vto=" + (type == "nchan" ? "30" : "-30") + form.parameters + " Ron=0)\n.save v(a)\n.tran 0.01 2\n");
  check_signal(run, 1, 5.0, [&](double t) {
    const double v = 5.0 * std::sin(2.0 * std::acos(-1.0) * t);
    if (v > form.breakdown) return form.breakdown;
    return v > -form.drop ? v : -form.drop + (v + form.drop) * form.resistance / (1.0 + form.resistance);
  });
}

TEST_CASE("a bulk of its own has a diode to the drain and one to the source", "[regression]") {
  // The bulk is held at 2 V; drain and source hang on 10 ohm each and are pulled up by the diodes.
  const DeckRun run = run_cards(
      "VB b 0 2\nR1 d 0 10\nR2 s 0 10\nM1 d g s b MX\nVG g s 0\n.model MX NMOS(VTO=1 Vfwd=0.5 Ron=1)\n.save v(d) v(s) i(VB)\n.tran 1 1\n");
  check_signal(run, 1, 2.0, [](double) { return 1.5; });
  check_signal(run, 2, 2.0, [](double) { return 1.5; });
  check_signal(run, 3, 1.0, [](double) { return -0.3; });
}

TEST_CASE("a chopper with a MOSFET, a diode, and a coil", "[regression]") {
  const DeckRun run = run_cards(
      "V1 a 0 10\nM1 a g s MX\nVG g s PULSE(0 12 0 0 0 0.5 1)\nD1 0 s DI\nL1 s o 1\nR1 o 0 1\n.model DI D\n.model MX VDMOS(Vto=3 Ron=0)\n"
      ".save i(L1) i(M1)\n.tran 0.01 3 uic\n");
  // From i0 towards 10 A while on, towards 0 while off, with a time constant of 1 s.
  const auto current = [](double t) {
    double i = 0.0;
    for (double start = 0.0;; start += 1.0) {
      if (t < start + 0.5) return 10.0 + (i - 10.0) * std::exp(start - t);
      i = 10.0 + (i - 10.0) * std::exp(-0.5);
      if (t < start + 1.0) return i * std::exp(start + 0.5 - t);
      i *= std::exp(-0.5);
    }
  };
  check_signal(run, 1, 10.0, current);
  check_signal(run, 2, 10.0, [&](double t) { return std::fmod(t, 1.0) < 0.5 ? current(t) : 0.0; });
}

TEST_CASE("a bipolar transistor blocks, amplifies, saturates", "[regression]") {
  const double i0 = 1e-3, gain = 50.0;
  const double forward = gain / (1.0 + gain);
  const double be = drop(1e-15, i0);
  const double slope = forward * thermal / i0;  // of the emitter's current
  // Base current from a ramp behind 1 kohm; collector at 10 V behind 1 kohm. Saturated, both diodes conduct (BR = 1).
  const auto base_current = [&](double v) { return std::max(0.0, (v - be) / (1e3 + slope * (1.0 + gain))); };
  const auto expected = [&](double v) {
    const double linear = 10.0 - 1e3 * gain * base_current(v);
    const double base = v - 1e3 * base_current(v);
    if (linear >= base - be) return linear;  // the base-collector diode has the same tangent
    // Unknown diode currents x (emitter), y (collector): Ic = F x - y/1 … with alpha_R = 1/2.
    const double r = slope, q = 0.5 * thermal / i0;
    // v - 1e3 (x (1-F) + y/2) = be + r x;  and v_b - v_c = be + q y with v_c = 10 - 1e3 (F x - y).
    const double a11 = 1e3 * (1.0 - forward) + r, a12 = 1e3 * 0.5, b1 = v - be;
    const double a21 = r + 1e3 * forward, a22 = -q - 1e3, b2 = 10.0;
    const double det = a11 * a22 - a12 * a21;
    const double x = (b1 * a22 - a12 * b2) / det, y = (a11 * b2 - a21 * b1) / det;
    return 10.0 - 1e3 * (forward * x - y);
  };
  const bool mirrored = GENERATE(false, true);
  const std::string sign = mirrored ? "-" : "";
  const DeckRun run = run_cards("V1 a 0 " + sign + "10\nRC a c 1k\nQ1 c b 0 QX\nRB s b 1k\nVS s 0 PWL(0 0 1 " + sign + "5)\n.model QX " +
                                (mirrored ? "PNP" : "NPN") + "(IS=1f BF=50 CJE=1p VAF=100)\n.options i0=1m\n.save v(c)\n.tran 0.01 1\n");
  check_signal(run, 1, 10.0, [&](double t) { return (mirrored ? -1.0 : 1.0) * expected(5.0 * t); });
}

TEST_CASE("an emitter follower with the series resistances of its transistor", "[regression]") {
  const double gain = 99.0, be = drop(1e-16, 1.0), slope = gain / (1.0 + gain) * thermal;
  const DeckRun run = run_cards(
      "V1 a 0 10\nQ1 a b e 0 QX\nVS b 0 PWL(0 0 1 5)\nRL e 0 10\n.model QX NPN(BF=99 RB=100 RE=0.5 RC=1)\n.save v(e)\n.tran 0.01 1\n");
  check_signal(run, 1, 5.0, [&](double t) { return std::max(0.0, 5.0 * t - be) * 10.0 / (10.0 + 0.5 + slope + 100.0 / (1.0 + gain)); });
}

TEST_CASE("a junction FET is closed without a gate voltage", "[regression]") {
  const bool p_type = GENERATE(false, true);
  const double sign = p_type ? -1.0 : 1.0;
  const DeckRun run =
      run_cards("V1 a 0 " + std::to_string(sign * 10.0) + "\nR1 a d 1k\nJ1 d g 0 JX\nVG g 0 PWL(0 0 1 " + std::to_string(-5.0 * sign) +
                ")\n.model JX " + (p_type ? "PJF" : "NJF") + "(VTO=-2 BETA=1m RD=50)\n.save v(d)\n.tran 0.0625 1\n");
  const double resistance = 50.0 + 1.0 / (2.0 * 1e-3 * 2.0);
  check_signal(run, 1, 10.0, [&](double t) { return sign * (5.0 * t < 2.0 ? 10.0 * resistance / (1e3 + resistance) : 10.0); });
}

// The gate against ground, the source elsewhere: i = (v(g,s) - Vto)/Ron - (v(g,d) - Vto)/Ron, each part where it is positive, solved by hand.
TEST_CASE("a source follows the gate", "[regression]") {
  const std::string type = GENERATE("N", "P");
  const double sign = type == "N" ? 1.0 : -1.0;
  const std::string minus = type == "N" ? "" : "-";
  const DeckRun run =
      run_cards("V1 d 0 " + minus + "24\nVG g1 0 PWL(0 0 1 " + minus + "40)\nRG g1 g 100\nM1 d g s s MX\nR1 s 0 10\n.model MX " + type +
                "MOS(Vto=" + minus + "2 Ron=0.5)\n.save v(s)\n.tran 0.03125 1\n");
  check_signal(run, 1, 24.0, [&](double t) {
    const double follows = (40.0 * t - 2.0) * 10.0 / 10.5, closed = 24.0 * 10.0 / 10.5;
    return sign * std::clamp(follows, 0.0, closed);
  });
}

TEST_CASE("a resistance in the source of a MOSFET", "[regression]") {
  const DeckRun run = run_cards(
      "V1 a 0 10\nRD a d 10\nVG g 0 PWL(0 0 1 10 2 0)\nM1 d g s MX\nRS s 0 1\n.model MX VDMOS(Vto=3 Ron=0.1)\n.save i(M1)\n.tran 0.03125 "
      "2\n");
  check_signal(run, 1, 1.0, [](double t) { return std::clamp((10.0 * (1.0 - std::abs(1.0 - t)) - 3.0) / 1.1, 0.0, 10.0 / 11.1); });
}

TEST_CASE("a MOSFET whose driver stands between gate and source is a switch", "[regression]") {
  const DeckRun run = run_cards(
      "V1 d 0 24\nVG g1 s PWL(0 0 1 10)\nRG g1 g 100\nRGS g s 100k\nM1 d g s MX\nR1 s 0 10\n.model MX VDMOS(Vto=3 Ron=0.5)\n.save "
      "v(s)\n.tran 0.0625 1\n");
  check_signal(run, 1, 24.0, [](double t) { return 10.0 * t * 100.0 / 100.1 > 3.0 ? 24.0 * 10.0 / 10.5 : 0.0; });
}
