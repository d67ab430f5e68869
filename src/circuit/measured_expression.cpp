#include "circuit/measured_expression.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/card_items.hpp"
#include "circuit/evaluator.hpp"
#include "circuit/expression_derivative.hpp"

namespace pwlsim::circuit {
namespace {

using Kind = netlist::Expression::Kind;
using Step = MeasuredExpression::Step;

Step number_step(double value) { return {.kind = StepKind::number, .number = value}; }
Step operation_step(std::string text) { return {.kind = StepKind::operation, .operation = std::move(text)}; }
Step function_step(const BuiltinFunction* function, std::size_t operands) {
  return {.kind = StepKind::function, .index = static_cast<int>(operands), .function = function};
}

/// Those that depend on parameters of .sens stay apart.
bool are_numbers(const std::vector<Step>& steps, std::size_t first, std::size_t count) {
  return steps.size() == first + count && std::all_of(steps.end() - static_cast<std::ptrdiff_t>(count), steps.end(), [](const Step& step) {
           return step.kind == StepKind::number && step.gradient.empty();
         });
}

}  // namespace

int add_probe(FlatCircuit& circuit, SaveRequest request) {
  auto& probes = circuit.probes;
  const auto same = [&](const SaveRequest& other) {
    return other.kind == request.kind && same_name(other.first, request.first) && same_name(other.second, request.second) &&
           other.quantity == request.quantity && other.number == request.number;
  };
  const auto known = std::find_if(probes.begin(), probes.end(), same);
  const auto index = static_cast<int>(known - probes.begin());
  if (known == probes.end()) probes.push_back(std::move(request));
  return index;
}

bool MeasuredExpressionReader::fail(std::string id, const Expression& expression, std::string text) {
  reporter_.error(std::move(id), expression.span, std::move(text));
  return false;
}

std::optional<MeasuredExpression> MeasuredExpressionReader::read(const netlist::Item& item) {
  MeasuredExpression result;
  result.span = item.span;
  result.text = reporter_.text(item.span);
  if (item.kind == netlist::Item::Kind::expression) {
    if (!add(*item.expression, scope_, nullptr, 0, result.steps)) return std::nullopt;
    return result;
  }
  const std::optional<Number> number = scope_.number(item);
  if (!number) return std::nullopt;
  result.steps.push_back(number_step(number->value));
  result.steps.back().gradient = number->gradient;
  scope_.claim(*number);
  return result;
}

bool MeasuredExpressionReader::add(const Expression& expression, Scope& scope, const Arguments* arguments, int depth, Steps& steps) {
  if (depth > Session::deepest) return fail("E-too-deep", expression, fmt::format("expressions nest deeper than {}", Session::deepest));
  const std::size_t first = steps.size();
  switch (expression.kind) {
    case Kind::number:
      return add_number(expression, scope, steps);
    case Kind::name:
      return add_name(expression, scope, arguments, steps);
    case Kind::call:
      return add_call(expression, scope, arguments, depth, steps);
    default:
      break;
  }
  for (const Expression& argument : expression.arguments)
    if (!add(argument, scope, arguments, depth + 1, steps)) return false;
  if (expression.kind == Kind::conditional) {
    steps.push_back({.kind = StepKind::choose});
  } else if (expression.kind == Kind::unary) {
    if (expression.text == "-" && are_numbers(steps, first, 1))
      steps.back().number = -steps.back().number;
    else if (expression.text == "-")
      steps.push_back({.kind = StepKind::negate});
    if (expression.text == "!") steps.push_back({.kind = StepKind::invert});
  } else if (are_numbers(steps, first, 2)) {
    const double value = find_binary(expression.text)(steps[first].number, steps[first + 1].number);
    if (!std::isfinite(value)) return fail("E-not-finite", expression, "the result is not a finite number");
    steps.resize(first);
    steps.push_back(number_step(value));
  } else {
    steps.push_back(operation_step(expression.text));
  }
  return true;
}

bool MeasuredExpressionReader::add_number(const Expression& expression, Scope& scope, Steps& steps) {
  Session& session = scope.session();
  ++session.numbers;
  const std::optional<double> value = Evaluator(scope, 0).value(expression);
  const Gradient gradient = value && !session.varied.empty() ? Differentiator(scope).of(expression) : Gradient();
  --session.numbers;
  if (!value) return false;
  if (!std::isfinite(*value)) return fail("E-not-finite", expression, "inf is allowed only for limits");
  steps.push_back(number_step(*value));
  steps.back().gradient = gradient;
  return true;
}

bool MeasuredExpressionReader::add_name(const Expression& expression, Scope& scope, const Arguments* arguments, Steps& steps) {
  const std::string key = without_case(expression.text);
  if (arguments != nullptr)
    if (const auto argument = arguments->find(key); argument != arguments->end()) {
      steps.insert(steps.end(), argument->second.begin(), argument->second.end());
      return true;
    }
  if (const auto result = results_.find(key); result != results_.end()) {
    steps.push_back({.kind = StepKind::result, .index = result->second});
  } else if (key == "time") {
    steps.push_back({.kind = StepKind::time});
  } else {
    return add_number(expression, scope, steps);
  }
  return true;
}

bool MeasuredExpressionReader::add_call(const Expression& expression, Scope& scope, const Arguments* arguments, int depth, Steps& steps) {
  const std::string key = without_case(expression.text);
  Scope* home = nullptr;
  if (key == "v" || key == "i" || is_transistor_current(expression)) return add_signal(expression, steps);
  if (const FunctionText* function = find_function(scope, key, home))
    return add_function(expression, *function, *home, scope, arguments, depth, steps);
  if (key == "x" || key == "y" || (key == "u" && expression.arguments.size() == 2)) return add_signal(expression, steps);
  return add_builtin(expression, scope, arguments, depth, steps);
}

bool MeasuredExpressionReader::add_signal(const Expression& expression, Steps& steps) {
  const std::optional<SaveRequest> request = signal_request(expression, reporter_);
  if (!request) return false;
  steps.push_back({.kind = StepKind::signal, .index = add_probe(circuit_, *request)});
  return true;
}

bool MeasuredExpressionReader::add_function(const Expression& expression, const FunctionText& function, Scope& home, Scope& scope,
                                            const Arguments* arguments, int depth, Steps& steps) {
  if (!count_is(expression, function.formals.size(), function.formals.size())) return false;
  Arguments values;
  for (std::size_t k = 0; k < function.formals.size(); ++k)
    if (!add(expression.arguments[k], scope, arguments, depth + 1, values[function.formals[k]])) return false;
  if (function.body->kind == netlist::Item::Kind::expression) return add(*function.body->expression, home, &values, depth + 1, steps);
  const std::optional<double> value = Evaluator(home, 0).value(*function.body);
  if (value) steps.push_back(number_step(*value));
  return value.has_value();
}

bool MeasuredExpressionReader::add_builtin(const Expression& expression, Scope& scope, const Arguments* arguments, int depth,
                                           Steps& steps) {
  const std::string key = without_case(expression.text);
  const bool is_choice = key == "if" || key == "ternary_fcn";
  const bool is_step = key == "u" || key == "stp" || key == "uramp";
  const BuiltinFunction* builtin = find_builtin(key);
  if (!is_choice && !is_step && builtin == nullptr)
    return fail("E-unknown-function", expression, fmt::format("unknown function '{}'", expression.text));
  const std::size_t least = is_choice ? 3 : is_step ? 1 : builtin->least;
  if (!count_is(expression, least, is_choice || is_step ? least : builtin->most)) return false;
  const std::size_t first = steps.size();
  for (const Expression& argument : expression.arguments)
    if (!add(argument, scope, arguments, depth + 1, steps)) return false;
  const std::size_t count = expression.arguments.size();
  if (is_choice) {
    steps.push_back({.kind = StepKind::choose});
  } else if (is_step) {
    steps.push_back(number_step(0.0));
    steps.push_back(key == "uramp" ? function_step(find_builtin("max"), 2) : operation_step(">"));
  } else if (are_numbers(steps, first, count)) {
    std::vector<double> values;
    for (std::size_t k = 0; k < count; ++k) values.push_back(steps[first + k].number);
    const double value = builtin->value(values);
    if (!std::isfinite(value))
      return fail("E-not-finite", expression, fmt::format("{}({}) is not a finite number", expression.text, fmt::join(values, ", ")));
    steps.resize(first);
    steps.push_back(number_step(value));
  } else {
    steps.push_back(function_step(builtin, count));
  }
  return true;
}

bool MeasuredExpressionReader::count_is(const Expression& expression, std::size_t least, std::size_t most) {
  const std::size_t count = expression.arguments.size();
  if (count >= least && count <= most) return true;
  const std::string wanted = fmt::format("{}{} argument{}", least, least == most ? "" : " or more", least == 1 ? "" : "s");
  return fail("E-argument-count", expression, fmt::format("{} takes {}, not {}", expression.text, wanted, count));
}

}  // namespace pwlsim::circuit
