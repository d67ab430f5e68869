/// What exact segments must hold on every circuit: independence of their shifts, constraints, lossless lines.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "engine/krylov_rig.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

std::string name(const char* letter, int i) { return letter + std::to_string(i); }

model::Pulse gate(double width, double delay, double period) { return {0.0, 1.0, delay, 1e-6, 1e-6, width, period}; }

/// One leg of a modular multilevel converter: half bridges with ideal diodes across their switches, each in for a part of the period that its level asks for.
TestCircuit multilevel(int submodules) {
  constexpr double link = 800.0, period = 0.02;
  TestCircuit c;
  c.v("p", "0", model::Dc{0.5 * link});
  c.v("n", "0", model::Dc{-0.5 * link});
  const auto arm = [&](const std::string& letter, const std::string& top, const std::string& bottom, double centre) {
    for (int k = 0; k < submodules; ++k) {
      const std::string number = letter + std::to_string(k), above = k == 0 ? top : number;
      const std::string below = k == submodules - 1 ? bottom : letter + std::to_string(k + 1);
      const double level = (2.0 * k + 1.0) / submodules - 1.0;
      const double width = 0.5 * period + std::asin(std::clamp(level / 0.9, -0.999, 0.999)) / std::numbers::pi * period;
      const double start = std::fmod(centre - 0.5 * width + period, period), end = std::fmod(start + width, period);
      const bool wraps = end < start;
      const model::Pulse in = gate(width, start, period), out = gate(period - width, end, period);
      const auto opposite = [](model::Pulse pulse) {
        std::swap(pulse.initial, pulse.pulsed);
        return pulse;
      };
      c.v("g" + number, "0", wraps ? opposite(out) : in);
      c.v("h" + number, "0", wraps ? out : opposite(in));
      c.c("c" + number, below, 4e-4 * submodules, link / submodules);
      c.s("c" + number, above, "g" + number, "0", 0.5);
      c.s(above, below, "h" + number, "0", 0.5);
      c.d(above, "c" + number);
      c.d(below, above);
    }
  };
  arm("u", "p", "ua", 0.75 * period);
  arm("l", "la", "n", 0.25 * period);
  for (auto& item : c.network().switches) item.resistance = 1e-3;
  c.l("ua", "o", 3e-3);
  c.l("o", "la", 3e-3);
  c.r("o", "x", 10.0);
  const int load = c.l("x", "0", 5e-3);
  c.save_v("o");
  c.save_i_l(load);
  return c;
}

/// A six-pulse bridge behind inductive lines, filters of the orders 5, 7 and 11 in stars whose points float, and a dc side that floats, too.
TestCircuit six_pulse() {
  constexpr double frequency = 50.0;
  TestCircuit c;
  for (int phase = 0; phase < 3; ++phase) {
    model::Sin source = sine(325.0, frequency);
    source.phase = -2.0 * std::numbers::pi * phase / 3.0;
    c.v(name("s", phase), "0", source);
    c.r(name("s", phase), name("t", phase), 0.05);
    c.l(name("t", phase), name("a", phase), 1e-3);
    for (const int order : {5, 7, 11}) {
      const std::string own = name("f", order) + "_" + std::to_string(phase);
      const double farads = 20e-6 / order * 5.0, omega = 2.0 * std::numbers::pi * frequency * order;
      c.c(name("a", phase), own + "c", farads);
      c.r(own + "c", own + "r", 0.1);
      c.l(own + "r", name("star", order), 1.0 / (omega * omega * farads));
    }
    c.d(name("a", phase), "P");
    c.d("N", name("a", phase));
  }
  const int choke = c.l("P", "o", 2e-3);
  c.c("o", "N", 1e-3, 400.0);
  c.c("o", "m", 1e-4, 150.0);
  c.c("m", "N", 2e-4, 250.0);
  c.r("o", "N", 20.0);
  c.r("m", "N", 1e3);
  c.save_v("o", "N");
  c.save_i_l(choke);
  c.save_v("a0", "a1");
  return c;
}

void check_other_shifts(const TestCircuit& c, const Setup& setup) {
  const Run usual = simulate_segments(c.network(), setup);
  REQUIRE(usual.answer.outcome == engine::Outcome::completed);
  for (const double factor : {0.5, 2.0}) {
    INFO("shifts times " << factor);
    const Run other = simulate_segments(c.network(), setup, factor);
    INFO(other.answer.id << " " << other.answer.message);
    REQUIRE(other.answer.outcome == engine::Outcome::completed);
    CHECK(distance(other, usual) < engine_error);
    CHECK(other.answer.statistics.events == usual.answer.statistics.events);
  }
}

/// A chain of n equal inductors and capacitors, ω₀ = 1/√LC, in closed form: at rest, a step of 1 V at its begin, and at its end a diode that clamps it to `clamp`.
class ClampedLine {
 public:
  ClampedLine(int n, double omega, double capacitance, double clamp) : n_(n), omega_(omega), clamp_(clamp) {
    double before = 0.0, after = 0.0;  // the front rises once, within some 1/ω₀
    while (open(n, after).value < clamp) {
      before = after;
      after += 0.1 / omega;
    }
    for (int halved = 0; halved < 100; ++halved) {
      const double middle = 0.5 * (before + after);
      (open(n, middle).value < clamp ? before : after) = middle;
    }
    on_ = after;
    current_ = capacitance * open(n, on_).slope;
    conductance_ = capacitance * omega * omega;
    for (int j = 1; j < n; ++j) {
      const Motion motion = open(j, on_);
      for (int k = 1; k < n; ++k) {
        values_[static_cast<std::size_t>(k - 1)] += 2.0 / n * shape(k, j) * (motion.value - rest(j));
        slopes_[static_cast<std::size_t>(k - 1)] += 2.0 / n * shape(k, j) * motion.slope;
      }
    }
  }
  /// When the diode turns on.
  [[nodiscard]] double on() const { return on_; }
  [[nodiscard]] double voltage(int j, double t) const {
    if (t <= on_) return open(j, t).value;
    double value = rest(j);
    for (int k = 1; k < n_; ++k) value += shape(k, j) * motion(k, t - on_).value;
    return value;
  }
  /// Of the diode: its slope is (v_{n−1} − clamp)/L, 1/L = C ω₀².
  [[nodiscard]] double current(double t) const {
    if (t <= on_) return 0.0;
    double integral = (rest(n_ - 1) - clamp_) * (t - on_);
    for (int k = 1; k < n_; ++k) integral += shape(k, n_ - 1) * motion(k, t - on_).integral;
    return current_ + conductance_ * integral;
  }

 private:
  struct Motion {
    double value, slope, integral = 0.0;
  };
  /// Before it: v_j = 1 − Σ a_k sin(θ_k j) cos ω_k t,  θ_k = (2k − 1)π/(2n + 1),  a_k = 2 cot(θ_k/2)/(2n + 1),  ω_k = 2 ω₀ sin(θ_k/2).
  [[nodiscard]] Motion open(int j, double t) const {
    Motion sum{1.0, 0.0};
    for (int k = 1; k <= n_; ++k) {
      const double theta = (2 * k - 1) * std::numbers::pi / (2 * n_ + 1), w = 2.0 * omega_ * std::sin(0.5 * theta);
      const double share = 2.0 / (2 * n_ + 1) / std::tan(0.5 * theta) * std::sin(theta * j);
      sum.value -= share * std::cos(w * t);
      sum.slope += share * w * std::sin(w * t);
    }
    return sum;
  }
  /// After it both ends are held: about a straight line, shapes sin(π k j/n) move with ω_k = 2 ω₀ sin(π k/2n).
  [[nodiscard]] double rest(int j) const { return 1.0 + (clamp_ - 1.0) * j / n_; }
  [[nodiscard]] double shape(int k, int j) const { return std::sin(std::numbers::pi * k * j / n_); }
  [[nodiscard]] Motion motion(int k, double t) const {
    const double w = 2.0 * omega_ * std::sin(std::numbers::pi * k / (2 * n_));
    const double value = values_[static_cast<std::size_t>(k - 1)], slope = slopes_[static_cast<std::size_t>(k - 1)];
    return {value * std::cos(w * t) + slope / w * std::sin(w * t), 0.0,
            value / w * std::sin(w * t) + slope / (w * w) * (1.0 - std::cos(w * t))};
  }

  int n_;
  double omega_, clamp_, on_ = 0.0, current_ = 0.0, conductance_ = 0.0;
  std::vector<double> values_ = std::vector<double>(static_cast<std::size_t>(n_)), slopes_ = values_;
};

}  // namespace

// Half a rung of the ladder of 1/γ up and down.
TEST_CASE("exact segments give the same with other shifts", "[unit]") {
  SECTION("Cockcroft-Walton generators") {
    for (const int stages : {5, 40}) check_other_shifts(multiplier(stages), {.stop = 0.1, .steps = 250});
  }
  SECTION("a multilevel converter") { check_other_shifts(multilevel(8), {.stop = 0.02, .steps = 250}); }
  SECTION("rectifiers on a grid of R and C") { check_other_shifts(grid(10, 6), {.stop = 2e-3, .steps = 200}); }
  SECTION("a six-pulse bridge with filters") { check_other_shifts(six_pulse(), {.stop = 0.04, .steps = 400}); }
}

TEST_CASE("exact segments follow a six-pulse bridge with filters as the dense engine does", "[unit]") {
  const TestCircuit c = six_pulse();
  const Setup setup{.stop = 0.04, .steps = 400};
  const Run dense = simulate(c.network(), setup), segments = simulate_segments(c.network(), setup);
  REQUIRE(segments.answer.outcome == engine::Outcome::completed);
  CHECK(distance(segments, dense) < engine_error);
  CHECK(segments.answer.statistics.events == dense.answer.statistics.events);
}

// Stars of capacitors and a dc side that float, loops of capacitors on that: each vector that a space gains must satisfy all rows without a derivative, or the next has 1/h
// times as much beside them. Sources of a space are right when it is full: before that it is that of a motion without any.
TEST_CASE("no vector of a Krylov space leaves the constraints of a six-pulse bridge with filters", "[unit]") {
  const TestCircuit c = six_pulse();
  Rig rig(c.network());
  rig.on = GENERATE(Position{1, 0, 0, 1, 0, 0}, Position{1, 0, 0, 1, 0, 1}, Position{0, 0, 0, 0, 0, 0});
  for (std::size_t i = 0; i < rig.z.size(); ++i) rig.z[i] = 10.0 * std::sin(static_cast<double>(i));
  const bool has_sources = GENERATE(false, true);
  if (!has_sources) rig.zeta.assign(rig.zeta.size(), 0.0);
  REQUIRE(rig.begin(16.0 / 1e-3));
  for (int vectors = 1; vectors <= 40 && !rig.space.is_full(); ++vectors) {
    rig.space.grow(vectors);
    INFO(vectors << " vectors");
    REQUIRE(rig.space.is_sound());
    if (has_sources && !rig.space.is_full()) continue;
    for (const double t : {0.0, 1e-5, 1e-3}) rig.check_constraints(t, contamination, has_sources);
  }
  CHECK(rig.space.is_full());
}

// Waves that are rough everywhere: spaces of forty vectors reach a small part of the time that they take along the line.
TEST_CASE("exact segments follow lossless lines with a diode at the end as their closed form says", "[unit]") {
  constexpr double inductance = 1e-6, capacitance = 1e-9, clamp = 0.8;
  constexpr double line_error = 1e-9;       ///< of the largest voltage, and current
  constexpr double least_of_a_step = 14.0;  ///< radians of the fastest ring, 2 ω, in half a segment
  constexpr double first_steps = 20.0;      ///< until segments are so long
  const int n = GENERATE(60, 600);
  TestCircuit c;
  c.v("x0", "0", model::Dc{1.0});
  for (int j = 1; j <= n; ++j) {
    c.l(name("x", j - 1), name("x", j), inductance);
    c.c(name("x", j), "0", capacitance);
  }
  c.v("clamp", "0", model::Dc{clamp});
  c.save_v(name("x", 1));
  c.save_v(name("x", n / 2));
  c.save_v(name("x", n));
  c.save_i_d(c.d(name("x", n), "clamp"));
  const double omega = 1.0 / std::sqrt(inductance * capacitance);
  const Run run = simulate_segments(c.network(), {.stop = 1.5 * n / omega, .steps = 60});
  INFO(n << " sections: " << run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.events == 1);
  CHECK(run.answer.statistics.steps <= 1.5 * n * 2.0 / least_of_a_step + first_steps);
  const ClampedLine line(n, omega, capacitance, clamp);
  const double impedance = std::sqrt(inductance / capacitance);
  bool has_conducted = false;
  for (const auto& row : run.rows) {
    const double t = row[0];
    CHECK(std::abs(row[1] - line.voltage(1, t)) < line_error);
    CHECK(std::abs(row[2] - line.voltage(n / 2, t)) < line_error);
    CHECK(std::abs(row[3] - line.voltage(n, t)) < line_error);
    CHECK(std::abs(row[4] - line.current(t)) * impedance < line_error);
    REQUIRE(line.current(t) >= 0.0);  // else the closed form is none of the circuit
    has_conducted |= line.current(t) * impedance > 1.0;
  }
  CHECK(has_conducted);
}

// 0.5 mF beside 2 fF, both floating: within picoseconds the large one is a wire, v = V (1 − R/(R + R)) (1 − e^(−t/τ)), τ = (R₃ + R/2) C. Kirchhoff's law of the node of the small one must not be what
// follows from those of the large one, whose charges leave 4·10⁻¹⁹ C to rounding: 0.2 mV of it.
TEST_CASE("exact segments and implicit steps follow a small capacitor beside a large one that floats", "[unit]") {
  constexpr double volts = 5.0, ohms = 1e3, own = 3e3, small = 2.16e-15, stop = 100e-12;
  constexpr double step_error = 1e-5;  ///< expected of implicit steps at a tolerance of 1e-7
  TestCircuit c;
  c.v("s", "0", model::Dc{volts});
  c.r("s", "c", own);
  c.c("c", "b", small);
  c.c("b", "a", 0.5e-3);
  c.r("s", "a", ohms);
  c.r("b", "0", ohms);
  c.save_v("c", "b");
  const Setup setup{.stop = stop, .steps = 50};
  const Run segments = simulate_segments(c.network(), setup), steps = simulate_steps(c.network(), setup, 1e-7);
  REQUIRE(segments.answer.outcome == engine::Outcome::completed);
  REQUIRE(steps.answer.outcome == engine::Outcome::completed);
  for (std::size_t row = 0; row < segments.rows.size(); ++row) {
    const double expected = 0.5 * volts * -std::expm1(-segments.rows[row][0] / ((own + 0.5 * ohms) * small));
    CHECK(std::abs(segments.at(row, 0) - expected) < engine_error * volts);
    CHECK(std::abs(steps.at(row, 0) - expected) < step_error * volts);
  }
}
