/// Guards that touch zero, nearly touch it, or cross it twice in no time.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using std::numbers::pi;

namespace {

/// A tank of unit amplitude between clamps at ±1 V, which its voltage touches in every period and never passes.
struct ClampedTank {
  static constexpr double capacitance = 1e-6, inductance = 10e-3;
  static constexpr double omega = 1e4, period = 2.0 * pi / omega;

  TestCircuit circuit;
  /// Starts at the angle `phase` of v = cos(ωt + phase).
  explicit ClampedTank(double phase) {
    circuit.c("a", "0", capacitance, std::cos(phase));
    const int l = circuit.l("a", "0", inductance, std::sqrt(capacitance / inductance) * std::sin(phase));
    circuit.v("high", "0", model::Dc{1.0});
    circuit.v("low", "0", model::Dc{-1.0});
    circuit.d("a", "high");
    circuit.d("low", "a");
    circuit.save_v("a");
    circuit.save_i_l(l);
  }
  /// Relative to the energy at the start.
  static double energy(double v, double i) { return v * v + inductance / capacitance * i * i; }
};

/// Only at phase 0 do the start values, rounded to doubles, have the amplitude 1 exactly. At others they may exceed the clamp by a few
/// roundings; it then truly conducts, for √(2ε)/ω, and the pair of events is as right as none.
void check_tank(double phase, double periods, double bound) {
  const ClampedTank tank(phase);
  const double stop = periods * ClampedTank::period;
  const Run run = simulate(tank.circuit.network(), {stop, 97});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.events % 2 == 0);
  CHECK((phase != 0.0 || run.answer.statistics.events == 0));
  CHECK(run.answer.statistics.jumps == 0);
  for (const auto& row : run.rows) {
    INFO("t = " << row[0]);
    REQUIRE(std::abs(ClampedTank::energy(row[1], row[2]) - 1.0) <= bound);
    REQUIRE(std::abs(row[1] - std::cos(ClampedTank::omega * row[0] + phase)) <= bound);
  }
}

/// x'' = −x with an inelastic stop at x = 1; x and v are voltages of 1 F, the stop's force is the diode's current.
TestCircuit oscillator_with_stop(double speed) {
  TestCircuit c;
  c.c("x", "0", 1.0, 0.0);
  c.g("0", "x", "v", "0", 1.0);
  c.c("v", "0", 1.0, speed);
  c.g("0", "v", "x", "0", -1.0);
  c.v("one", "0", model::Dc{1.0});
  c.e("k", "one", "x", "0", -1.0);  // v(k) = 1 − x
  const int force = c.e("s", "k", "0", "0", 0.0);
  c.d("0", "s");
  model::Injection stop;
  stop.label.name = "F1";
  stop.p = c.node("v");
  stop.current = {{model::Term::Kind::branch_current, force, 1.0}};
  c.network().injections.push_back(stop);
  c.save_v("x");
  c.save_v("v");
  return c;
}

}  // namespace

TEST_CASE("a tank between clamps keeps its energy over 1,000 periods", "[hard]") {
  const double phase = GENERATE(0.0, -pi / 2, 1.0);
  INFO("phase " << phase);
  check_tank(phase, 1e3, 1e-10);
}

TEST_CASE("a tank between clamps keeps its energy over 100,000 periods", "[long]") {
  const double phase = GENERATE(0.0, 1.0);
  INFO("phase " << phase);
  check_tank(phase, 1e5, 1e-8);
}

// v'' = −v + A sin t from rest: v = A(sin t − t cos t)/2, whose peaks reach the clamp after 31,831 periods.
TEST_CASE("a clamp is found that a slowly growing oscillation reaches at last", "[hard]") {
  constexpr long double amplitude = 1e-5L;
  const auto v = [](long double t) { return amplitude * (std::sin(t) - t * std::cos(t)) / 2; };
  long double peak = std::numbers::pi_v<long double>;
  while (v(peak) <= 1) peak += 2 * std::numbers::pi_v<long double>;
  long double low = peak - 1, high = peak;
  for (int i = 0; i < 100; ++i) {
    const long double middle = (low + high) / 2;
    (v(middle) < 1 ? low : high) = middle;
  }
  TestCircuit c;
  c.v("s", "0", sine(static_cast<double>(amplitude)));
  c.l("s", "a", 1.0);
  c.c("a", "0", 1.0);
  c.v("k", "0", model::Dc{1.0});
  c.d("a", "k");
  c.save_v("a");
  const Run run = simulate(c.network(), {static_cast<double>(peak) + 3.0, 1, true, true});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.remarks.empty());
  const auto times = event_times(run);
  REQUIRE(times.size() == 2);
  const auto rounding = static_cast<double>(low) * 1e-16;  // of the phase, and so of v
  const auto slope = static_cast<double>((v(low + 1e-6L) - v(low - 1e-6L)) / 2e-6L);
  CHECK(std::abs(times[0] - static_cast<double>(low)) <= 10.0 * rounding / slope);
}

// Hard case 31: x = A sin t. A = 1 + ε hits the stop at asin(1/A), the speed jumps to zero and x = cos(t − t_c) leaves at once.
TEST_CASE("31: a stop that is barely reached, or barely not", "[hard]") {
  const double excess = GENERATE(1e-2, 1e-4, 1e-6, 1e-8, 1e-9);
  INFO("excess " << excess);
  const Run hit = simulate(oscillator_with_stop(1.0 + excess).network(), {6.0, 61, true, true});
  REQUIRE(hit.errors.empty());
  REQUIRE(hit.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(hit);
  REQUIRE(times.size() == 1);
  const double exact = std::asin(1.0 / (1.0 + excess));
  const double conditioning = 1e-15 / std::sqrt(2.0 * excess);  // rounding of x over the speed at the stop
  CHECK(std::abs(times[0] - exact) <= 10.0 * conditioning);
  for (const auto& row : hit.rows) {
    if (row[0] == times[0]) continue;
    const double expected = row[0] < exact ? (1.0 + excess) * std::sin(row[0]) : std::cos(row[0] - exact);
    REQUIRE(std::abs(row[1] - expected) <= 1e-9);
  }

  const Run missed = simulate(oscillator_with_stop(1.0 - excess).network(), {6.0, 61, true, true});
  REQUIRE(missed.answer.outcome == engine::Outcome::completed);
  CHECK(event_times(missed).empty());
  for (const auto& row : missed.rows) REQUIRE(std::abs(row[1] - (1.0 - excess) * std::sin(row[0])) <= 1e-12);
}

// Hard case 32: e^{−t} − 5(e^{−10⁹t} − e^{−2·10⁹t}) is negative between 0.3235 and 1.2859 ns only. Here the switch drives nothing.
TEST_CASE("32: two crossings a nanosecond apart in a run of one second", "[hard]") {
  TestCircuit c;
  c.c("a", "0", 1.0, 1.0);
  c.r("a", "0", 1.0);
  c.c("b", "0", 1e-9, 1.0);
  c.r("b", "0", 1.0);
  c.c("c", "0", 0.5e-9, 1.0);
  c.r("c", "0", 1.0);
  c.e("d", "0", "a", "0", 1.0);
  c.e("e", "d", "b", "0", -5.0);
  c.e("g", "e", "c", "0", 5.0);
  c.i("0", "h", model::Dc{1.0});
  c.r("h", "0", 1.0);
  c.s("h", "0", "0", "g", 0.0);
  c.save_v("h");
  const Run run = simulate(c.network(), {1.0, 1, true, true});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  REQUIRE(times.size() == 2);
  const auto root = [](long double low, long double high) {
    const auto g = [](long double t) { return std::exp(-t) - 5 * (std::exp(-1e9L * t) - std::exp(-2e9L * t)); };
    const bool falls = g(low) > 0;
    for (int i = 0; i < 100; ++i) {
      const long double middle = 0.5L * (low + high);
      ((g(middle) > 0) == falls ? low : high) = middle;
    }
    return static_cast<double>(low);
  };
  CHECK(times[0] == Approx(root(0.2e-9L, 0.5e-9L)).epsilon(1e-12));
  CHECK(times[1] == Approx(root(1.0e-9L, 2.0e-9L)).epsilon(1e-12));
  CHECK(times[0] == Approx(0.323507131e-9).epsilon(1e-8));
  CHECK(times[1] == Approx(1.285930783e-9).epsilon(1e-8));
}

// The diode sees sin t − 1 + δ: it conducts for 2√(2δ) around π/2, into nothing but a resistor.
TEST_CASE("a short conduction between two crossings close together", "[unit]") {
  const double delta = GENERATE(1e-3, 1e-6, 1e-9, 1e-11);
  INFO("delta " << delta);
  TestCircuit c;
  c.v("s", "0", sine());
  c.v("k", "0", model::Dc{1.0 - delta});
  c.r("s", "a", 1.0);
  c.d("a", "k");
  c.save_v("a");
  const Run run = simulate(c.network(), {3.0, 1, true, true});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  REQUIRE(times.size() == 2);
  const double first = std::asin(1.0 - delta), conditioning = 1e-15 / std::sqrt(2.0 * delta);
  CHECK(std::abs(times[0] - first) <= 10.0 * conditioning);
  CHECK(std::abs(times[1] - (pi - first)) <= 10.0 * conditioning);
}
