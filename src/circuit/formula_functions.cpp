/// FormulaReader: calls of functions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/names.hpp"
#include "circuit/evaluator.hpp"
#include "circuit/expression_derivative.hpp"
#include "circuit/formula_reader.hpp"
#include "circuit/function_derivatives.hpp"

namespace pwlsim::circuit {
namespace {

using elements::AffineSum;
using elements::Condition;
using elements::constant_sum;
using elements::Varied;
using netlist::Expression;
using Kind = Expression::Kind;

constexpr double least_steepness = 100.0;  ///< per volt or ampere: tanh is within 10⁻² of its ends from 30 mV on

bool is_steep(const elements::AffineSum& sum) {
  return std::any_of(sum.terms.begin(), sum.terms.end(), [](const auto& term) { return std::abs(term.second.value) >= least_steepness; });
}

bool is_signal(const Expression& call) {
  const bool named = same_name(call.text, "v") || same_name(call.text, "i");
  return named && !call.arguments.empty() &&
         std::all_of(call.arguments.begin(), call.arguments.end(), [](const Expression& a) { return a.kind == Kind::name; });
}

}  // namespace

std::optional<FormulaReader::Meaning> FormulaReader::of_call(const Expression& expression, const Context& context) {
  if (is_signal(expression)) return of_signal(expression);
  const std::string key = without_case(expression.text);
  Scope* home = nullptr;
  if (const FunctionText* function = find_function(context.scope, key, home)) return of_function(expression, *function, *home, context);
  if (key == "if" || key == "ternary_fcn") {
    if (!count_is(expression, 3, 3)) return std::nullopt;
    return of_choice(expression.arguments[1], expression.arguments[2], expression.arguments[0], context);
  }
  if (key == "table" || key == "pwl") return of_table(expression, context, key == "pwl");
  if (key == "sdt" || key == "idt") return of_integral(expression, context);
  if (key == "idtmod") return of_wrapped_integral(expression, context);
  if (key == "ddt" || key == "d") return of_derivative(expression, context);
  return of_builtin(expression, context);
}

std::optional<FormulaReader::Meaning> FormulaReader::of_signal(const Expression& expression) {
  const bool is_voltage = same_name(expression.text, "v");
  if (!count_is(expression, 1, is_voltage ? 2 : 1)) return std::nullopt;
  if (!is_voltage) {
    const Expression& name = expression.arguments[0];
    const std::string full = place_.prefix + name.text;
    auto& list = instance_.references;
    const auto known = std::find_if(list.begin(), list.end(), [&](const auto& r) { return same_name(r.name, full); });
    const auto index = static_cast<int>(known - list.begin());
    if (known == list.end()) list.push_back({full, name.span, -1});
    return Meaning{builder_.current(index), std::nullopt};
  }
  Sum value;
  double sign = 1.0;
  for (const Expression& name : expression.arguments) {  // a pair is a difference: v(a,b) and v(a)-v(b) share their ports
    netlist::Item word;
    word.text = name.text;
    word.span = name.span;
    const elements::NodePair pair{binding_.node(place_, word), model::ground};
    auto& list = instance_.control_nodes;
    const auto known = std::find_if(list.begin(), list.end(), [&](const auto& other) { return other.p == pair.p && other.n == pair.n; });
    const auto index = static_cast<int>(known - list.begin());
    if (known == list.end()) list.push_back(pair);
    if (pair.p != model::ground) value = value + sign * builder_.voltage(index);
    sign = -1.0;
  }
  return Meaning{std::move(value), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_function(const Expression& expression, const FunctionText& function, Scope& home,
                                                                 const Context& context) {
  if (!count_is(expression, function.formals.size(), function.formals.size())) return std::nullopt;
  if (context.depth > Session::deepest) return too_deep(expression);
  Names arguments;
  for (std::size_t k = 0; k < function.formals.size(); ++k) {
    std::optional<Meaning> argument = meaning(expression.arguments[k], context);
    if (!argument) return std::nullopt;
    arguments.emplace(function.formals[k], std::move(*argument));
  }
  const Context inside{home, &arguments, context.depth + 1};
  if (function.body->kind == netlist::Item::Kind::expression) return meaning(*function.body->expression, inside);
  std::optional<Varied> value = varied_number(*function.body, home, inside.depth);
  if (!value) return std::nullopt;
  return Meaning{constant_sum(std::move(*value)), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_table(const Expression& expression, const Context& context, bool extrapolated) {
  const std::size_t count = expression.arguments.size();
  if (count < 3 || count % 2 == 0) {
    reporter().error("E-argument-count", expression.span, fmt::format("{} takes x and pairs of numbers", expression.text));
    return std::nullopt;
  }
  const std::optional<Sum> x = sum(expression.arguments[0], context);
  std::vector<elements::TablePoint> points;
  for (std::size_t k = 1; k < count; k += 2) {
    const std::optional<Varied> at = constant(expression.arguments[k], context, "a point of a table");
    const std::optional<Varied> value = constant(expression.arguments[k + 1], context, "a point of a table");
    if (!at || !value) return std::nullopt;
    points.push_back({*at, *value});
  }
  if (!x || !check_table(points, expression.span, reporter())) return std::nullopt;
  return Meaning{builder_.table(*x, points, extrapolated), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_integral(const Expression& expression, const Context& context) {
  if (!count_is(expression, 1, 3)) return std::nullopt;
  const std::optional<Sum> rate = sum(expression.arguments[0], context);
  const std::optional<Varied> start =
      expression.arguments.size() > 1 ? constant(expression.arguments[1], context, "the start of an integral") : Varied();
  if (!rate || !start) return std::nullopt;
  if (expression.arguments.size() < 3) return Meaning{builder_.integral(*rate, *start), std::nullopt};
  const std::optional<elements::Condition> held = condition(expression.arguments[2], context);
  if (!held) return std::nullopt;
  return Meaning{builder_.integral(*rate, *start, *held), std::nullopt};
}

/// LTspice's idtmod(x, start, modulus, offset): the integral stays from offset to offset + modulus.
std::optional<FormulaReader::Meaning> FormulaReader::of_wrapped_integral(const Expression& expression, const Context& context) {
  if (!count_is(expression, 3, 4)) return std::nullopt;
  const std::optional<Sum> rate = sum(expression.arguments[0], context);
  const std::optional<Varied> start = constant(expression.arguments[1], context, "the start of an integral");
  const std::optional<Varied> width = constant(expression.arguments[2], context, "the modulus of an integral");
  const std::optional<Varied> from =
      expression.arguments.size() > 3 ? constant(expression.arguments[3], context, "the offset of an integral") : Varied();
  if (!rate || !start || !width || !from) return std::nullopt;
  if (width->value > 0.0) {
    std::optional<Sum> value = builder_.wrapped_integral(*rate, *start, *from, *from + *width);
    if (value) return Meaning{std::move(*value), std::nullopt};
  }
  reporter().error("E-range", expression.arguments[2].span, fmt::format("{}: the modulus of idtmod must be positive", instance_.name));
  return std::nullopt;
}

std::optional<FormulaReader::Meaning> FormulaReader::of_derivative(const Expression& expression, const Context& context) {
  if (!count_is(expression, 1, 1)) return std::nullopt;
  const std::optional<Sum> value = sum(expression.arguments[0], context);
  if (!value) return std::nullopt;
  std::optional<Sum> slope = builder_.derivative(*value);
  if (!slope) return refuse(expression, "the derivative of a comparison or a choice, which jumps,");
  return Meaning{std::move(*slope), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_builtin(const Expression& expression, const Context& context) {
  std::vector<Sum> values;
  for (const Expression& argument : expression.arguments) {
    std::optional<Sum> value = sum(argument, context);
    if (!value) return std::nullopt;
    values.push_back(std::move(*value));
  }
  return of_values(expression, values);
}

std::optional<FormulaReader::Meaning> FormulaReader::of_values(const Expression& expression, const std::vector<Sum>& values) {
  const std::string key = without_case(expression.text);
  if (key == "u" || key == "stp" || key == "uramp") {
    if (!count_is(expression, 1, 1)) return std::nullopt;
    return piecewise(key == "uramp" ? builder_.positive(values[0]) : builder_.step(values[0]));
  }
  const BuiltinFunction* builtin = find_builtin(key);
  if (builtin == nullptr) {
    report_unknown(expression, key);
    return std::nullopt;
  }
  if (!count_is(expression, builtin->least, builtin->most)) return std::nullopt;
  if (std::all_of(values.begin(), values.end(), [](const Sum& value) { return value.is_number(); }))
    return of_constants(expression, *builtin, values);
  if (std::optional<Meaning> meaning = of_corners(key, values)) return meaning;
  if (std::optional<Sum> of_time = rounded(key, values)) return piecewise(std::move(*of_time));
  if (key == "tanh" && is_steep(values[0])) return of_saturation(expression, values[0]);
  return of_smooth(expression, *builtin, values[0], values.size() > 1 ? values[1] : Sum{});
}

void FormulaReader::report_unknown(const Expression& expression, const std::string& key) {
  const bool is_delay = key == "delay" || key == "absdelay";
  reporter().error(is_delay ? "E-not-supported" : "E-unknown-function", expression.span,
                   is_delay
                       ? fmt::format("{}: {} in an expression is not supported; try Laplace=1/(1+s*T), a low pass of that time constant",
                                     instance_.name, key)
                       : fmt::format("unknown function '{}'", expression.text));
}

std::optional<FormulaReader::Meaning> FormulaReader::of_constants(const Expression& expression, const BuiltinFunction& builtin,
                                                                  const std::vector<Sum>& values) {
  std::vector<Varied> arguments;
  std::vector<double> numbers;
  for (const Sum& value : values) {
    arguments.push_back(value.constant);
    numbers.push_back(value.constant.value);
  }
  const double value = builtin.value(numbers);
  if (std::isfinite(value) || builtin.passes_infinity) return piecewise(constant_sum(varied_result(builtin, arguments, value)));
  reporter().error("E-not-finite", expression.span,
                   fmt::format("{}({}) is not a finite number", expression.text, fmt::join(numbers, ", ")));
  return std::nullopt;
}

/// Of functions that are piecewise linear in their arguments; empty: of another.
std::optional<FormulaReader::Meaning> FormulaReader::of_corners(std::string_view key, const std::vector<Sum>& values) {
  if (key == "buf" || key == "inv") {
    const Condition high = builder_.greater(values[0], constant_sum(0.5));
    const Condition result = key == "buf" ? high : elements::FormulaBuilder::negation(high);
    return Meaning{result.value, result};
  }
  if (key == "abs") return piecewise(builder_.absolute(values[0]));
  if (key == "sgn") return piecewise(builder_.sign(values[0]));
  if (key == "limit") return piecewise(builder_.limit(values[0], values[1], values[2]));
  if (key != "min" && key != "max") return std::nullopt;
  Sum extreme = values[0];
  for (std::size_t k = 1; k < values.size(); ++k)
    extreme = key == "min" ? builder_.minimum(extreme, values[k]) : builder_.maximum(extreme, values[k]);
  return piecewise(std::move(extreme));
}

/// A comparator as decks write it: the lines that tanh has at 0 and far away.
FormulaReader::Meaning FormulaReader::of_saturation(const Expression& expression, const Sum& x) {
  if (reporter().first_time("tanh:" + instance_.name))
    reporter().note("N-idealised", expression.span,
                    fmt::format("{}: tanh(x) of a signal times {} or more is a comparator, and is read as limit(x,-1,1)", instance_.name,
                                least_steepness));
  return {builder_.limit(x, constant_sum(-1.0), constant_sum(1.0)), std::nullopt};
}

/// What has no form by itself may have one when all elements are there: V(m) may be a number.
FormulaReader::Meaning FormulaReader::of_smooth(const Expression& expression, const BuiltinFunction& function, const Sum& a, const Sum& b) {
  using Form = elements::SmoothFunction::Form;
  static constexpr std::pair<std::string_view, Form> forms[] = {
      {"sin", Form::sine},        {"cos", Form::cosine},      {"exp", Form::exponential},   {"asin", Form::arc_sine},
      {"arcsin", Form::arc_sine}, {"acos", Form::arc_cosine}, {"arccos", Form::arc_cosine},
  };
  elements::SmoothFunction called{function.name, function.value, function.most == 1 ? 1U : 2U};
  for (const auto& [name, form] : forms)
    if (name == function.name) called.form = form;
  if (std::optional<Sum> value = builder_.call(called, a, b)) return {std::move(*value), std::nullopt};
  Sum open = builder_.open_call(called, a, b);
  open_products_.emplace_back(open.terms[0].first, expression.span);
  return {std::move(open), std::nullopt};
}

/// Of straight lines in time.
std::optional<AffineSum> FormulaReader::rounded(std::string_view key, const std::vector<Sum>& values) {
  const Sum& x = values[0];
  if (key == "floor") return builder_.floor(x);
  if (key == "round") return builder_.floor(x + constant_sum(0.5));
  if (key == "mod" && values[1].is_number() && values[1].constant.value != 0.0) {
    const std::optional<Sum> whole = builder_.floor(1.0 / values[1].constant * x);
    if (whole) return x - values[1].constant * *whole;
  }
  if (key != "ceil" && key != "int") return std::nullopt;
  const std::optional<Sum> whole = builder_.floor(key == "ceil" ? -1.0 * x : x);
  if (!whole || (key == "int" && !builder_.rises_from_zero(x))) return std::nullopt;
  return key == "ceil" ? -1.0 * *whole : *whole;
}

bool FormulaReader::count_is(const Expression& expression, std::size_t least, std::size_t most) {
  const std::size_t count = expression.arguments.size();
  if (count >= least && count <= most) return true;
  const std::string wanted = fmt::format("{}{} argument{}", least, least == most ? "" : " or more", least == 1 ? "" : "s");
  reporter().error("E-argument-count", expression.span, fmt::format("{} takes {}, not {}", expression.text, wanted, count));
  return false;
}

}  // namespace pwlsim::circuit
