/// Formulas: their values against the functions they stand for, and the number of ports they need.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "elements/formula.hpp"

using namespace pwlsim::elements;

namespace {

using Kind = FormulaPart::Kind;

/// The value of a formula where its voltages are `v`; a step is ½ at 0.
class Evaluation {
 public:
  Evaluation(const std::vector<FormulaPart>& parts, std::vector<double> v, double time = 0.0) {
    for (const FormulaPart& part : parts) {
      const double x = of(part.argument);
      double value = 0.0;
      if (part.kind == Kind::voltage) value = v[static_cast<std::size_t>(part.index)];
      if (part.kind == Kind::positive) value = std::max(x, 0.0);
      if (part.kind == Kind::step) value = x > 0.0 ? 1.0 : (x < 0.0 ? 0.0 : 0.5);
      if (part.kind == Kind::choice) value = of(x > part.on_level.value ? part.above : part.below);
      if (part.kind == Kind::time) value = of_time(part, time);
      values_.push_back(value);
    }
  }

  [[nodiscard]] double of(const AffineSum& sum) const {
    double value = sum.constant.value;
    for (const auto& [part, coefficient] : sum.terms) value += coefficient.value * values_[static_cast<std::size_t>(part)];
    return value;
  }

 private:
  static double of_time(const FormulaPart& part, double t) {
    if (const auto* sine = std::get_if<pwlsim::model::Sin>(&part.function))
      return sine->amplitude * std::exp(-sine->damping * t) * std::sin(2.0 * M_PI * sine->frequency * t + sine->phase);
    const auto& points = std::get<pwlsim::model::Pwl>(part.function).points;
    if (t < points[0].time) return points[0].value;
    std::size_t k = 0;
    while (k + 1 < points.size() && points[k + 1].time <= t) ++k;
    if (k + 1 == points.size()) return points[k].value;
    return points[k].value + (points[k + 1].value - points[k].value) * (t - points[k].time) / (points[k + 1].time - points[k].time);
  }

  std::vector<double> values_;
};

/// Ports of the parts that `value` needs: one a positive part, two a step.
int ports(const std::vector<FormulaPart>& parts, const AffineSum& value) {
  std::vector<char> needed(parts.size(), 0);
  const auto mark = [&](const AffineSum& sum) {
    for (const auto& term : sum.terms) needed[static_cast<std::size_t>(term.first)] = 1;
  };
  mark(value);
  int count = 0;
  for (std::size_t k = parts.size(); k-- > 0;) {
    if (needed[k] == 0) continue;
    mark(parts[k].argument);
    mark(parts[k].above);
    mark(parts[k].below);
    count += parts[k].kind == Kind::positive ? 1 : (parts[k].kind == Kind::step ? 2 : 0);
  }
  return count;
}

constexpr double rounding = 1e-14;

struct FormulaBench {
  FormulaBuilder f;
  AffineSum x = f.voltage(0), y = f.voltage(1);

  template <class Function>
  void check(const AffineSum& value, int wanted_ports, Function function) {
    CHECK(ports(f.parts(), value) == wanted_ports);
    for (double a : {-3.0, -1.0, -0.25, 0.5, 1.0, 2.5, 7.0})
      for (double b : {-2.0, 0.125, 3.0}) {
        INFO("x = " << a << ", y = " << b);
        CHECK(Evaluation(f.parts(), {a, b}).of(value) == Approx(function(a, b)).epsilon(rounding).margin(rounding));
      }
  }
};

}  // namespace

TEST_CASE("functions have their values and as few ports as they need", "[unit]") {
  FormulaBench b;
  b.check(b.f.maximum(b.x, b.y), 1, [](double x, double y) { return std::max(x, y); });
  b.check(b.f.minimum(b.x, b.y), 1, [](double x, double y) { return std::min(x, y); });
  b.check(b.f.absolute(b.x), 1, [](double x, double) { return std::abs(x); });
  b.check(b.f.sign(b.x), 2, [](double x, double) { return x > 0.0 ? 1.0 : -1.0; });
  b.check(b.f.limit(b.x, constant_sum(-1.0), constant_sum(2.0)), 2, [](double x, double) { return std::clamp(x, -1.0, 2.0); });
  b.check(b.f.limit(b.x, constant_sum(2.0), constant_sum(-1.0)), 2, [](double x, double) { return std::clamp(x, -1.0, 2.0); });
  b.check(b.f.limit(b.x, b.y, constant_sum(1.0)), 3, [](double x, double y) { return std::clamp(x, std::min(y, 1.0), std::max(y, 1.0)); });
}

TEST_CASE("equal parts share their ports", "[unit]") {
  FormulaBench b;
  b.check(b.f.maximum(b.x, b.y) - b.f.minimum(b.x, b.y), 1, [](double x, double y) { return std::abs(x - y); });
  b.check(b.f.absolute(b.x) + b.f.positive(-3.0 * b.x), 1, [](double x, double) { return std::abs(x) + std::max(-3.0 * x, 0.0); });
  b.check(b.f.step(b.x, 0.5) + b.f.sign(-2.0 * b.x), 2, [](double x, double) { return x > 0.0 ? 0.0 : 1.0; });
}

TEST_CASE("a limit at infinity is none", "[unit]") {
  FormulaBench b;
  const double inf = INFINITY;
  b.check(b.f.limit(b.x, constant_sum(-inf), constant_sum(2.0)), 1, [](double x, double) { return std::min(x, 2.0); });
  b.check(b.f.maximum(b.x, constant_sum(-inf)), 0, [](double x, double) { return x; });
}

TEST_CASE("a table has one port a kink, a step where its x repeat", "[unit]") {
  FormulaBench b;
  const std::vector<TablePoint> hat{{-1.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}};
  b.check(b.f.table(b.x, hat, false), 3, [](double x, double) { return std::max(0.0, 1.0 - std::abs(x)); });
  b.check(b.f.table(b.x, hat, true), 1, [](double x, double) { return 1.0 - std::abs(x); });
  b.check(b.f.table(b.x, {{-1.0, 0.0}, {0.0, 2.0}, {1.0, 4.0}}, true), 0, [](double x, double) { return 2.0 * x + 2.0; });
  b.check(b.f.table(b.x, {{0.75, -1.0}, {0.75, 1.0}}, false), 2, [](double x, double) { return x > 0.75 ? 1.0 : -1.0; });
}

TEST_CASE("a choice costs what its two sides differ by", "[unit]") {
  FormulaBench b;
  const Condition above = b.f.greater(b.x, constant_sum(0.75));
  b.check(b.f.choose(above, b.x, constant_sum(0.75)), 1, [](double x, double) { return std::max(x, 0.75); });
  b.check(b.f.choose(above, constant_sum(5.0), constant_sum(2.0)), 2, [](double x, double) { return x > 0.75 ? 5.0 : 2.0; });
  b.check(b.f.choose(above, 2.0 * b.x, constant_sum(0.0)), 3, [](double x, double) { return x > 0.75 ? 2.0 * x : 0.0; });
  b.check(b.f.choose(above, b.y, b.x), 0, [](double x, double y) { return x > 0.75 ? y : x; });
  const Condition both = b.f.both(above, b.f.greater(constant_sum(2.0), b.x));
  b.check(b.f.choose(both, constant_sum(1.0), constant_sum(0.0)), 5, [](double x, double) { return x > 0.75 && x < 2.0 ? 1.0 : 0.0; });
  const Condition either = b.f.either(above, b.f.greater(constant_sum(0.0), b.x));
  b.check(b.f.choose(FormulaBuilder::negation(either), b.y, b.x), 5, [](double x, double y) { return x > 0.75 || x < 0.0 ? x : y; });
}

TEST_CASE("functions of time are sources", "[unit]") {
  FormulaBench b;
  const AffineSum t = b.f.time();
  const AffineSum omega_t = 3.0 * t;
  const auto sine = b.f.sine(omega_t, 0.0);
  const auto decay = b.f.exponential(-2.0 * t);
  REQUIRE(sine.has_value());
  REQUIRE(decay.has_value());
  const auto product = b.f.product(*sine + constant_sum(1.0), *decay);
  const auto square = b.f.product(*sine, *sine);
  REQUIRE(product.has_value());
  REQUIRE(square.has_value());
  const AffineSum late = b.f.positive(t - constant_sum(0.5)), early = b.f.positive(constant_sum(0.5) - t);
  const AffineSum edge = b.f.step(t - constant_sum(0.5));
  const AffineSum shape = b.f.table(2.0 * t, {{0.5, 1.0}, {1.0, 3.0}}, false);
  for (double at : {0.0, 0.25, 0.375, 0.75, 2.0}) {
    const Evaluation e(b.f.parts(), {0.0, 0.0}, at);
    INFO("t = " << at);
    CHECK(e.of(*product) == Approx((std::sin(3.0 * at) + 1.0) * std::exp(-2.0 * at)).margin(rounding));
    CHECK(e.of(*square) == Approx(std::sin(3.0 * at) * std::sin(3.0 * at)).margin(rounding));
    CHECK(e.of(late) == Approx(std::max(at - 0.5, 0.0)).margin(rounding));
    CHECK(e.of(early) == Approx(std::max(0.5 - at, 0.0)).margin(rounding));
    CHECK(e.of(edge) == (at >= 0.5 ? 1.0 : 0.0));
    CHECK(e.of(shape) == Approx(std::clamp(1.0 + (2.0 * at - 0.5) * 4.0, 1.0, 3.0)).margin(rounding));
  }
  for (const AffineSum& value : {*product, *square, late, early, edge, shape}) CHECK(ports(b.f.parts(), value) == 0);
  CHECK_FALSE(b.f.product(t, *sine).has_value());
  CHECK_FALSE(b.f.product(b.x, b.y).has_value());
  CHECK_FALSE(b.f.sine(b.x, 0.0).has_value());
}
