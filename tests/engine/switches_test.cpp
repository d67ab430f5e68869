/// Switches that act together, on charged capacitors, on inductors, and at the very instant at which a diode would.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double switching_rounding = 1e-13;

model::Pulse clock(double delay, double width, double period) {
  model::Pulse pulse;
  pulse.pulsed = 1.0;
  pulse.delay = delay;
  pulse.width = width;
  pulse.period = period;
  return pulse;
}

/// Rows as the output has them: one a grid time, the value after what happens there.
Run run_grid(const TestCircuit& c, double stop, std::uint64_t steps, bool uic = true) {
  Run run = simulate(c.network(), {stop, steps, uic, false});
  INFO(run.errors << run.answer.message);
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  return run;
}

}  // namespace

// Two switches in series across an ideal source: were one to close before the other opens, no solution would exist.
TEST_CASE("two switches of a half bridge change together", "[unit]") {
  const double rise = GENERATE(0.0, 0.05);
  TestCircuit c;
  c.v("in", "0", model::Dc{10.0});
  model::Pulse gate = clock(0.1, 0.4, 1.0);
  gate.rise = gate.fall = rise;
  c.v("g", "0", gate);
  c.v("half", "0", model::Dc{0.5});
  c.s("in", "m", "g", "half", 0.0);
  c.s("m", "0", "half", "g", 0.0);
  c.r("m", "0", 5.0);
  c.save_v("m");
  const Run run = run_grid(c, 3.0, 300);
  CHECK(run.answer.statistics.events == 6);
  for (const auto& row : run.rows) {
    const double phase = row[0] - std::floor(row[0]);
    const double on = 0.1 + rise / 2, off = 0.5 + rise + rise / 2;
    if (std::abs(phase - on) < 1e-9 || std::abs(phase - off) < 1e-9) continue;
    INFO("t = " << row[0]);
    CHECK(row[1] == Approx(phase > on && phase < off ? 10.0 : 0.0).margin(switching_rounding));
  }
}

TEST_CASE("switches of several islands that one ramp drives pass at one instant", "[unit]") {
  TestCircuit c;
  model::Pwl ramp;
  ramp.points = {{0.0, 0.0}, {1.0, 1.0}};
  c.v("g", "0", ramp);
  for (const auto* node : {"a", "b", "d"}) {
    c.i("0", node, model::Dc{1.0});
    c.r(node, "0", 2.0);
    c.s(node, "0", "g", "0", 0.3);
    c.save_v(node);
  }
  const Run run = run_grid(c, 1.0, 10);
  CHECK(run.answer.statistics.events == 1);
  for (std::size_t signal = 0; signal < 3; ++signal) {
    CHECK(run.at(2, signal) == Approx(2.0));
    CHECK(run.at(4, signal) == Approx(0.0).margin(switching_rounding));
  }
}

// Charge is conserved, two thirds of the energy are lost (hard case 19 with a switch for the diode).
TEST_CASE("a switch closes across charged capacitors", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 1.0, 3.0);
  c.c("b", "0", 2.0, 0.0);
  c.v("g", "0", clock(0.5, 10.0, model::forever));
  c.s("a", "b", "g", "0", 0.5);
  c.save_v("a");
  c.save_v("b");
  const Run run = run_grid(c, 1.0, 4);
  CHECK(run.at(1, 0) == Approx(3.0));
  CHECK(run.at(1, 1) == 0.0);
  for (const std::size_t row : {2U, 3U, 4U}) {  // the row at the edge itself holds the values after it
    CHECK(run.at(row, 0) == Approx(1.0).epsilon(switching_rounding));
    CHECK(run.at(row, 1) == Approx(1.0).epsilon(switching_rounding));
  }
  CHECK(run.answer.statistics.events == 1);
  CHECK(run.answer.statistics.jumps == 1);
}

TEST_CASE("a switch shorts a capacitor, and one puts a source across it", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{7.0});
  c.c("a", "0", 1e-6, 0.0);
  c.v("g", "0", clock(0.25, 0.25, 1.0));
  c.v("h", "0", clock(0.75, 0.125, 1.0));
  c.s("in", "a", "g", "0", 0.5);
  c.s("a", "0", "h", "0", 0.5);
  c.save_v("a");
  const Run run = run_grid(c, 1.0, 8);
  const double expected[] = {0.0, 0.0, 7.0, 7.0, 7.0, 7.0, 0.0, 0.0, 0.0};
  for (std::size_t row = 0; row <= 8; ++row) {
    INFO("row " << row);
    CHECK(run.at(row, 0) == Approx(expected[row]).margin(switching_rounding));
  }
  CHECK(run.answer.statistics.jumps == 2);
  CHECK(run.answer.statistics.events == 4);
}

// The source reads i = 2 A after 1 s of 2 V on 1 H; then nothing lets the current flow and it is gone.
TEST_CASE("a switch opens an inductor that has no other way", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{2.0});
  c.v("g", "0", clock(0.0, 1.0, model::forever));
  c.s("in", "a", "g", "0", 0.5);
  const int l = c.l("a", "0", 1.0);
  c.save_i_l(l);
  const Run run = run_grid(c, 2.0, 4);
  CHECK(run.at(1, 0) == Approx(1.0));
  CHECK(run.at(2, 0) == Approx(0.0).margin(switching_rounding));
  CHECK(run.at(4, 0) == Approx(0.0).margin(switching_rounding));
  CHECK(run.answer.statistics.jumps == 1);
}

// 1 V across 1 H for 1 s, then −1 V for 1 s: the current is back at zero at the very instant at which the switch closes again.
TEST_CASE("a current reaches zero exactly on a switch edge", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{2.0});
  c.v("g", "0", clock(0.0, 1.0, 2.0));
  c.s("in", "sw", "g", "0", 0.5);
  c.d("0", "sw");
  const int l = c.l("sw", "out", 1.0);
  c.v("out", "0", model::Dc{1.0});
  c.save_i_l(l);
  const Run run = run_grid(c, 20.0, 80);
  for (const auto& row : run.rows) {
    const double phase = std::fmod(row[0], 2.0);
    INFO("t = " << row[0]);
    CHECK(row[1] == Approx(1.0 - std::abs(phase - 1.0)).margin(1e-12));
  }
  CHECK(run.answer.statistics.events == 20);  // 1, 2, …, 20 s: the diode's end and the switch's edge are one
}

// The band is 1 V ± 0.25 V around the capacitor's voltage: it runs up and down between the levels with slopes ±1 V/s.
TEST_CASE("hysteresis: a relaxation oscillator keeps its period", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 1.0, 0.0);
  c.i("0", "a", model::Dc{1.0});
  c.i("d", "0", model::Dc{2.0});  // the switch takes 2 A out of the node while it is closed, else the diode carries them
  c.s("a", "d", "a", "0", 1.0, 0.25);
  c.d("0", "d");
  c.save_v("a");
  const Run run = run_grid(c, 10.25, 41);
  for (const auto& row : run.rows) {
    const double t = row[0];
    const double phase = std::fmod(t - 1.25, 1.0);
    const double expected = t <= 1.25 ? t : phase < 0.5 ? 1.25 - phase : 0.25 + phase;
    INFO("t = " << t);
    CHECK(row[1] == Approx(expected).margin(1e-12));
  }
  CHECK(run.answer.statistics.events == 19);  // 1.25, 1.75, … , 10.25
}

TEST_CASE("inside the band the flag decides the start, outside the control", "[unit]") {
  const auto [control, flag, closed] =
      GENERATE(table<double, bool, bool>({{1.0, false, false}, {1.0, true, true}, {2.0, false, true}, {0.0, true, false}}));
  INFO("control " << control << ", flag " << flag);
  TestCircuit c;
  c.v("g", "0", model::Dc{control});
  c.v("in", "0", model::Dc{6.0});
  c.r("in", "a", 1.0);
  c.s("a", "0", "g", "0", 1.0, 0.25, flag);
  c.save_v("a");
  for (const bool uic : {false, true}) CHECK(run_grid(c, 1.0, 1, uic).at(0, 0) == Approx(closed ? 0.0 : 6.0).margin(switching_rounding));
}

// A chain: the first switch raises the control of the second at once. No state between is simulated, and all is one event.
TEST_CASE("a switch that drives a switch", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{1.0});
  c.v("g", "0", clock(0.5, 10.0, model::forever));
  c.s("in", "a", "g", "0", 0.5);
  c.r("a", "0", 1.0);
  c.s("in", "b", "a", "0", 0.5);
  c.r("b", "0", 1.0);
  c.s("in", "d", "b", "0", 0.5);
  c.r("d", "0", 1.0);
  for (const auto* node : {"a", "b", "d"}) c.save_v(node);
  const Run run = run_grid(c, 1.0, 4);
  for (std::size_t signal = 0; signal < 3; ++signal) {
    CHECK(run.at(1, signal) == Approx(0.0).margin(switching_rounding));
    CHECK(run.at(2, signal) == Approx(1.0));
  }
  CHECK(run.answer.statistics.events == 1);
}

namespace {

model::Pulse trapezoid(double cycles = model::forever) {
  model::Pulse pulse = clock(0.25, 0.3, 1.0);
  pulse.rise = 0.1;
  pulse.fall = 0.2;
  pulse.cycles = cycles;
  return pulse;
}

model::Pwl through(std::vector<model::Pwl::Point> points) {
  model::Pwl pwl;
  pwl.points = std::move(points);
  return pwl;
}

struct GateCase {
  model::SourceFunction gate;
  double threshold, time_on;
  std::uint64_t events;
};

}  // namespace

// While the switch is on, C = 1 F charges from 10 V through 2 Ohm: v = 10 (1 − exp(−t_on/2)). A gate that nothing else reads has corners that are
// no instants of the run, unless the switch sees them.
TEST_CASE("a switch follows the corners of its gate, whether anything else reads the gate or not", "[unit]") {
  const auto c =
      GENERATE(GateCase{trapezoid(), 0.5, 4 * 0.45, 8}, GateCase{trapezoid(2.0), 0.5, 2 * 0.45, 4},
               GateCase{trapezoid(), 1.0, 0.0, 0},      // reaches the threshold, and does not pass it
               GateCase{trapezoid(), 0.0, 4 * 0.6, 8},  // rests at the threshold, where the switch is off
               GateCase{through({{0, 0}, {0.5, 0.5}, {1, 2}, {2, 0.5}, {3, 0}}), 0.5, 1.5, 2},  // passes at corners
               GateCase{through({{0, 0}, {1, 0.5}, {2, 0}}), 0.5, 0.0, 0}, GateCase{through({{0, 1}, {1, 0.5}, {2, 1}}), 0.5, 4.0, 0});
  const bool is_read = GENERATE(false, true);
  CAPTURE(c.threshold, c.time_on, is_read);
  TestCircuit circuit;
  circuit.v("in", "0", model::Dc{10.0});
  circuit.v("g", "0", c.gate);
  circuit.s("in", "m", "g", "0", c.threshold);
  circuit.r("m", "out", 2.0);
  circuit.c("out", "0", 1.0);
  circuit.save_v("out");
  if (is_read) circuit.save_v("g");
  const Run run = run_grid(circuit, 4.0, 4);
  CHECK(run.answer.statistics.events == c.events);
  CHECK(run.at(4, 0) == Approx(-10.0 * std::expm1(-c.time_on / 2.0)).epsilon(switching_rounding).margin(switching_rounding));
}
