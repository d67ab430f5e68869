/// Switches that only sources drive, against the times at which the sources' formulas meet the thresholds.
#include "model/clock.hpp"

#include <catch2/catch.hpp>

using namespace pwlsim::model;

namespace {

constexpr double tolerance = 1e-14;  ///< s, of breakpoints that are one; runs here last about a second
/// Of a time in extended precision, as a fraction of it.
constexpr long double wide_rounding = 1e-18L;

/// A part without states whose one control reads the sum of its sources.
System part(std::vector<SourceFunction> sources, double on_level, double off_level) {
  System system;
  auto exosystem = std::make_shared<Exosystem>(sources, true);
  system.n_zeta = exosystem->size();
  Control control;
  control.value.state = exosystem->rows().colwise().sum().transpose();
  control.driven = 7;
  control.on_level = on_level;
  control.off_level = off_level;
  system.controls.push_back(control);
  system.exosystem = std::move(exosystem);
  return system;
}

Clock started(const System& system, bool is_on) {
  Clock clock(system, system.controls[0], tolerance);
  clock.start(is_on);
  return clock;
}

/// The next flip, and whether it falls on a jump.
Clock::Instant flip(Clock& clock) {
  while (!clock.next().flips && clock.next().time < forever) clock.take();
  const Clock::Instant instant = clock.next();
  clock.take();
  return instant;
}

Pulse trapezoid() {
  Pulse pulse;
  pulse.initial = 1.0;
  pulse.pulsed = 5.0;
  pulse.delay = 0.003;
  pulse.rise = 1e-4;
  pulse.fall = 2e-4;
  pulse.width = 4e-4;
  pulse.period = 1e-3;
  return pulse;
}

}  // namespace

TEST_CASE("a clock flips where a trapezoid crosses its thresholds", "[unit]") {
  // Rising: v = 1 + 4·s/rise, at 3.5 where s = 0.625 rise. Falling: v = 5 − 4·s/fall, at 1.5 where s = 0.875 fall.
  const System system = part({trapezoid()}, 3.5, 1.5);
  Clock clock = started(system, false);
  CHECK(clock.driven() == 7);
  for (int n = 0; n < 900; ++n) {
    const long double start = static_cast<long double>(0.003) + n * static_cast<long double>(1e-3);  // the doubles that the source is told
    const Clock::Instant on = flip(clock);
    const Clock::Instant off = flip(clock);
    INFO(n);
    CHECK_FALSE(on.is_edge);
    const long double exact = start + 0.625L * static_cast<long double>(1e-4);
    CHECK(static_cast<double>(std::abs(on.time + static_cast<long double>(on.late) - exact)) <= 1e-16 * 1e-4 + wide_rounding * exact);
    CHECK(off.time == Approx(0.003 + n * 1e-3 + 1e-4 + 4e-4 + 0.875 * 2e-4).epsilon(1e-15));
  }
}

TEST_CASE("edges of a clock keep what rounding takes off n periods", "[unit]") {
  Pulse gate;
  gate.pulsed = 1.0;
  gate.width = 4.5e-6;
  gate.period = 1e-5;
  const System system = part({gate}, 0.5, 0.5);
  Clock clock = started(system, false);
  CHECK(clock.next().time == 0.0);
  for (int n = 0; n < 20000; ++n) {
    const Clock::Instant on = flip(clock);
    const Clock::Instant off = flip(clock);
    const long double edge = static_cast<long double>(n) * static_cast<long double>(1e-5);
    CHECK(on.time == n * 1e-5);
    CHECK(static_cast<double>(std::abs(on.time + static_cast<long double>(on.late) - edge)) <= wide_rounding * edge);
    CHECK(static_cast<double>(std::abs(off.time + static_cast<long double>(off.late) - (edge + static_cast<long double>(4.5e-6)))) <=
          wide_rounding * (edge + 4.5e-6L));
    if (n > 0) CHECK(on.is_edge);
    CHECK(off.is_edge);
  }
}

TEST_CASE("a source that touches its threshold flips nothing, one that goes on through it does", "[unit]") {
  Pwl touch, through;
  touch.points = {{0.1, 0.0}, {0.3, 2.0}, {0.5, 0.0}};
  through.points = {{0.1, 0.0}, {0.3, 2.0}, {0.7, 2.0}, {0.8, 3.0}};
  Clock touching = started(part({touch}, 2.0, 1.0), false);
  CHECK(flip(touching).time == forever);
  const System behind = part({through}, 2.0, 1.0);
  Clock passing = started(behind, false);
  CHECK(flip(passing).time == 0.7);  // on the threshold from 0.3 on, above it from 0.7 on
  CHECK(flip(passing).time == forever);
}

TEST_CASE("a clock that compares a carrier with a stepped reference", "[unit]") {
  // Carrier up from 0 to 1 within 10 ms and down at once, minus a reference of 0.3, from 25 ms on of 0.8: above it after 3, 13, 28, 38 ms …
  Pulse carrier;
  carrier.pulsed = 1.0;
  carrier.rise = carrier.period = 1e-2;
  carrier.width = 0.0;
  Pwl reference;
  reference.points = {{0.025, -0.3}, {0.025, -0.8}};
  const System system = part({carrier, reference}, 0.0, 0.0);
  Clock clock = started(system, false);
  const double expected[] = {3e-3, 10e-3, 13e-3, 20e-3, 23e-3, 25e-3, 28e-3, 30e-3, 38e-3, 40e-3};
  for (const double time : expected) CHECK(flip(clock).time == Approx(time).epsilon(1e-15));
}

TEST_CASE("a switch on the wrong side at the start flips at once, a constant one never", "[unit]") {
  const System system = part({Dc{5.0}}, 2.0, 1.0);
  Clock off = started(system, false);
  CHECK(off.next().time == 0.0);
  CHECK(off.next().flips);
  off.take();
  CHECK(off.next().time == forever);
  CHECK(started(system, true).next().time == forever);
}

TEST_CASE("a source that never reaches its threshold gives empty instants, far apart", "[unit]") {
  Pulse low = trapezoid();
  low.pulsed = 2.0;
  const System system = part({low}, 3.5, 1.5);
  Clock clock = started(system, false);
  CHECK_FALSE(clock.next().flips);
  CHECK_FALSE(clock.next().is_edge);
  CHECK(clock.next().time > 0.2);  // four corners a millisecond
  CHECK(clock.next().time < 0.3);
}

TEST_CASE("jumps of a source that flip nothing are instants", "[unit]") {
  Pwl step;
  step.points = {{0.5, 0.0}, {0.5, 1.0}};
  Clock clock = started(part({step}, 3.5, 1.5), false);
  CHECK(clock.next().time == 0.5);
  CHECK(clock.next().is_edge);
  CHECK_FALSE(clock.next().flips);
}
