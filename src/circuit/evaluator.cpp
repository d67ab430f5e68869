#include "circuit/evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "base/names.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using Kind = netlist::Expression::Kind;
using ItemKind = netlist::Item::Kind;

constexpr std::uint64_t most_function_calls = 10'000'000;
constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nominal_temperature = 27.0;  ///< °C; temperatures have no effect

bool is_choice(std::string_view name) { return same_name(name, "if") || same_name(name, "ternary_fcn"); }

const char* why_not_finite(const netlist::Expression& operation, double right) {
  if (operation.text == "/" && right == 0.0) return "division by zero";
  if (operation.text == "^" || operation.text == "**") return "this power is not a finite number";
  return "the result is not a finite number";
}

}  // namespace

std::optional<double> Evaluator::finite(double value, const Expression& expression, std::string_view why) {
  if (std::isfinite(value)) return value;
  reporter().error("E-not-finite", expression.span, std::string(why.empty() ? "the result is not a finite number" : why));
  return std::nullopt;
}

std::optional<double> Evaluator::value(const netlist::Item& item) {
  if (item.kind == ItemKind::expression) return value(*item.expression);
  if (item.kind == ItemKind::word) {
    const netlist::NumberText text = netlist::read_number(item.text);
    if (text.valid && (text.infinite || std::isfinite(text.value))) return text.value;
    if (text.valid) {
      reporter().error("E-not-finite", item.span, "this number is too large");
      return std::nullopt;
    }
    if (scope_.knows(item.text)) {
      if (reporter().first_time("bare parameter"))
        reporter().note("N-bare-parameter", item.span, fmt::format("{0} is read as the parameter of that name: {{{0}}}", item.text));
      return value(Expression{Kind::name, 0.0, item.text, {}, item.span});
    }
  }
  scope_.report_no_number(item);
  return std::nullopt;
}

std::optional<double> Evaluator::value(const Expression& expression) {
  if (scope_.session_.nesting >= deepest_nesting) return too_nested(expression);
  ++scope_.session_.nesting;
  const Expression* chosen = without_conditions(expression);
  const std::optional<double> result = chosen != nullptr ? of_kind(*chosen) : std::nullopt;
  --scope_.session_.nesting;
  return result;
}

const netlist::Expression* Evaluator::without_conditions(const Expression& expression) {
  const Expression* at = &expression;
  while (at->kind == Kind::conditional) {  // a chain of conditionals is as long as its text, not as deep
    const auto condition = value(at->arguments[0]);
    if (!condition) return nullptr;
    at = &at->arguments[*condition != 0.0 ? 1 : 2];
  }
  return at;
}

// The reports have functions of their own: what recurses keeps a small frame.
std::optional<double> Evaluator::too_nested(const Expression& expression) {
  reporter().error("E-too-deep", expression.span, fmt::format("expressions nest deeper than {}", deepest_nesting));
  return std::nullopt;
}

std::optional<double> Evaluator::too_many_calls(const FunctionText& function) {
  Session& session = scope_.session_;
  session.functions_exhausted = session.function_calls > most_function_calls;
  reporter().error("E-too-deep", function.span,
                   session.functions_exhausted ? fmt::format("more than {} calls of functions", most_function_calls)
                                               : fmt::format("parameters or functions nest deeper than {}", Session::deepest));
  return std::nullopt;
}

std::optional<double> Evaluator::of_kind(const Expression& expression) {
  switch (expression.kind) {
    case Kind::number:
      return of_number(expression);
    case Kind::name:
      return of_name(expression);
    case Kind::unary:
      return of_unary(expression);
    case Kind::binary:
      return of_binary(expression);
    case Kind::call:
      return of_call(expression);
    case Kind::conditional:
      break;
  }
  return std::nullopt;
}

std::optional<double> Evaluator::of_number(const Expression& expression) {
  if (std::isnan(expression.number)) return std::nullopt;  // reported when it was read
  if (std::isinf(expression.number) && netlist::read_number(expression.text).infinite) return expression.number;
  return finite(expression.number, expression, "this number is too large");
}

std::optional<double> Evaluator::of_name(const Expression& expression) {
  if (const double* argument = argument_named(expression.text)) return *argument;
  if (const auto [home, entry] = scope_.find(expression.text); entry != nullptr) {
    const std::optional<double> value = home->parameter(*entry, depth_);
    note_read(expression.text);
    return value;
  }
  return of_constant(expression);
}

/// A parameter whose derivatives are asked for, read by no number of a card: by a formula, or a table.
void Evaluator::note_read(std::string_view name) {
  Session& session = scope_.session_;
  if (session.varied.empty() || session.numbers > 0 || !session.evaluating.empty()) return;
  const std::vector<double> gradient = scope_.gradient_of(name);
  session.read_apart.resize(session.varied.size());
  for (std::size_t k = 0; k < gradient.size(); ++k)
    if (gradient[k] != 0.0) session.read_apart[k] = 1;
}

const double* Evaluator::argument_named(std::string_view name) const {
  if (arguments_ == nullptr) return nullptr;
  const auto& formals = arguments_->function->formals;
  const auto found = std::find_if(formals.begin(), formals.end(), [&](const std::string& formal) { return same_name(formal, name); });
  return found != formals.end() ? &arguments_->values[static_cast<std::size_t>(found - formals.begin())] : nullptr;
}

std::optional<double> Evaluator::of_constant(const Expression& expression) {
  if (same_name(expression.text, "pi")) return std::numbers::pi;
  if (same_name(expression.text, "e")) return std::numbers::e;
  if (same_name(expression.text, "inf")) return inf;
  for (const std::string_view name : {"temp", "temper", "tnom"})
    if (same_name(expression.text, name)) return nominal_temperature;
  return unknown_name(expression);
}

std::optional<double> Evaluator::unknown_name(const Expression& expression) {
  reporter().error("E-unknown-parameter", expression.span,
                   fmt::format("unknown parameter '{}'{}", expression.text, suggestion(expression.text, scope_.visible_names())));
  return std::nullopt;
}

std::optional<double> Evaluator::of_unary(const Expression& expression) {
  bool negative = false;
  const Expression* at = &expression;
  while (at->kind == Kind::unary && at->text != "!") {
    negative ^= at->text == "-";
    at = &at->arguments[0];
  }
  const bool is_not = at->kind == Kind::unary;
  std::optional<double> result = value(is_not ? at->arguments[0] : *at);
  if (!result) return std::nullopt;
  if (is_not) result = *result == 0.0 ? 1.0 : 0.0;
  return negative ? -*result : *result;
}

std::optional<double> Evaluator::of_binary(const Expression& expression) {
  std::vector<const Expression*> spine;  // a long sum is a deep tree on its left: no recursion there
  const Expression* at = &expression;
  for (; at->kind == Kind::binary; at = &at->arguments[0]) spine.push_back(at);
  std::optional<double> left = value(*at);
  for (auto operation = spine.rbegin(); operation != spine.rend(); ++operation) {
    const std::optional<double> right = value((*operation)->arguments[1]);
    left = left && right ? of_operation(**operation, *left, *right) : std::nullopt;
  }
  return left;
}

std::optional<double> Evaluator::of_operation(const Expression& operation, double left, double right) {
  const double result = find_binary(operation.text)(left, right);
  return finite(result, operation, std::isfinite(result) ? "" : why_not_finite(operation, right));
}

bool Evaluator::count_is_right(const Expression& expression, std::size_t least, std::size_t most) {
  const std::size_t count = expression.arguments.size();
  if (count >= least && count <= most) return true;
  const std::string wanted = fmt::format("{}{} argument{}", least, least == most ? "" : " or more", least == 1 ? "" : "s");
  reporter().error("E-argument-count", expression.span, fmt::format("{} takes {}, not {}", expression.text, wanted, count));
  return false;
}

std::optional<double> Evaluator::of_choice(const Expression& condition, const Expression& yes, const Expression& no) {
  const auto chosen = value(condition);
  if (!chosen) return std::nullopt;
  return value(*chosen != 0.0 ? yes : no);
}

bool Evaluator::arguments_of(const Expression& expression, std::vector<double>& values) {
  for (const Expression& argument : expression.arguments) {
    if (const auto one = value(argument)) values.push_back(*one);
  }
  return values.size() == expression.arguments.size();
}

Evaluator::Callee Evaluator::callee_of(std::string_view name) {
  const std::string key = without_case(name);
  for (Scope* at = &scope_; at != nullptr; at = at->outer()) {
    const auto found = at->definition().functions.find(key);
    if (found != at->definition().functions.end()) return {.function = &found->second, .home = at};
  }
  return {.is_choice = is_choice(key), .builtin = find_builtin(key)};
}

std::optional<double> Evaluator::of_call(const Expression& expression) {
  const Callee callee = callee_of(expression.text);
  if (callee.function != nullptr) return of_function(expression, *callee.function, *callee.home);
  if (callee.is_choice) {
    if (!count_is_right(expression, 3, 3)) return std::nullopt;
    return of_choice(expression.arguments[0], expression.arguments[1], expression.arguments[2]);
  }
  if (is_random_function(expression.text)) return of_random(expression);
  if (callee.builtin == nullptr) return unknown_function(expression);
  if (!count_is_right(expression, callee.builtin->least, callee.builtin->most)) return std::nullopt;
  std::vector<double> values;
  if (!arguments_of(expression, values)) return std::nullopt;
  return of_builtin(expression, *callee.builtin, values);
}

/// A new number at every evaluation; a parameter is evaluated once.
std::optional<double> Evaluator::of_random(const Expression& expression) {
  const RandomFunction* function = find_random_function(expression.text, expression.arguments.size());
  if (function == nullptr) {
    reporter().error("E-argument-count", expression.span,
                     fmt::format("{} does not take {} arguments", expression.text, expression.arguments.size()));
    return std::nullopt;
  }
  std::vector<double> values;
  if (!arguments_of(expression, values)) return std::nullopt;
  scope_.session_.draws_random = true;
  return finite(function->value(values, scope_.session_.random), expression);
}

std::optional<double> Evaluator::of_builtin(const Expression& expression, const BuiltinFunction& builtin,
                                            const std::vector<double>& values) {
  const double result = builtin.value(values);
  if (builtin.passes_infinity && std::isinf(result)) return result;
  if (std::isfinite(result)) return result;
  return finite(result, expression, fmt::format("{}({}) is not a finite number", expression.text, fmt::join(values, ", ")));
}

std::optional<double> Evaluator::unknown_function(const Expression& expression) {
  if (same_name(expression.text, "v") || same_name(expression.text, "i")) {
    reporter().error("E-not-supported", expression.span,
                     "this value cannot follow a voltage or current; try a switch S or W, or a source B, E, F, G, H");
    return std::nullopt;
  }
  std::vector<std::string> names{"if", "ternary_fcn"};
  for (const BuiltinFunction& function : builtin_functions()) names.emplace_back(function.name);
  for (const Scope* at = &scope_; at != nullptr; at = at->outer()) {
    for (const auto& function : at->definition().functions) names.push_back(function.second.name);
  }
  reporter().error("E-unknown-function", expression.span,
                   fmt::format("unknown function '{}'{}", expression.text, suggestion(expression.text, names)));
  return std::nullopt;
}

std::optional<double> Evaluator::of_function(const Expression& expression, const FunctionText& function, Scope& home) {
  Session& session = scope_.session_;
  if (!count_is_right(expression, function.formals.size(), function.formals.size())) return std::nullopt;
  if (session.functions_exhausted) return std::nullopt;
  if (depth_ > Session::deepest || ++session.function_calls > most_function_calls) return too_many_calls(function);
  Arguments arguments{&function, {}};
  if (!arguments_of(expression, arguments.values)) return std::nullopt;
  return Evaluator(home, depth_ + 1, &arguments).value(*function.body);
}

}  // namespace pwlsim::circuit
