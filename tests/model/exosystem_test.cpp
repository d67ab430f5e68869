/// Sources as an autonomous system, against their formulas in time.
#include "model/exosystem.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "linalg/exponential.hpp"

using namespace pwlsim;
using namespace pwlsim::model;
using std::numbers::pi;

namespace {

constexpr double rounding = 1e-15;
constexpr double unit_in_last_place = 2.3e-16;

/// One or more sources followed through time.
class Player {
 public:
  explicit Player(std::vector<SourceFunction> functions) : system_(functions, false), phase_(system_.start()) {}

  /// Every breakpoint up to and including `time`; whether one of them was a jump.
  bool advance(double time) {
    bool jumped = false;
    while (phase_.next <= time) jumped |= system_.advance(phase_, phase_.next, 0.0);
    return jumped;
  }
  [[nodiscard]] double value(double time, int source = 0) const { return system_.rows().row(source).dot(zeta(time)); }
  double right(double time, int source = 0) {
    advance(time);
    return value(time, source);
  }
  [[nodiscard]] linalg::Vector zeta(double time) const {
    linalg::Vector z = linalg::Vector::Zero(system_.size());
    system_.evaluate(phase_, time, z.data());
    return z;
  }
  [[nodiscard]] double next() const { return phase_.next; }
  [[nodiscard]] const Exosystem& system() const { return system_; }

 private:
  Exosystem system_;
  Exosystem::Phase phase_;
};

Pulse square(double delay, double width, double period) {
  Pulse pulse;
  pulse.initial = -1.0;
  pulse.pulsed = 2.0;
  pulse.delay = delay;
  pulse.width = width;
  pulse.period = period;
  return pulse;
}

/// Within segments ζ must obey ζ' = A ζ: the formula at t + h against the exponential from t.
void check_flow(Player& player, double from, double h) {
  player.advance(from);
  REQUIRE(player.next() > from + h);
  const linalg::Exponential flow(player.system().a(), linalg::norm_bound(player.system().a()));
  const linalg::Vector expected = player.zeta(from + h);
  const linalg::Vector start = player.zeta(from);
  const linalg::Vector propagated = start + flow.minus_identity(h) * start;
  CHECK((propagated - expected).norm() <= 100 * rounding * (1.0 + expected.norm()));
}

}  // namespace

TEST_CASE("constants need one state", "[unit]") {
  Player player({Dc{3.0}, Dc{-2.0}, Dc{0.0}});
  CHECK(player.system().size() == 1);
  CHECK(player.value(7.0, 0) == 3.0);
  CHECK(player.value(7.0, 1) == -2.0);
  CHECK(player.value(7.0, 2) == 0.0);
  CHECK(player.next() == forever);
}

// 3;  1 + 2 sin(100π t);  −1 + 6 (t − 1) on the rise of a pulse;  and their derivatives.
TEST_CASE("values and slopes of several sources at once", "[unit]") {
  Sin sine;
  sine.offset = 1.0;
  sine.amplitude = 2.0;
  sine.frequency = 50.0;
  Pulse pulse = square(1.0, 2.0, 10.0);
  pulse.rise = 0.5;
  Player player({Dc{3.0}, sine, pulse});
  player.advance(1.0);
  const double t = 1.253;
  const linalg::Vector zeta = player.zeta(t), w = player.system().values(zeta);
  const linalg::Vector slope = player.system().values(player.system().rates(zeta));
  REQUIRE(w.size() == 3);
  CHECK(w[0] == 3.0);
  CHECK(w[1] == Approx(1.0 + 2.0 * std::sin(100.0 * pi * t)).epsilon(1e-12));
  CHECK(w[2] == Approx(-1.0 + 6.0 * (t - 1.0)).epsilon(1e-12));
  CHECK(slope[0] == 0.0);
  CHECK(slope[1] == Approx(200.0 * pi * std::cos(100.0 * pi * t)).epsilon(1e-12));
  CHECK(slope[2] == Approx(6.0).epsilon(1e-12));
}

TEST_CASE("a pulse before and after its first jump at zero", "[unit]") {
  Player player({square(0.0, 4.0, 10.0)});
  CHECK(player.value(0.0) == -1.0);  // left limit
  CHECK(player.next() == 0.0);
  CHECK(player.advance(0.0));
  CHECK(player.value(0.0) == 2.0);
  CHECK(player.next() == 4.0);
  CHECK(player.right(4.0) == -1.0);
  CHECK(player.next() == 10.0);
}

// Edge n stands at delay + n·period: the product is rounded once, nothing is accumulated.
TEST_CASE("a million periods do not drift", "[unit]") {
  const double delay = 1e-7, width = 4.5e-6, period = 1e-5;
  Player player({square(delay, width, period)});
  for (const int n : {0, 1, 2, 3, 1000, 99'999, 1'000'000}) {
    INFO("edge " << n);
    player.advance(std::nextafter(delay + n * period, 0.0));
    const auto rising =
        static_cast<double>(static_cast<long double>(delay) + static_cast<long double>(n) * static_cast<long double>(period));
    CHECK(std::abs(player.next() - rising) <= unit_in_last_place * rising);
    CHECK(player.advance(player.next()));
    CHECK(std::abs(player.next() - (rising + width)) <= 2 * unit_in_last_place * (rising + width));
  }
}

TEST_CASE("a pulse with ramps", "[unit]") {
  Pulse pulse = square(1.0, 2.0, 10.0);
  pulse.rise = 0.5;
  pulse.fall = 1.0;
  Player player({pulse});
  CHECK(player.right(0.9) == -1.0);
  CHECK_FALSE(player.advance(1.0));  // a corner is no jump
  CHECK(player.value(1.25) == Approx(0.5));
  CHECK(player.right(1.5) == 2.0);
  CHECK(player.right(3.5) == Approx(2.0));
  CHECK(player.right(4.0) == Approx(0.5));
  CHECK(player.right(4.5) == Approx(-1.0));
  CHECK(player.right(11.25) == Approx(0.5));
  Player again({pulse});
  check_flow(again, 1.0, 0.4);
  check_flow(again, 3.6, 0.7);
}

TEST_CASE("a single pulse, a pulse without end, and a counted one", "[unit]") {
  Player single({square(1.0, 2.0, forever)});
  CHECK(single.right(1.0) == 2.0);
  CHECK(single.right(3.0) == -1.0);
  CHECK(single.next() == forever);

  Player endless({square(1.0, forever, forever)});
  CHECK(endless.right(1.0) == 2.0);
  CHECK(endless.next() == forever);
  CHECK(endless.value(1e9) == 2.0);

  Pulse pulse = square(1.0, 2.0, 5.0);
  pulse.cycles = 2.0;
  Player counted({pulse});
  CHECK(counted.right(6.5) == 2.0);
  CHECK(counted.right(8.5) == -1.0);
  CHECK(counted.right(11.5) == -1.0);
  CHECK(counted.next() == forever);
}

TEST_CASE("a negative delay starts in the middle of a pulse", "[unit]") {
  Player player({square(-1.0, 3.0, 10.0)});
  CHECK(player.value(0.0) == 2.0);
  CHECK(player.next() == 2.0);
  CHECK(player.right(9.0) == 2.0);
  Player late({square(-1'000'001.0, 3.0, 10.0)});  // 100,000 periods and 1 s ago
  CHECK(late.value(0.0) == 2.0);
  CHECK(late.next() == 2.0);
}

TEST_CASE("corner points, and two at one time", "[unit]") {
  Pwl pwl;
  pwl.points = {{1.0, 0.0}, {2.0, 4.0}, {2.0, 1.0}, {4.0, 1.0}, {5.0, -1.0}};
  Player player({pwl});
  CHECK(player.right(0.5) == 0.0);
  CHECK_FALSE(player.advance(1.0));
  CHECK(player.value(1.75) == Approx(3.0));
  CHECK(player.advance(2.0));
  CHECK(player.value(2.0) == 1.0);
  CHECK(player.right(3.0) == 1.0);
  CHECK(player.right(4.5) == Approx(0.0).margin(rounding));
  CHECK(player.right(100.0) == -1.0);
  CHECK(player.next() == forever);
}

TEST_CASE("a repeated part of a polyline", "[unit]") {
  Pwl pwl;
  pwl.points = {{0.0, 0.0}, {1.0, 2.0}, {3.0, -2.0}};
  pwl.repeats = 2.0;
  pwl.repeat_from = 1.0;  // the part from (1, 2) to (3, −2), a jump back at its end
  Player player({pwl});
  const auto once = [](double t) { return t <= 1.0 ? 2.0 * t : 4.0 - 2.0 * t; };
  CHECK(player.right(0.5) == Approx(once(0.5)));
  CHECK(player.right(2.25) == Approx(once(2.25)));
  CHECK(player.advance(3.0));
  CHECK(player.value(3.0) == 2.0);
  CHECK(player.right(4.5) == Approx(once(2.5)));
  CHECK(player.advance(5.0));
  CHECK(player.right(5.25) == Approx(once(1.25)));
  CHECK(player.right(7.0) == Approx(-2.0));
  CHECK(player.right(50.0) == Approx(-2.0));
  CHECK(player.next() == forever);
}

TEST_CASE("a polyline repeated forever does not drift", "[unit]") {
  Pwl pwl;
  pwl.points = {{0.0, 0.0}, {0.05, 1.0}, {0.1, 0.0}};
  pwl.repeats = forever;
  Player player({pwl});
  CHECK(player.right(1000.025) == Approx(0.5).epsilon(1e-9));  // 10,000 periods and a quarter
  CHECK(std::abs(player.next() - 1000.05) <= 2 * unit_in_last_place * 1000.05);
}

TEST_CASE("undelayed sines of one frequency share two states", "[unit]") {
  Sin a, b;
  a.amplitude = 3.0;
  a.frequency = b.frequency = 50.0;
  b.amplitude = 2.0;
  b.phase = pi / 3;
  b.offset = 1.0;
  Player player({a, b});
  CHECK(player.system().size() == 3);  // with the constant
  for (const double t : {0.0, 0.0031, 0.7654321}) {
    INFO("t " << t);
    CHECK(player.value(t, 0) == Approx(3.0 * std::sin(100.0 * pi * t)).margin(3e-13));
    CHECK(player.value(t, 1) == Approx(1.0 + 2.0 * std::sin(100.0 * pi * t + pi / 3)).margin(3e-13));
  }
  check_flow(player, 0.001, 0.004);
}

// An eighth of a period after 50 million whole ones. The neighbouring doubles of that time are 1.2e-10 s, 4e-8 rad away.
TEST_CASE("a late sine is as exact as its time", "[unit]") {
  Sin sine;
  sine.amplitude = 1.0;
  sine.frequency = 50.0;
  Player player({sine});
  const double t = 1e6 + 0.0025;
  const double rest = t - 1e6;  // exact
  CHECK(std::abs(player.value(t) - std::sin(100.0 * pi * rest)) <= 4e-8);
}

TEST_CASE("a burst waits at its starting value, rings, and returns to it", "[unit]") {
  Sin sine;
  sine.offset = 1.0;
  sine.amplitude = 2.0;
  sine.frequency = 0.5;
  sine.delay = 3.0;
  sine.damping = 0.1;
  sine.phase = pi / 6;
  sine.cycles = 1.25;
  Player player({sine});
  const double rest = 1.0 + 2.0 * std::sin(pi / 6);
  CHECK(player.right(0.0) == Approx(rest).epsilon(rounding));
  CHECK(player.right(2.9) == Approx(rest).epsilon(rounding));
  CHECK(player.next() == 3.0);
  CHECK_FALSE(player.advance(3.0));  // it starts where it waited
  for (const double age : {0.0, 0.3, 1.9})
    CHECK(player.value(3.0 + age) == Approx(1.0 + 2.0 * std::exp(-0.1 * age) * std::sin(pi * age + pi / 6)).epsilon(1e-14));
  CHECK(player.next() == 5.5);  // 1.25 periods of 2 s
  CHECK(player.advance(5.5));   // falls back from another phase
  CHECK(player.value(5.5) == Approx(rest).epsilon(rounding));
  Player flowing({sine});
  check_flow(flowing, 3.0, 2.0);
}

TEST_CASE("whole undamped cycles end without a jump", "[unit]") {
  Sin sine;
  sine.amplitude = 2.0;
  sine.frequency = 0.5;
  sine.cycles = 3.0;
  Player player({sine});
  CHECK_FALSE(player.advance(0.0));
  CHECK(player.value(1.5) == Approx(-2.0));
  CHECK_FALSE(player.advance(6.0));
  CHECK(player.value(6.5) == Approx(0.0).margin(rounding));
}

TEST_CASE("rise and decay of exponentials", "[unit]") {
  const Exp exp{1.0, 5.0, 2.0, 0.5, 4.0, 3.0};
  Player player({exp});
  const auto expected = [](double t) {
    double v = 1.0;
    if (t >= 2.0) v += 4.0 * -std::expm1(-(t - 2.0) / 0.5);
    if (t >= 4.0) v -= 4.0 * -std::expm1(-(t - 4.0) / 3.0);
    return v;
  };
  for (const double t : {0.0, 1.9, 2.0, 2.3, 3.999, 4.0, 4.5, 20.0}) {
    INFO("t " << t);
    CHECK_FALSE(player.advance(t));
    CHECK(player.value(t) == Approx(expected(t)).epsilon(1e-14));
  }
  Player flowing({exp});
  check_flow(flowing, 2.1, 1.7);
}

TEST_CASE("bounds of derivatives hold and are not far off", "[unit]") {
  Sin sine;
  sine.amplitude = 1.0;
  sine.frequency = 2.0;
  sine.damping = -0.5;  // grows
  sine.delay = 0.0;
  sine.cycles = 1e9;
  Player player({sine});
  player.advance(0.0);
  const double h = 0.3;
  for (const auto& block : player.system().blocks()) {
    if (block.kind != Exosystem::Block::Kind::oscillation) continue;
    linalg::Vector zeta = player.zeta(0.1);
    linalg::Matrix power = linalg::Matrix::Identity(zeta.size(), zeta.size());
    for (int order = 0; order < 4; ++order) {
      double largest = 0.0;
      for (int i = 0; i <= 100; ++i) largest = std::max(largest, (power * player.zeta(0.1 + h * i / 100.0)).segment(block.first, 2).norm());
      const double bound = block.derivative_bound(zeta.data(), order, h);
      INFO("order " << order);
      CHECK(bound >= largest * (1.0 - 1e-12));
      CHECK(bound <= 2.0 * largest);
      power = power * player.system().a();
    }
  }
}

TEST_CASE("breakpoints within the tolerance are taken together", "[unit]") {
  const Exosystem system({square(1.0, 2.0, 10.0), square(1.0 + 1e-13, 2.0, 10.0)}, false);
  auto phase = system.start();
  CHECK(phase.next == 1.0);
  CHECK(system.advance(phase, 1.0, 1e-12));
  CHECK(phase.next == 3.0);
}

TEST_CASE("tracks whose segments meet are continuous", "[unit]") {
  Pulse trapezoid = square(0.5, 1.0, 3.0);
  trapezoid.rise = 0.1;
  Pulse steep_end = trapezoid;
  trapezoid.fall = 0.3;
  Pulse once = trapezoid;
  once.cycles = 1.0;
  Pwl corners, step;
  corners.points = {{0.1, 0.2}, {0.3, 0.7}, {0.7, -0.1}};
  step.points = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}};
  CHECK(make_track(trapezoid).is_continuous());
  CHECK(make_track(once).is_continuous());
  CHECK(make_track(corners).is_continuous());
  CHECK_FALSE(make_track(square(0.5, 1.0, 3.0)).is_continuous());
  CHECK_FALSE(make_track(steep_end).is_continuous());
  CHECK_FALSE(make_track(step).is_continuous());
}
