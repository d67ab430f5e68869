/// What counts as an event, and where rows stand around it.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using std::numbers::pi;

namespace {

constexpr double event_rounding = 1e-13;

model::Pulse pulse(double delay, double rise, double width, double period) {
  model::Pulse p;
  p.pulsed = 1.0;
  p.delay = delay;
  p.rise = p.fall = rise;
  p.width = width;
  p.period = period;
  return p;
}

TestCircuit loaded_source(const model::SourceFunction& function) {
  TestCircuit c;
  c.v("a", "0", function);
  c.r("a", "b", 1.0);
  c.c("b", "0", 1.0);
  c.save_v("a");
  return c;
}

}  // namespace

TEST_CASE("jumps of a source are events, corners are not", "[unit]") {
  const Run jumps = simulate(loaded_source(pulse(0.5, 0.0, 1.0, 2.0)).network(), {4.0, 4, true, true});
  CHECK(event_times(jumps) == std::vector<double>{0.5, 1.5, 2.5, 3.5});
  CHECK(jumps.answer.statistics.events == 4);
  const Run corners = simulate(loaded_source(pulse(0.5, 0.25, 1.0, 2.5)).network(), {4.0, 4, true, true});
  CHECK(event_times(corners).empty());
  CHECK(corners.answer.statistics.events == 0);
}

TEST_CASE("what happens at t = 0 is no event, what happens at the end is one", "[unit]") {
  const Run run = simulate(loaded_source(pulse(0.0, 0.0, 1.0, 2.0)).network(), {2.0, 4, true, true});
  CHECK(run.answer.statistics.events == 2);
  CHECK(event_times(run) == std::vector<double>{1.0, 2.0});
  CHECK(run.rows.back()[1] == 1.0);  // after the edge
  CHECK(run.rows.at(0)[1] == 1.0);
}

TEST_CASE("events before the first output time have no rows, but count", "[unit]") {
  const Run run = simulate(loaded_source(pulse(0.5, 0.0, 1.0, 2.0)).network(), {4.0, 2, true, true, 2.0});
  std::vector<double> times;
  for (const auto& row : run.rows) times.push_back(row[0]);
  CHECK(times == std::vector<double>{2.0, 2.5, 2.5, 3.0, 3.5, 3.5, 4.0});
  CHECK(run.answer.statistics.events == 4);
}

TEST_CASE("jumps of two sources at one instant are one event", "[unit]") {
  TestCircuit c = loaded_source(pulse(0.5, 0.0, 1.0, 2.0));
  c.v("d", "0", pulse(0.5, 0.0, 0.25, 2.0));
  c.r("d", "e", 1.0);
  c.c("e", "0", 1.0);
  c.save_v("d");
  const Run run = simulate(c.network(), {2.0, 4, true, true});
  CHECK(event_times(run) == std::vector<double>{0.5, 0.75, 1.5});
  CHECK(run.answer.statistics.events == 3);
}

TEST_CASE("rows around an event: before and after, on the grid once more than without", "[unit]") {
  const TestCircuit c = loaded_source(pulse(0.5, 0.0, 10.0, model::forever));
  const Run plain = simulate(c.network(), {1.0, 4, true, false});
  REQUIRE(plain.rows.size() == 5);
  CHECK(plain.at(1, 0) == 0.0);
  CHECK(plain.at(2, 0) == 1.0);
  const Run on_grid = simulate(c.network(), {1.0, 4, true, true});
  REQUIRE(on_grid.rows.size() == 6);
  CHECK(on_grid.at(2, 0) == 0.0);
  CHECK(on_grid.at(3, 0) == 1.0);
  CHECK(on_grid.rows[2][0] == 0.5);
  CHECK(on_grid.rows[3][0] == 0.5);
  const Run off_grid = simulate(c.network(), {1.0, 5, true, true});
  CHECK(off_grid.rows.size() == 8);
}

TEST_CASE("the row at t = 0 stands in runs of any length", "[unit]") {
  TestCircuit c;
  c.v("a", "0", model::Dc{1.0});
  c.r("a", "0", 1.0);
  c.save_v("a");
  const Run run = simulate(c.network(), {5e14, 5, true, true});
  REQUIRE(run.rows.size() == 6);
  CHECK(run.rows[0][0] == 0.0);
}

// |sin t| of an ideal bridge on a resistor: all four diodes change at π, 2π, 3π.
TEST_CASE("diodes that change together are one event", "[unit]") {
  TestCircuit c;
  c.v("p", "q", sine());
  c.d("p", "o");
  c.d("q", "o");
  c.d("0", "p");
  c.d("0", "q");
  c.r("o", "0", 1.0);
  c.save_v("o");
  const Run run = simulate(c.network(), {10.0, 10, true, true});
  const auto times = event_times(run);
  REQUIRE(times.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(times[i] == Approx((static_cast<double>(i) + 1.0) * pi).epsilon(event_rounding));
  CHECK(run.answer.statistics.events == 3);
  CHECK(run.answer.statistics.jumps == 0);
}

TEST_CASE("a diode beside a closed switch makes no events of its own", "[unit]") {
  TestCircuit c;
  c.v("g", "0", model::Dc{1.0});
  c.v("s", "0", sine());
  c.r("s", "a", 1.0);
  c.s("a", "0", "g", "0", 0.5);
  c.d("a", "0");
  c.save_v("a");
  const Run run = simulate(c.network(), {20.0, 20, true, true});
  CHECK(event_times(run).empty());
  CHECK(run.answer.statistics.events == 0);
}

// Half waves of sin t charge 1 F to 1 V at π/2; then nothing discharges it and nothing happens any more.
TEST_CASE("a peak detector without load has one event", "[unit]") {
  TestCircuit c;
  c.v("s", "0", sine());
  c.d("s", "a");
  c.c("a", "0", 1.0);
  c.save_v("a");
  const Run run = simulate(c.network(), {1.5 * pi, 30, true, true});
  const auto times = event_times(run);
  REQUIRE(times.size() == 1);
  CHECK(times[0] == Approx(pi / 2).epsilon(1e-12));
  for (const auto& row : run.rows) CHECK(row[1] == Approx(row[0] < pi / 2 ? std::sin(row[0]) : 1.0).epsilon(1e-12).margin(1e-15));
}

TEST_CASE("jumps of the state are counted apart", "[unit]") {
  TestCircuit c;
  c.v("s", "0", pulse(0.5, 0.0, 1.0, 2.0));
  c.c("s", "m", 1.0);
  c.c("m", "0", 3.0);
  c.r("m", "0", 1.0);
  c.save_v("m");
  const Run run = simulate(c.network(), {2.0, 4, true, true});
  CHECK(run.answer.statistics.events == 2);
  REQUIRE(event_times(run).size() == 2);
  CHECK(run.at(2, 0) == Approx(0.25).epsilon(event_rounding));  // a quarter of the step, charge conserved
}

// Rounding of event times, always the same way in a steady state, must not add up: 4,000 events later the source is where its formula has it.
TEST_CASE("a sinusoid keeps its phase over thousands of events", "[unit]") {
  constexpr double frequency = 50.0, amplitude = 325.0, rounding = 1e-14;
  TestCircuit c;
  c.v("in", "0", sine(amplitude, frequency));
  c.d("in", "out");
  c.r("out", "0", 10.0);
  c.c("out", "0", 1e-3);
  c.save_v("in");
  c.save_v("out");
  const Run run = simulate(c.network(), {40.0, 7, true, false});
  REQUIRE(run.errors.empty());
  CHECK(run.answer.statistics.events > 3990);
  for (const auto& row : run.rows) {
    const long double cycles = static_cast<long double>(frequency) * static_cast<long double>(row[0]);
    const long double expected = amplitude * std::sin(2.0L * std::numbers::pi_v<long double> * (cycles - std::floor(cycles)));
    CAPTURE(row[0]);
    CHECK(row[1] == Approx(static_cast<double>(expected)).margin(rounding * amplitude));
  }
}

// H(jω) = 1/(1 + jω/ω0)²: two equal eigenvalues with one eigenvector behind a slow source, so that events are located in the part that is left of the
// mode when they have died out.
TEST_CASE("events of a slow source behind critically damped parts a thousand times faster", "[unit]") {
  const double omega = 2.0 * pi * 50.0, omega0 = 1e6;
  TestCircuit c;
  c.v("a", "0", model::Sin{.amplitude = 1.0, .frequency = 50.0});
  c.r("a", "b", 2.0);
  c.l("b", "o", 1.0 / omega0);
  c.c("o", "0", 1.0 / omega0);
  c.v("d", "0", model::Dc{1.0});
  c.s("q", "0", "o", "0", 0.5);
  c.r("d", "q", 1.0);
  c.save_v("q");
  const Run run = simulate(c.network(), {0.04, 4, true, true});
  const double phase = 2.0 * std::atan(omega / omega0), size = 1.0 / (1.0 + std::pow(omega / omega0, 2.0));
  const double rises = std::asin(0.5 / size);
  std::vector<double> expected;
  for (const int period : {0, 1})
    for (const double angle : {rises, pi - rises}) expected.push_back((angle + phase + 2.0 * pi * period) / omega);
  const std::vector<double> times = event_times(run);
  REQUIRE(times.size() == expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) CHECK(std::abs(times[i] - expected[i]) <= 10.0 * event_rounding * expected[i]);
}
