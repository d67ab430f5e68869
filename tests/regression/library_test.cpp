/// The shipped subcircuits of lib, called without a path, against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "regression/cards.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

using std::numbers::pi;

/// Times at which the values of a run with events change abruptly or its rows come in pairs, in order, each once.
std::vector<double> event_times(const DeckRun& run) {
  std::vector<double> times;
  for (std::size_t k = 1; k < run.rows.size(); ++k)
    if (run.rows[k][0] == run.rows[k - 1][0] && (times.empty() || times.back() != run.rows[k][0])) times.push_back(run.rows[k][0]);
  return times;
}

bool holds(const std::vector<double>& times, double time) {
  return std::any_of(times.begin(), times.end(), [&](double t) { return t == Approx(time).epsilon(exact); });
}

double root(const std::function<double(double)>& f, double a, double b) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (a + b);
    (f(a) < 0.0) == (f(middle) < 0.0) ? a = middle : b = middle;
  }
  return a;
}

}  // namespace

TEST_CASE("thyristor: half-wave rectifier with a resistor conducts from the firing angle to the zero of the voltage", "[regression]") {
  const double alpha = pi / 3.0;
  const DeckRun run = run_cards(
      "V1 s 0 SIN(0 100 {1/(2*pi)})\nX1 s o g thyristor\nR1 o 0 10\nVG g o PULSE(0 1 {pi/3} 0 0 0.01 {2*pi})\n.save v(o) i(x1.D1)\n"
      ".tran 0.13 13\n");
  const auto current = [&](double t) {
    const double angle = std::fmod(t, 2.0 * pi);
    return angle > alpha && angle < pi ? 10.0 * std::sin(t) : 0.0;
  };
  check_signal(run, 1, 100.0, [&](double t) { return 10.0 * current(t); });
  check_signal(run, 2, 10.0, current);
}

TEST_CASE("thyristor: half-wave rectifier with an inductor conducts on to the extinction angle", "[regression]") {
  // From i' + i = sin t, i(alpha) = 0: i = sin(t - pi/4)/sqrt 2 - sin(alpha - pi/4)/sqrt 2 exp(alpha - t), R = omega L = V = 1.
  const double alpha = GENERATE(0.2, 1.0, 2.0, 3.0);
  const auto current = [&](double t) {
    return (std::sin(t - pi / 4.0) - std::sin(alpha - pi / 4.0) * std::exp(alpha - t)) / std::sqrt(2.0);
  };
  const double beta = root([&](double t) { return -current(t); }, std::max(pi, alpha + 0.01), 2.0 * pi);
  const DeckRun run = run_cards("V1 s 0 SIN(0 1 {1/(2*pi)})\nX1 s o g thyristor\nL1 o p 1\nR1 p 0 1\nVG g o PULSE(0 1 " +
                                    std::to_string(alpha) + " 0 0 1m {2*pi})\n.save i(L1)\n.tran 0.0625 12\n",
                                true);
  CHECK(holds(event_times(run), beta));
  CHECK(holds(event_times(run), alpha + 2.0 * pi));
  check_signal(run, 1, 1.0, [&](double t) {
    const double angle = std::fmod(t, 2.0 * pi);
    return angle >= alpha && angle <= beta ? current(angle) : 0.0;
  });
}

TEST_CASE("thyristor: once fired it needs no gate, and blocks forward voltage until it is fired again", "[regression]") {
  // A pulse rings half a period through L and C, which stays at twice the voltage; discharged by S1 the capacitor is charged again at t = 7.
  const DeckRun run = run_cards(
      "V1 s 0 1\nX1 s a g thyristor\nL1 a c 1\nC1 c 0 1\nS1 c 0 d 0 sw\n.model sw SW(Vt=0.5)\nVG g a PULSE(0 1 1 0 0 10m 6)\n"
      "VD d 0 PULSE(0 1 5 0 0 0.5)\n.save v(c) i(L1)\n.tran 0.0625 12 uic\n");
  const auto charge = [](double t, double start) { return t < start ? 0.0 : 1.0 - std::cos(std::min(t - start, pi)); };
  check_signal(run, 1, 2.0, [&](double t) { return t < 5.0 ? charge(t, 1.0) : charge(t, 7.0); });
  check_signal(run, 2, 1.0, [&](double t) {
    const double phase = t - (t < 5.0 ? 1.0 : 7.0);
    return phase > 0.0 && phase < pi ? std::sin(phase) : 0.0;
  });
}

TEST_CASE("thyristor: a gate under reverse voltage does not fire it, one that lasts fires it when the voltage turns", "[regression]") {
  const DeckRun run = run_cards(
      "V1 s 0 SIN(0 1 {1/(2*pi)})\nX1 s o g thyristor\nR1 o 0 1\nVG g o PWL(0 0 4 0 4 1 5 1 5 0 11 0 11 1 13 1 13 0)\n.save v(o)\n.tran "
      "0.1 "
      "18\n");
  check_signal(run, 1, 1.0, [](double t) { return t > 4.0 * pi && t < 5.0 * pi ? std::sin(t) : 0.0; });
}

TEST_CASE("thyristor: drop, resistance and holding current", "[regression]") {
  const double current_held = 0.5;
  const DeckRun run = run_cards(
      "V1 s 0 SIN(0 10 {1/(2*pi)})\nX1 s o g thyristor ron=0.5 vf=1 ih=0.5 vgt=0.9\nR1 o 0 1.5\nVG g o PULSE(0 1 1 0 0 10m)\n.save "
      "v(o)\n.tran "
      "0.01 6\n",
      true);
  const auto current = [](double t) { return (10.0 * std::sin(t) - 1.0) / 2.0; };
  const double end = pi - std::asin((2.0 * current_held + 1.0) / 10.0);
  CHECK(holds(event_times(run), end));
  for (const auto& row : run.rows)
    if (row[0] != 1.0 && std::abs(row[0] - end) > exact)
      CHECK(row[1] == Approx(row[0] > 1.0 && row[0] < end ? 1.5 * current(row[0]) : 0.0).margin(10.0 * exact));
}

TEST_CASE("thyristor: single-phase bridge that feeds a current commutates at the firing angle", "[regression]") {
  const double alpha = 0.75;
  // DF carries the current until the first thyristors fire.
  const DeckRun run = run_cards(
      "V1 p n SIN(0 1 {1/(2*pi)})\nR1 n 0 1\nX1 p d g1 thyristor\nX2 n d g2 thyristor\nX3 e p g3 thyristor\nX4 e n g4 thyristor\n"
      "I1 d e 1\nDF e f d\nVF f d 3\n.model d D\n.param a=0.75\nV11 g1 d PULSE(0 1 {a} 0 0 1m {2*pi})\nV14 g4 n PULSE(0 1 {a} 0 0 1m "
      "{2*pi})\n"
      "V12 g2 d PULSE(0 1 {a-pi} 0 0 1m {2*pi})\nV13 g3 p PULSE(0 1 {a-pi} 0 0 1m {2*pi})\n.save v(d,e) i(X1.D1)\n"
      ".tran 0.1 13 1\n");
  check_signal(run, 1, 1.0, [&](double t) { return std::fmod(t - alpha, 2.0 * pi) < pi ? std::sin(t) : -std::sin(t); });
  check_signal(run, 2, 1.0, [&](double t) { return std::fmod(t - alpha, 2.0 * pi) < pi ? 1.0 : 0.0; });
}

TEST_CASE("thyristor: six-pulse bridge with source inductance commutates over the overlap angle", "[regression]") {
  // DF carries the current until the first thyristors fire. cos(alpha + mu) = cos alpha - 2 omega L I/(sqrt 3 V), the voltage of the load the mean of two phases meanwhile.
  const double alpha = GENERATE(0.3, 1.0);
  const double inductance = 0.1;
  const double overlap = std::acos(std::cos(alpha) - 2.0 * inductance / std::sqrt(3.0)) - alpha;
  std::string cards = ".param a=" + std::to_string(alpha) + "\n.param T={2*pi} first={pi/6+a}\nI1 p n 1\nDF n f d\nVF f p 3\n.model d D\n";
  const char* phases[] = {"a", "b", "c"};
  for (int k = 0; k < 3; ++k) {
    const std::string phase = phases[k];
    const std::string angle = std::to_string(-120 * k);
    cards += "V" + phase + " s" + phase + " 0 SIN(0 1 {1/(2*pi)} 0 0 " + angle + ")\nL" + phase + " s" + phase + " " + phase + " 0.1\n";
    cards += "XU" + phase + " " + phase + " p gu" + phase + " thyristor\nXL" + phase + " n " + phase + " gl" + phase + " thyristor\n";
    const std::string delay = "first+T*" + std::to_string(k) + "/3";
    cards += "VU" + phase + " gu" + phase + " p PULSE(0 1 {" + delay + "} 0 0 1.2 {T})\n";
    cards += "VL" + phase + " gl" + phase + " " + phase + " PULSE(0 1 {" + delay + "-T/2} 0 0 1.2 {T})\n";
  }
  const DeckRun run = run_cards(cards + ".save v(p,n) i(La)\n.tran 0.05 20 6.4\n", true);
  const std::vector<double> times = event_times(run);
  const double firing = pi / 6.0 + alpha + 2.0 * pi;
  for (int k = 0; k < 6; ++k) {
    CHECK(holds(times, firing + k * pi / 3.0));
    CHECK(holds(times, firing + k * pi / 3.0 + overlap));
  }
  // After T1 has taken over from T5 the output is v(a) - v(b); while it does, the mean of v(a) and v(c), less v(b).
  const auto v = [](double t, int k) { return std::sin(t - 2.0 * pi * k / 3.0); };
  for (const auto& row : run.rows) {
    const double phase = row[0] - firing;
    if (phase > overlap + exact && phase < pi / 3.0 - exact) CHECK(row[1] == Approx(v(row[0], 0) - v(row[0], 1)).margin(exact));
    if (phase > exact && phase < overlap - exact) CHECK(row[1] == Approx(0.5 * (v(row[0], 0) + v(row[0], 2)) - v(row[0], 1)).margin(exact));
  }
}

TEST_CASE("mosfet: conducts both ways when on, through its body diode when off", "[regression]") {
  // 1 ohm behind 4 sin t; Ron = 1 when on; off, the diode takes what is below -vf with rd.
  const DeckRun run = run_cards(
      "V1 s 0 SIN(0 4 {1/(2*pi)})\nR1 s d 1\nX1 d g 0 mosfet ron=1 vth=3 vh=0.5 vf=0.5 rd=3\nVG g 0 PWL(0 0 1 0 1 10 7 10 7 3.2 8 3.2 8 "
      "0)\n"
      ".save v(d)\n.tran 0.1 13\n");
  check_signal(run, 1, 4.0, [](double t) {
    const double v = 4.0 * std::sin(t);
    if (t >= 1.0 && t < 8.0) {
      const double on = 0.5 * v;
      return on > -0.5 ? on : (v - 0.5 / 3.0) / (1.0 + 1.0 + 1.0 / 3.0);  // the diode beside the channel
    }
    return v > -0.5 ? v : -0.5 + (v + 0.5) * 3.0 / 4.0;
  });
}

TEST_CASE("igbt: conducts from collector to emitter when on, its diode the other way", "[regression]") {
  const DeckRun run = run_cards(
      "V1 s 0 SIN(0 4 {1/(2*pi)})\nR1 s c 1\nX1 c g 0 igbt ron=1 vce=1 vf=0.5 rd=0.6\nVG g 0 PULSE(0 15 1 0 0 6)\n.save v(c)\n.tran 0.1 "
      "13\n");
  check_signal(run, 1, 4.0, [](double t) {
    const double v = 4.0 * std::sin(t);
    if (v < -0.5) return -0.5 + (v + 0.5) * 0.6 / 1.6;
    return t >= 1.0 && t < 7.0 && v > 1.0 ? 1.0 + 0.5 * (v - 1.0) : v;
  });
}

TEST_CASE("opamp: an inverting amplifier that saturates", "[regression]") {
  const std::string x = GENERATE("X1 n 0 out opamp vmax=15 vmin=-12\n", "X1 0 n p m out opamp5\nVP p 0 15\nVM m 0 -12\n");
  const DeckRun run = run_cards("V1 in 0 SIN(0 2 {1/(2*pi)})\nR1 in n 1k\nR2 n out 10k\n" + x + ".save v(out) v(n)\n.tran 0.1 13\n");
  const auto out = [](double t) { return std::clamp(-20.0 * std::sin(t), -12.0, 15.0); };
  check_signal(run, 1, 15.0, out);
  check_signal(run, 2, 2.0, [&](double t) { return (10.0 * 2.0 * std::sin(t) + out(t)) / 11.0; });
}

TEST_CASE("opamp: an integrator between its rails", "[regression]") {
  // -1 V into R C = 1 s: up to the rail at 3 s; from 5 s on, +1 V: what the capacitor took over R meanwhile must go first.
  const DeckRun run =
      run_cards("V1 in 0 PULSE(-1 1 5 0 0 20)\nR1 in n 1\nC1 n out 1\nX1 n 0 out opamp vmax=3 vmin=-3\n.save v(out)\n.tran 0.1 12 uic\n");
  // On the rail v(n) follows -1 + exp(-(t - 3)); from 5 s on it rises towards 1 and the output falls when it is back at zero.
  const double low = std::exp(-2.0) - 1.0;
  const double back = 5.0 + std::log(1.0 - low);
  check_signal(run, 1, 3.0, [&](double t) { return t < 5.0 ? std::min(t, 3.0) : std::clamp(3.0 - (t - back), -3.0, 3.0); });
}

TEST_CASE("opamp: a Schmitt trigger switches at a third of its rails", "[regression]") {
  const DeckRun run = run_cards(
      "V1 in 0 SIN(0 10 {1/(2*pi)})\nR1 p 0 1k\nR2 p out 2k\nX1 in p out opamp vmax=15 vmin=-15 gbw=1T\n.save v(out)\n"
      ".tran 0.1 13 0.1\n");
  const double up = pi + std::asin(1.0 / 2.0);  // from a start on the threshold in the middle it goes down
  check_signal(run, 1, 15.0, [&](double t) { return t < up || std::fmod(t - up, 2.0 * pi) > pi ? -15.0 : 15.0; });
}

TEST_CASE("opamp: the pole of a follower lies at its gain-bandwidth product", "[regression]") {
  const DeckRun run = run_cards("V1 in 0 PULSE(0 1 0)\nX1 out in out opamp gbw={1/(2*pi)}\n.save v(out)\n.tran 0.1 5\n");
  check_signal(run, 1, 1.0, [](double t) { return 1.0 - std::exp(-t); });
  const DeckRun finite = run_cards("V1 in 0 2\nR1 in n 1k\nR2 n out 10k\nX1 n 0 out opamp aol=99\n.save v(out)\n.tran 1 2\n");
  check_signal(finite, 1, 20.0, [](double) { return -20.0 / (1.0 + 11.0 / 99.0); });
}

TEST_CASE("xfmr: voltage, current and impedance by the ratio", "[regression]") {
  const DeckRun run =
      run_cards("V1 s 0 SIN(0 100 {1/(2*pi)})\nX1 s 0 a 0 xfmr n=4\nD1 a b d\n.model d D\nR1 b 0 5\n.save v(a) v(b) i(V1)\n.tran 0.1 13\n");
  check_signal(run, 1, 25.0, [](double t) { return 25.0 * std::sin(t); });
  check_signal(run, 2, 25.0, [](double t) { return std::max(25.0 * std::sin(t), 0.0); });
  check_signal(run, 3, 1.25, [](double t) { return -std::max(25.0 * std::sin(t), 0.0) / 5.0 / 4.0; });
}

TEST_CASE("a deck's own subcircuit of a shipped name rules", "[regression]") {
  const DeckRun run = run_cards("V1 a 0 1\nX1 a b xfmr\nR1 b 0 1\n.subckt xfmr a b\nR1 a b 3\n.ends\n.save v(b)\n.tran 1 1\n");
  check_signal(run, 1, 1.0, [](double) { return 0.25; });
}

// From a third of the supply to two thirds through R1 + R2: ln(2) time constants; back through R2 towards what the switch of 10 ohm leaves of the supply.
TEST_CASE("ne555: an astable circuit", "[regression]") {
  const double supply = 10.0, r1 = 2e3, r2 = 4e3, c = 100e-9, r_switch = 10.0;
  const DeckRun run = run_cards(
      "V1 vcc 0 10\nX1 0 cap out vcc cv cap dis vcc NE555\nR1 vcc dis 2k\nR2 dis cap 4k\nC1 cap 0 100n\nRL out 0 1k\n.save v(out)\n.tran "
      "5m uic\n",
      true);
  const std::vector<double> times = event_times(run);
  const double rest = supply * r_switch / (r1 + r_switch), through = r2 + r1 * r_switch / (r1 + r_switch);
  const double high = std::log(2.0) * (r1 + r2) * c;
  const double low = through * c * std::log((supply * 2.0 / 3.0 - rest) / (supply / 3.0 - rest));
  const double first_fall = (r1 + r2) * c * std::log(3.0);
  CHECK(holds(times, first_fall));
  CHECK(holds(times, first_fall + low));
  CHECK(holds(times, first_fall + low + high));
  CHECK(holds(times, first_fall + 2.0 * (low + high)));
}
