/// When a sequence of events is an accumulation, and where it ends.
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/exact/accumulation.hpp"

using namespace pwlsim;

namespace {

constexpr double rounding = 1e-13;

/// Events at t_k = 1 - w_k ratio^floor(k/2), two an interval pair, the state going to 3 as 3 - (1 - t)^2.
void geometric(engine::AccumulationWatch& watch, const model::Mode* modes, double ratio, int events) {
  for (int k = 0; k < events; ++k) {
    const double ahead = (k % 2 == 0 ? 1.0 : 0.8) * std::pow(ratio, k / 2);
    const double x = 3.0 - ahead * ahead;
    watch.note(1.0 - ahead, modes[k % 2], &x, 1);
  }
}

}  // namespace

TEST_CASE("a geometric sequence of events has its limit at the sum of the series", "[unit]") {
  const model::Mode modes[2];
  for (const double ratio : {0.1, 0.5, 0.9}) {
    INFO("ratio " << ratio);
    engine::AccumulationWatch watch;
    geometric(watch, modes, ratio, 16);
    const auto limit = watch.limit();
    REQUIRE(limit);
    CHECK(limit->period == 2);
    CHECK(limit->ratio == Approx(ratio).epsilon(1e-6));
    CHECK(limit->time == Approx(1.0).epsilon(rounding / (1.0 - ratio)));
    CHECK(limit->uncertainty <= rounding / (1.0 - ratio));
    REQUIRE(limit->xi.size() == 1);
    CHECK(limit->xi[0] == Approx(3.0).epsilon(rounding / (1.0 - ratio)));
  }
}

TEST_CASE("a clock is no accumulation, nor are a few short intervals, nor ever new modes", "[unit]") {
  const model::Mode modes[2];
  const double x = 0.0;
  engine::AccumulationWatch clock;
  for (int k = 0; k < 40; ++k) clock.note(k, modes[k % 2], &x, 1);
  CHECK_FALSE(clock.limit());

  engine::AccumulationWatch few;
  geometric(few, modes, 0.5, 11);
  CHECK_FALSE(few.limit());

  const std::vector<model::Mode> many(40);
  engine::AccumulationWatch changing;
  for (int k = 0; k < 40; ++k) changing.note(1.0 - std::pow(0.8, k), many[static_cast<std::size_t>(k)], &x, 1);
  CHECK_FALSE(changing.limit());
}

TEST_CASE("an event from outside begins the count anew", "[unit]") {
  const model::Mode modes[2];
  engine::AccumulationWatch watch;
  geometric(watch, modes, 0.5, 16);
  watch.reset();
  CHECK_FALSE(watch.limit());
  geometric(watch, modes, 0.5, 11);
  CHECK_FALSE(watch.limit());
}
