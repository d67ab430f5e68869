#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "linalg/legendre.hpp"
#include "measure/program.hpp"

namespace pwlsim::measure {
namespace {

using circuit::StepKind;

constexpr double unbounded = std::numeric_limits<double>::infinity();
/// How far an argument may vary on a part, in the scale on which its function changes: sixteen points then show whatever the function does.
constexpr double widest = 8.0;
/// Where tanh is ±1, and exp 0, in double precision.
constexpr double tanh_is_one = 20.0, exp_is_zero = -746.0;
constexpr double few_factors = 8.0;  ///< of a power that is a polynomial
/// Of a polynomial's extremes, in its last coefficients.
constexpr double tail_slack = 16.0;

struct Bounds {
  double least = -unbounded, largest = unbounded;

  [[nodiscard]] double width() const { return largest - least; }
  [[nodiscard]] bool holds(double x) const { return least <= x && x <= largest; }
  [[nodiscard]] double smallest_magnitude() const { return holds(0.0) ? 0.0 : std::min(std::abs(least), std::abs(largest)); }
  [[nodiscard]] double largest_magnitude() const { return std::max(std::abs(least), std::abs(largest)); }
  /// ln of the ratio of its ends; infinite where it reaches zero.
  [[nodiscard]] double octaves() const {
    return smallest_magnitude() > 0.0 ? std::log(largest_magnitude() / smallest_magnitude()) : unbounded;
  }
};

Bounds bounds_of(std::initializer_list<double> values) {
  Bounds bounds{unbounded, -unbounded};
  for (const double value : values) {
    if (std::isnan(value)) return {};
    bounds.least = std::min(bounds.least, value);
    bounds.largest = std::max(bounds.largest, value);
  }
  return bounds;
}

/// A part of the expression at the points of the part of a piece.
struct Operand {
  linalg::LegendreValues values{};
  bool is_resolved = false;  ///< a polynomial, whose bounds are those of its series
  bool hides = false;        ///< features may lie between its points
  bool has_bounds = false;
  Bounds bounds;

  void find_bounds() {
    if (has_bounds) return;
    has_bounds = true;
    const linalg::LegendreSeries series(values.data());
    if (!std::isfinite(series.mean()) || !std::isfinite(series.variation())) return;
    const linalg::Extremes extremes = linalg::extremes(series);
    const double slack = tail_slack * series.tail();
    bounds = {extremes.least - slack, extremes.largest + slack};
  }
};

Operand constant_operand(double value) {
  Operand operand;
  operand.values.fill(value);
  operand.is_resolved = operand.has_bounds = true;
  operand.bounds = {value, value};
  return operand;
}

/// x^y, or what is like it: e^{y ln x}.
void raise_bounds(const Operand& base, const Operand& exponent, Operand& result) {
  const Bounds x = base.bounds, y = exponent.bounds;
  if (y.width() == 0.0) {
    const double n = y.least;
    result.bounds = bounds_of({std::pow(x.least, n), std::pow(x.largest, n)});
    if (x.holds(0.0) && n > 0.0)
      result.bounds.least = std::min(result.bounds.least, 0.0), result.bounds.largest = std::max(result.bounds.largest, 0.0);
    if (x.holds(0.0) && n < 0.0) result.bounds = {};
    const bool is_mild = n >= 0.0 ? n <= few_factors : x.holds(0.0);
    result.hides = !is_mild && !(std::abs(n) * x.octaves() <= widest) && result.bounds.width() > 0.0;
    return;
  }
  if (!(x.least > 0.0)) {
    result.bounds = {};
    return;
  }
  const double a = std::log(x.least), b = std::log(x.largest);
  const Bounds power = bounds_of({a * y.least, a * y.largest, b * y.least, b * y.largest});
  result.bounds = {std::exp(power.least), std::exp(power.largest)};
  result.hides = !(power.width() <= widest) && !(power.largest < exp_is_zero);
}

void multiply_bounds(const Bounds& a, const Bounds& b, Bounds& result) {
  result = bounds_of({a.least * b.least, a.least * b.largest, a.largest * b.least, a.largest * b.largest});
}

/// A quotient passes a pole where its denominator is zero, which its points show.
void divide_bounds(const Bounds& a, const Bounds& b, Operand& result) {
  if (b.holds(0.0)) {
    result.bounds = {};
    return;
  }
  multiply_bounds(a, {1.0 / b.largest, 1.0 / b.least}, result.bounds);
  result.hides = b.octaves() > widest;
}

void operate(const std::string& operation, const Operand& a, const Operand& b, Operand& result) {
  if (operation == "+") {
    result.bounds = {a.bounds.least + b.bounds.least, a.bounds.largest + b.bounds.largest};
  } else if (operation == "-") {
    result.bounds = {a.bounds.least - b.bounds.largest, a.bounds.largest - b.bounds.least};
  } else if (operation == "*") {
    multiply_bounds(a.bounds, b.bounds, result.bounds);
  } else if (operation == "/") {
    divide_bounds(a.bounds, b.bounds, result);
  } else if (operation == "^" || operation == "**") {
    raise_bounds(a, b, result);
  } else {  // decided by turns
    const auto [least, largest] = std::minmax_element(result.values.begin(), result.values.end());
    result.bounds = {*least, *largest};
  }
  if (std::isnan(result.bounds.least) || std::isnan(result.bounds.largest)) result.bounds = {};
}

/// Whether a function does with its argument what sixteen points need not show, and its bounds.
void apply_function(std::string_view name, std::vector<Operand>& arguments, Operand& result) {
  const Bounds& x = arguments[0].bounds;
  const auto is = [&](std::initializer_list<std::string_view> names) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const auto ends = [&](auto f) { return bounds_of({f(x.least), f(x.largest)}); };
  if (name == "exp") {
    result.bounds = ends([](double v) { return std::exp(v); });
    result.hides = !(x.width() <= widest) && !(x.largest < exp_is_zero);
  } else if (name == "tanh") {
    result.bounds = ends([](double v) { return std::tanh(v); });
    result.hides = !(x.width() <= widest) && !(x.smallest_magnitude() > tanh_is_one);
  } else if (is({"sin", "cos"})) {
    result.bounds = {-1.0, 1.0};
    if (x.width() <= 1.0) {
      const double middle = 0.5 * (x.least + x.largest), value = name == "sin" ? std::sin(middle) : std::cos(middle);
      result.bounds = {std::max(-1.0, value - 0.5 * x.width()), std::min(1.0, value + 0.5 * x.width())};
    }
    result.hides = !(x.width() <= widest);
  } else if (is({"tan", "sinh", "cosh"})) {
    if (name == "sinh") result.bounds = ends([](double v) { return std::sinh(v); });
    if (name == "cosh") result.bounds = {std::cosh(x.smallest_magnitude()), std::cosh(x.largest_magnitude())};
    result.hides = !(x.width() <= widest);
  } else if (is({"atan", "arctan", "asinh"})) {
    result.bounds = ends([&](double v) { return name == "asinh" ? std::asinh(v) : std::atan(v); });
    result.hides = !(x.width() <= widest * std::max(1.0, x.smallest_magnitude()));
  } else if (is({"sqrt", "ln", "log", "log10"})) {
    const auto f = [&](double v) { return name == "sqrt" ? std::sqrt(v) : name == "log10" ? std::log10(v) : std::log(v); };
    result.bounds = {f(std::max(x.least, 0.0)), f(std::max(x.largest, 0.0))};
    result.hides = x.least > 0.0 && x.octaves() > widest;
  } else if (is({"pow", "pwr", "pwrs"})) {
    Operand base = arguments[0];
    if (name != "pow") base.bounds = {base.bounds.smallest_magnitude(), base.bounds.largest_magnitude()};
    raise_bounds(base, arguments[1], result);
    if (name == "pwrs") result.bounds = {-result.bounds.largest_magnitude(), result.bounds.largest_magnitude()};
  } else if (name == "atan2") {
    result.bounds = {-std::numbers::pi, std::numbers::pi};
    const Bounds& axis = arguments[1].bounds;
    const double nearest = std::max(x.smallest_magnitude(), axis.smallest_magnitude());
    result.hides = nearest > 0.0 && std::max(x.width(), axis.width()) > widest * nearest;
  } else if (name == "hypot") {
    const Bounds& other = arguments[1].bounds;
    result.bounds = {std::hypot(x.smallest_magnitude(), other.smallest_magnitude()),
                     std::hypot(x.largest_magnitude(), other.largest_magnitude())};
    result.hides = result.bounds.least > 0.0 && result.bounds.octaves() > widest;
  } else if (is({"asin", "arcsin", "acos", "arccos"})) {
    result.bounds = {-std::numbers::pi, std::numbers::pi};
  } else if (name == "acosh") {
    result.bounds = {std::acosh(std::max(1.0, x.least)), std::acosh(std::max(1.0, x.largest))};
    result.hides = x.least > 1.0 && x.octaves() > widest;
  } else if (is({"sgn", "floor", "ceil", "int", "round", "buf", "inv"})) {
    const auto [least, largest] = std::minmax_element(result.values.begin(), result.values.end());
    result.bounds = {*least, *largest};
  } else if (name == "abs") {
    result.bounds = {x.smallest_magnitude(), x.largest_magnitude()};
  } else if (name == "mod" && arguments[1].bounds.width() == 0.0) {
    const double multiple = result.values[0] - arguments[0].values[0];
    result.bounds = {x.least + multiple, x.largest + multiple};
  }
  if (std::isnan(result.bounds.least) || std::isnan(result.bounds.largest)) result.bounds = {};
}

/// Whether it keeps a polynomial what is one, between the zeros of its turns.
bool keeps_resolved(const circuit::MeasuredExpression::Step& step) {
  using circuit::Corners;
  switch (step.kind) {
    case StepKind::operation:
      return step.operation == "+" || step.operation == "-" || step.operation == "*" || circuit::compares(step.operation);
    case StepKind::function:
      return step.function->corners != Corners::none && step.function->name != "pwr" && step.function->name != "pwrs" &&
             step.function->name != "atan2";
    case StepKind::negate:
      return true;
    default:
      return false;
  }
}

/// x^n of few factors, or x/n.
bool is_by_constant(const std::string& operation, const Operand& right) {
  if (!right.has_bounds || right.bounds.width() != 0.0) return false;
  const double n = right.values[0];
  if (operation == "/") return n != 0.0;
  return (operation == "^" || operation == "**") && n >= 1.0 && n <= few_factors && n == std::floor(n);
}

void find_result(const circuit::MeasuredExpression::Step& step, std::vector<Operand>& own, Operand& result) {
  for (Operand& operand : own) operand.find_bounds();
  result.has_bounds = true;
  const bool inherits = result.hides;
  if (step.kind == StepKind::negate) {
    result.bounds = {-own[0].bounds.largest, -own[0].bounds.least};
  } else if (step.kind == StepKind::operation) {
    operate(step.operation, own[0], own[1], result);
  } else if (step.kind == StepKind::choose ||
             (step.kind == StepKind::function && step.function->corners == circuit::Corners::of_differences)) {
    // One of its operands, the same on the whole part.
    const std::size_t middle = result.values.size() / 2;
    const auto is_chosen = [&](const Operand& operand) { return operand.values[middle] == result.values[middle]; };
    const auto found = std::find_if(own.begin(), own.end(), is_chosen);
    const bool is_first = own[0].values[middle] != 0.0;
    const Operand& chosen = step.kind == StepKind::choose ? own[is_first ? 1 : 2] : found == own.end() ? own[0] : *found;
    result.bounds = chosen.bounds;
    result.hides = chosen.hides;
    result.is_resolved = chosen.is_resolved;
    return;
  } else if (step.kind == StepKind::function) {
    apply_function(step.function->name, own, result);
  } else {
    result.bounds = {0.0, 1.0};
  }
  result.hides = (inherits || result.hides) && result.bounds.width() != 0.0;
}

/// In the order of the turns of a step: whether each may pass its zero, or an integer, where the points do not show it.
void note_hidden_turns(const circuit::MeasuredExpression::Step& step, std::vector<Operand>& own, std::vector<char>& turns) {
  const auto meet = [&](Operand& a, Operand& b) {
    if (!a.hides && !b.hides) return turns.push_back(0);
    a.find_bounds();
    b.find_bounds();
    turns.push_back(a.bounds.least <= b.bounds.largest && b.bounds.least <= a.bounds.largest ? 1 : 0);
  };
  if (step.kind == StepKind::operation && circuit::compares(step.operation)) meet(own[0], own[1]);
  if (step.kind != StepKind::function) return;
  constexpr double half = 0.5;
  Operand level = constant_operand(step.function->corners == circuit::Corners::at_half ? half : 0.0);
  switch (step.function->corners) {
    case circuit::Corners::none:
      break;
    case circuit::Corners::at_zero:
    case circuit::Corners::at_half:
      meet(own[0], level);
      break;
    case circuit::Corners::at_integers:
    case circuit::Corners::at_halves:
    case circuit::Corners::of_quotient:
      turns.push_back(
          std::any_of(own.begin(), own.end(), [](const Operand& operand) { return operand.hides && operand.bounds.width() != 0.0; }));
      break;
    case circuit::Corners::of_differences:
      for (std::size_t i = 1; i < own.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) meet(own[i], own[k]);
      break;
  }
}

}  // namespace

void Program::find_hidden(const Inputs& inputs, HiddenFeatures& hidden) const {
  hidden.width = 0.0;
  hidden.turns.clear();
  std::vector<Operand> stack;
  for (std::size_t number = 0; number < steps_.size(); ++number) {
    const Step& step = steps_[number];
    if (step.kind == StepKind::number || step.kind == StepKind::result) {
      stack.push_back(
          constant_operand(step.kind == StepKind::number ? step.number : (*inputs.results)[static_cast<std::size_t>(step.index)]));
      continue;
    }
    Operand result;
    if (step.kind == StepKind::signal || step.kind == StepKind::time) {
      const double* const own = step.kind == StepKind::time ? inputs.times : inputs.signals[static_cast<std::size_t>(step.index)];
      std::copy_n(own, result.values.size(), result.values.begin());
      result.is_resolved = true;
      stack.push_back(result);
      continue;
    }
    const std::size_t count = operands_of(step);
    std::vector<Operand> own(stack.end() - static_cast<std::ptrdiff_t>(count), stack.end());
    stack.resize(stack.size() - count);
    std::vector<double> arguments(count);
    for (std::size_t i = 0; i < result.values.size(); ++i) {
      for (std::size_t k = 0; k < count; ++k) arguments[k] = own[k].values[i];
      result.values[i] = value_of(number, arguments);
    }
    note_hidden_turns(step, own, hidden.turns);
    const auto is_resolved = [](const Operand& operand) { return operand.is_resolved; };
    result.hides = std::any_of(own.begin(), own.end(), [](const Operand& operand) { return operand.hides; });
    const bool keeps = keeps_resolved(step) || (step.kind == StepKind::operation && is_by_constant(step.operation, own[1]));
    result.is_resolved = keeps && std::all_of(own.begin(), own.end(), is_resolved);
    if (!result.is_resolved) find_result(step, own, result);
    stack.push_back(result);
  }
  if (stack.empty() || !stack.back().hides) return;
  hidden.width = stack.back().bounds.width();
}

}  // namespace pwlsim::measure
