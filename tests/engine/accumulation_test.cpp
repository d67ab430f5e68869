/// When a sequence of events is an accumulation, and where it ends.
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/exact/accumulation.hpp"

using namespace pwlsim;

namespace {

constexpr double limit_rounding = 1e-13;

/// Events at t_k = 1 - w_k ratio^floor(k/2), two an interval pair, the state going to 3 as 3 - (1 - t)^2.
void geometric(engine::AccumulationWatch& watch, double ratio, int events) {
  for (int k = 0; k < events; ++k) {
    const double ahead = (k % 2 == 0 ? 1.0 : 0.8) * std::pow(ratio, k / 2);
    const double x = 3.0 - ahead * ahead;
    watch.note(1.0 - ahead, k % 2, &x, 1);
  }
}

}  // namespace

TEST_CASE("a geometric sequence of events has its limit at the sum of the series", "[unit]") {
  for (const double ratio : {0.1, 0.5, 0.9}) {
    INFO("ratio " << ratio);
    engine::AccumulationWatch watch;
    geometric(watch, ratio, 16);
    const auto limit = watch.limit();
    REQUIRE(limit);
    CHECK(limit->period == 2);
    CHECK(limit->ratio == Approx(ratio).epsilon(1e-6));
    CHECK(limit->time == Approx(1.0).epsilon(limit_rounding / (1.0 - ratio)));
    CHECK(limit->uncertainty <= limit_rounding / (1.0 - ratio));
    REQUIRE(limit->xi.size() == 1);
    CHECK(limit->xi[0] == Approx(3.0).epsilon(limit_rounding / (1.0 - ratio)));
  }
}

TEST_CASE("a clock is no accumulation, nor are a few short intervals, nor ever new modes", "[unit]") {
  const double x = 0.0;
  engine::AccumulationWatch clock;
  for (int k = 0; k < 40; ++k) clock.note(k, k % 2, &x, 1);
  CHECK_FALSE(clock.limit());

  engine::AccumulationWatch few;
  geometric(few, 0.5, 11);
  CHECK_FALSE(few.limit());

  engine::AccumulationWatch changing;
  for (int k = 0; k < 40; ++k) changing.note(1.0 - std::pow(0.8, k), static_cast<std::uintptr_t>(k), &x, 1);
  CHECK_FALSE(changing.limit());
}

TEST_CASE("an event from outside begins the count anew", "[unit]") {
  engine::AccumulationWatch watch;
  geometric(watch, 0.5, 16);
  watch.reset();
  CHECK_FALSE(watch.limit());
  geometric(watch, 0.5, 11);
  CHECK_FALSE(watch.limit());
}

// Events that are (1 + 0.01 a) a ahead of the limit: not known to rounding, but to 10⁻² a².
TEST_CASE("a limit is crossed from near it, and from ten times as far where nearer events have no digits", "[unit]") {
  const auto is_near = [](int events, double doubt) {
    engine::AccumulationWatch watch;
    std::optional<engine::AccumulationWatch::Limit> limit;
    double time = 0.0;
    for (int k = 0; k < events; ++k) {
      const double ahead = std::pow(0.5, k), x = ahead * ahead;
      watch.note(time = 1.0 - ahead * (1.0 + 0.01 * ahead), 0, &x, 1, doubt);
      limit = watch.limit();
    }
    REQUIRE(limit);
    return limit->is_near(time);
  };
  const int near = 18, soon = 15, far = 13;  // 2⁻¹⁷ = 8·10⁻⁶, 2⁻¹⁴ = 6·10⁻⁵, 2⁻¹² = 2·10⁻⁴
  for (const double doubt : {0.0, 1e-9, 1e-6}) {
    CHECK(is_near(near, doubt));
    CHECK(is_near(soon, doubt) == (doubt == 1e-6));
    CHECK_FALSE(is_near(far, doubt));
  }
}
