#include "linalg/legendre.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

using namespace pwlsim::linalg;

namespace {

LegendreSeries through(const std::function<double(double)>& f) {
  LegendreValues values;
  for (std::size_t i = 0; i < legendre_points; ++i) values[i] = f(gauss_legendre().point[i]);
  return LegendreSeries(values.data());
}

constexpr double series_rounding = 1e-14;

}  // namespace

TEST_CASE("sixteen Gauss-Legendre points: the rule of Abramowitz and Stegun, table 25.4", "[unit]") {
  const GaussLegendre& rule = gauss_legendre();
  CHECK(rule.point[8] == Approx(0.095012509837637440185).epsilon(series_rounding));
  CHECK(rule.point[15] == Approx(0.989400934991649932596).epsilon(series_rounding));
  CHECK(rule.weight[8] == Approx(0.189450610455068496285).epsilon(series_rounding));
  CHECK(rule.weight[15] == Approx(0.027152459411754094852).epsilon(series_rounding));
  CHECK(rule.point[0] == -rule.point[15]);
}

TEST_CASE("a Legendre series has the value, derivative, mean and parts of its polynomial", "[unit]") {
  const auto f = [](double x) { return 3.0 * std::pow(x, 15) - 2.0 * std::pow(x, 4) + x - 0.25; };
  const LegendreSeries series = through(f);
  for (const double x : {-1.0, -0.3, 0.0, 0.77, 1.0}) {
    CHECK(series(x) == Approx(f(x)).margin(series_rounding));
    CHECK(series.derivative()(x) == Approx(45.0 * std::pow(x, 14) - 8.0 * std::pow(x, 3) + 1.0).margin(100.0 * series_rounding));
    CHECK(series.on(-0.5, 0.25)(x) == Approx(f(-0.5 + 0.375 * (x + 1.0))).margin(series_rounding));
  }
  CHECK(series.mean() == Approx(-2.0 / 5.0 - 0.25).epsilon(series_rounding));  // ½ ∫ f
}

TEST_CASE("a constant stays so to the last place", "[unit]") {
  const LegendreSeries series = through([](double) { return 0.1; });
  CHECK(series.mean() == 0.1);
  CHECK(series.variation() == 0.0);
}

TEST_CASE("sign changes: all simple zeros, and touches only as pairs", "[unit]") {
  const auto zeros = sign_changes(through([](double x) { return (x - 0.5) * (x + 0.25) * (x - 0.501); }), 1e-16);
  REQUIRE(zeros.size() == 3);
  CHECK(zeros[0] == Approx(-0.25).epsilon(series_rounding));
  CHECK(zeros[1] == Approx(0.5).epsilon(1e-12));  // the two lie close together: rounding of f / slope
  CHECK(zeros[2] == Approx(0.501).epsilon(1e-12));
  const auto touch = sign_changes(through([](double x) { return (x - 0.3) * (x - 0.3); }), 1e-15);
  CHECK(touch.size() % 2 == 0);
  for (const double x : touch) CHECK(x == Approx(0.3).epsilon(1e-7));  // the root of rounding
  CHECK(sign_changes(through([](double) { return 0.0; }), 1e-15).empty());
  // A flat zero lies in a stretch of noise, here at a halving.
  const auto flat = sign_changes(through([](double x) { return x * x * x; }), 1e-14);
  REQUIRE(flat.size() == 1);
  CHECK(flat[0] == Approx(0.0).margin(2.2e-5));  // the third root of the noise
  // Numbers of one or two bits and numbers that are none have no signs, and are not searched for ever.
  CHECK(sign_changes(through([](double x) { return 1e-323 * std::sin(40.0 * x); }), 0.0).empty());
  CHECK(sign_changes(through([](double x) { return x < 0.3 ? x : std::numeric_limits<double>::quiet_NaN(); }), 0.0).empty());
}

TEST_CASE("extremes lie at zeros of the derivative or at the ends", "[unit]") {
  const Extremes found = extremes(through([](double x) { return std::pow(x, 3) - 0.75 * x; }));  // at ±½: ∓¼; at ±1: ±¼
  CHECK(found.largest == Approx(0.25).epsilon(series_rounding));
  CHECK(found.least == Approx(-0.25).epsilon(series_rounding));
  const Extremes tiny = extremes(through([](double x) { return std::exp(-744.0 - x); }));
  CHECK(std::abs(tiny.least) < 1e-322);  // e^-745 to e^-743, in units of 5e-324
  CHECK(std::abs(tiny.largest) < 1e-322);

  const Extremes flat = extremes(through([](double x) { return std::pow(x - 0.25, 4) - 1.0; }));
  CHECK(flat.least == Approx(-1.0).epsilon(4.0 * series_rounding));
  const Extremes slope = extremes(through([](double x) { return 2.0 * x; }));
  CHECK(slope.largest_at == 1.0);
  CHECK(slope.least_at == -1.0);
}
