#include "measure/unit.hpp"

#include <optional>
#include <vector>

namespace pwlsim::measure {
namespace {

using Step = circuit::MeasuredExpression::Step;
using MeasurementKind = circuit::Measurement::Kind;

/// Powers of V, A and s. A plain number fits to everything in a sum.
struct Unit {
  int volts = 0, amperes = 0, seconds = 0;
  bool is_plain = false;

  bool operator==(const Unit&) const = default;
};
constexpr Unit plain{0, 0, 0, true};

struct Name {
  Unit unit;
  const char* text;
};
constexpr Name names[] = {
    {{1, 0, 0}, "V"},    {{0, 1, 0}, "A"},   {{1, 1, 0}, "W"},   {{1, -1, 0}, "Ω"},  {{-1, 1, 0}, "S"},
    {{0, 0, 1}, "s"},    {{1, 0, 1}, "Vs"},  {{0, 1, 1}, "C"},   {{1, 1, 1}, "J"},   {{1, 0, -1}, "V/s"},
    {{0, 1, -1}, "A/s"}, {{0, 0, -1}, "Hz"}, {{2, 0, 0}, "V^2"}, {{0, 2, 0}, "A^2"}, {{1, 1, -1}, "W/s"},
};

class Reader {
 public:
  explicit Reader(const circuit::Measurements& measurements) : measurements_(measurements) {}

  std::optional<Unit> of(std::size_t index) {
    const circuit::Measurement& m = measurements_.list[index];
    if (m.kind == MeasurementKind::time || m.kind == MeasurementKind::period || m.kind == MeasurementKind::time_of_minimum ||
        m.kind == MeasurementKind::time_of_maximum)
      return Unit{0, 0, 1};
    std::optional<Unit> unit = of(m.expression);
    if (!unit) return unit;
    if (m.kind == MeasurementKind::integral) ++unit->seconds;
    if (m.kind == MeasurementKind::derivative) --unit->seconds;
    if (m.kind == MeasurementKind::integral || m.kind == MeasurementKind::derivative) unit->is_plain = false;
    return unit;
  }

 private:
  std::optional<Unit> of(const circuit::MeasuredExpression& expression) {
    std::vector<Unit> stack;
    for (const Step& step : expression.steps)
      if (!take(step, stack)) return std::nullopt;
    return stack.back();
  }

  bool take(const Step& step, std::vector<Unit>& stack) {
    switch (step.kind) {
      case circuit::StepKind::number:
        stack.push_back(plain);
        return true;
      case circuit::StepKind::time:
        stack.push_back({0, 0, 1});
        return true;
      case circuit::StepKind::signal:
        stack.push_back(of_signal(step));
        return true;
      case circuit::StepKind::result: {
        const std::optional<Unit> unit = of(static_cast<std::size_t>(step.index));
        stack.push_back(unit.value_or(Unit{}));
        return unit.has_value();
      }
      case circuit::StepKind::negate:
        return true;
      case circuit::StepKind::operation:
        return operate(step.operation, stack);
      case circuit::StepKind::function:
        return apply(step, stack);
      default:
        return false;
    }
  }

  Unit of_signal(const Step& step) const {
    switch (measurements_.probe_quantities[static_cast<std::size_t>(step.index)]) {
      case circuit::Quantity::voltage:
        return {1, 0, 0};
      case circuit::Quantity::current:
        return {0, 1, 0};
      default:
        return plain;
    }
  }

  /// Functions that keep the unit of their arguments.
  static bool apply(const Step& step, std::vector<Unit>& stack) {
    const std::string_view name = step.function->name;
    if (name != "abs" && name != "min" && name != "max" && name != "limit") return false;
    for (int k = 1; k < step.index; ++k)
      if (!add(stack)) return false;
    return true;
  }

  static bool add(std::vector<Unit>& stack) {
    const Unit right = stack.back();
    stack.pop_back();
    Unit& left = stack.back();
    if (left.is_plain) left = right;
    return right.is_plain || left == right;
  }

  static bool operate(const std::string& operation, std::vector<Unit>& stack) {
    if (operation == "+" || operation == "-") return add(stack);
    if (operation != "*" && operation != "/") return false;
    const int sign = operation == "*" ? 1 : -1;
    const Unit right = stack.back();
    stack.pop_back();
    Unit& left = stack.back();
    left = {left.volts + sign * right.volts, left.amperes + sign * right.amperes, left.seconds + sign * right.seconds,
            left.is_plain && right.is_plain};
    return true;
  }

  const circuit::Measurements& measurements_;
};

}  // namespace

std::string unit_of(const circuit::Measurements& measurements, std::size_t index) {
  const std::optional<Unit> unit = Reader(measurements).of(index);
  if (!unit) return "";
  for (const Name& name : names)
    if (name.unit == *unit) return name.text;
  return "";
}

}  // namespace pwlsim::measure
