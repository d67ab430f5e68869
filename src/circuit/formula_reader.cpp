#include "circuit/formula_reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/evaluator.hpp"
#include "circuit/expression_derivative.hpp"
#include "circuit/function_derivatives.hpp"
#include "circuit/transfer_function.hpp"

namespace pwlsim::circuit {
namespace {

using elements::AffineSum;
using elements::Condition;
using elements::constant_sum;
using elements::Varied;
using netlist::Expression;
using Kind = Expression::Kind;

constexpr int deepest_formula = 3000;
constexpr int largest_power = 16;  ///< of a function of time

constexpr double least_steepness = 100.0;  ///< per volt or ampere: tanh is within 10⁻² of its ends from 30 mV on

bool is_steep(const elements::AffineSum& sum) {
  return std::any_of(sum.terms.begin(), sum.terms.end(), [](const auto& term) { return std::abs(term.second.value) >= least_steepness; });
}

bool is_signal(const Expression& call) {
  const bool named = same_name(call.text, "v") || same_name(call.text, "i");
  return named && !call.arguments.empty() &&
         std::all_of(call.arguments.begin(), call.arguments.end(), [](const Expression& a) { return a.kind == Kind::name; });
}

bool is_comparison(std::string_view op) { return op == "<" || op == ">" || op == "<=" || op == ">="; }
bool is_logic(std::string_view op) { return op == "&" || op == "&&" || op == "|" || op == "||"; }

bool is_finite(const AffineSum& sum) {
  return std::isfinite(sum.constant.value) &&
         std::all_of(sum.terms.begin(), sum.terms.end(), [](const auto& t) { return std::isfinite(t.second.value); });
}

}  // namespace

bool check_table(const std::vector<elements::TablePoint>& points, SourceSpan span, Reporter& reporter) {
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double before = points[k - 1].x.value, x = points[k].x.value;
    if (x >= before) continue;
    reporter.error("E-table-order", span, fmt::format("the x of a table must not decrease: {} follows {}", x, before));
    return false;
  }
  return true;
}

bool FormulaReader::read(const Expression& expression, bool is_current) {
  const std::optional<Sum> value = sum(expression, {place_.scope});
  return value && keep(*value, is_current, expression.span);
}

bool FormulaReader::read_transfer(const Expression* input, const Expression& transfer, bool is_current) {
  const std::optional<elements::Fraction> fraction = read_transfer_function(transfer, place_.scope, reporter(), instance_.name);
  const std::optional<Sum> driven = input != nullptr ? sum(*input, {place_.scope}) : control();
  return fraction && driven && keep(builder_.transfer(*driven, *fraction), is_current, transfer.span);
}

/// Its derivatives are not followed.
void FormulaReader::lose(const Sum& sum) {
  const auto lose_number = [&](const Varied& number) {
    std::vector<char>& read = place_.scope.session().read_apart;
    if (read.size() < number.gradient.size()) read.resize(number.gradient.size());
    for (std::size_t k = 0; k < number.gradient.size(); ++k)
      if (number.gradient[k] != 0.0) read[k] = 1;
  };
  lose_number(sum.constant);
  for (const auto& term : sum.terms) lose_number(term.second);
}

AffineSum FormulaReader::control() { return instance_.references.empty() ? builder_.voltage(0) : builder_.current(0); }

bool FormulaReader::read_table(const Expression* x, const std::vector<elements::TablePoint>& points, bool is_current) {
  const std::optional<Sum> argument = x != nullptr ? sum(*x, {place_.scope}) : control();
  return argument && keep(builder_.table(*argument, points, false), is_current, instance_.span);
}

bool FormulaReader::keep(const Sum& value, bool is_current, SourceSpan span) {
  elements::Formula formula = std::move(builder_).finish(value);
  formula.open_products = std::move(open_products_);
  const bool finite =
      is_finite(formula.value) && std::all_of(formula.parts.begin(), formula.parts.end(), [](const auto& part) {
        return is_finite(part.argument) && is_finite(part.above) && is_finite(part.below) && std::isfinite(part.start.value);
      });
  if (!finite) reporter().error("E-not-finite", span, "the result is not a finite number");
  instance_.formula = std::move(formula);
  instance_.formula_is_current = is_current;
  return finite;
}

std::nullopt_t FormulaReader::refuse(const Expression& expression, std::string_view what) {
  reporter().error("E-not-piecewise-linear", expression.span, fmt::format("{}: {} has no piecewise-linear form", instance_.name, what));
  return std::nullopt;
}

std::nullopt_t FormulaReader::too_deep(const Expression& expression) {
  reporter().error("E-too-deep", expression.span, fmt::format("expressions nest deeper than {}", deepest_formula));
  return std::nullopt;
}

std::optional<FormulaReader::Meaning> FormulaReader::meaning(const Expression& expression, const Context& context) {
  if (nesting_ >= deepest_formula) return too_deep(expression);
  ++nesting_;
  std::optional<Meaning> result = of_kind(expression, context);
  --nesting_;
  return result;
}

std::optional<FormulaReader::Meaning> FormulaReader::of_kind(const Expression& expression, const Context& context) {
  switch (expression.kind) {
    case Kind::number:
    case Kind::name:
      return of_name(expression, context);
    case Kind::unary:
      return of_unary(expression, context);
    case Kind::binary:
      return of_binary(expression, context);
    case Kind::conditional:
      return of_choice(expression.arguments[1], expression.arguments[2], expression.arguments[0], context);
    case Kind::call:
      return of_call(expression, context);
  }
  return std::nullopt;
}

std::optional<AffineSum> FormulaReader::sum(const Expression& expression, const Context& context) {
  std::optional<Meaning> result = meaning(expression, context);
  if (!result) return std::nullopt;
  return std::move(result->value);
}

std::optional<Condition> FormulaReader::condition(const Expression& expression, const Context& context) {
  const std::optional<Meaning> result = meaning(expression, context);
  if (!result) return std::nullopt;
  return condition_of(*result, expression);
}

std::optional<Condition> FormulaReader::condition_of(const Meaning& meaning, const Expression& expression) {
  if (meaning.condition) return meaning.condition;
  if (meaning.value.is_constant()) return Condition{constant_sum(meaning.value.constant.value != 0.0 ? 1.0 : 0.0), std::nullopt};
  reporter().note(
      "N-condition", expression.span,
      fmt::format("{}: '{}' as a condition is true from 0.5 on, as in LTspice", instance_.name, reporter().text(expression.span)));
  return builder_.greater(meaning.value, constant_sum(0.5));
}

std::optional<Varied> FormulaReader::constant(const Expression& expression, const Context& context, std::string_view what) {
  const std::optional<Sum> value = sum(expression, context);
  if (!value) return std::nullopt;
  if (value->is_constant()) return value->constant;
  reporter().error("E-not-piecewise-linear", expression.span, fmt::format("{}: {} must be a number", instance_.name, what));
  return std::nullopt;
}

std::optional<FormulaReader::Meaning> FormulaReader::of_name(const Expression& expression, const Context& context) {
  if (expression.kind == Kind::name) {
    if (context.arguments != nullptr) {
      const auto argument = context.arguments->find(without_case(expression.text));
      if (argument != context.arguments->end()) return argument->second;
    }
    if (same_name(expression.text, "time")) return Meaning{builder_.time(), std::nullopt};
  }
  std::optional<Varied> value = varied_number(expression, context.scope, context.depth);
  if (!value) return std::nullopt;
  return Meaning{constant_sum(std::move(*value)), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_unary(const Expression& expression, const Context& context) {
  if (expression.text == "!") {
    const std::optional<Condition> asked = condition(expression.arguments[0], context);
    if (!asked) return std::nullopt;
    const Condition opposite = elements::FormulaBuilder::negation(*asked);
    return Meaning{opposite.value, opposite};
  }
  std::optional<Sum> value = sum(expression.arguments[0], context);
  if (value && expression.text == "-") value = -1.0 * *value;
  if (!value) return std::nullopt;
  return Meaning{std::move(*value), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_binary(const Expression& expression, const Context& context) {
  std::vector<const Expression*> spine;  // a long sum is a deep tree on its left: no recursion there
  const Expression* at = &expression;
  for (; at->kind == Kind::binary; at = &at->arguments[0]) spine.push_back(at);
  std::optional<Meaning> left = meaning(*at, context);
  for (auto operation = spine.rbegin(); operation != spine.rend(); ++operation) {
    const std::optional<Meaning> right = meaning((*operation)->arguments[1], context);
    left = left && right ? of_operation(**operation, (*operation)->arguments[0], *left, *right) : std::nullopt;
  }
  return left;
}

std::optional<FormulaReader::Meaning> FormulaReader::of_operation(const Expression& operation, const Expression& left_part,
                                                                  const Meaning& left, const Meaning& right) {
  const std::string_view op = operation.text;
  const Sum& a = left.value;
  const Sum& b = right.value;
  if (a.is_number() && b.is_number()) return of_numbers(operation, a.constant, b.constant);
  if (op == "+") return Meaning{a + b, std::nullopt};
  if (op == "-") return Meaning{a - b, std::nullopt};
  if (is_comparison(op)) return of_comparison(operation, a, b);
  if (is_logic(op)) return of_logic(operation, left_part, left, right);
  if (op == "^" || op == "**") return of_power(operation, a, b);
  if (op == "*") return of_product(operation, left, right);
  if (op != "/") return refuse(operation, fmt::format("'{}' between signals", op));
  if (!b.is_number()) return of_quotient(operation, a, b);
  if (b.constant.value != 0.0) return Meaning{1.0 / b.constant * a, std::nullopt};
  reporter().error("E-not-finite", operation.span, "division by zero");
  return std::nullopt;
}

std::optional<FormulaReader::Meaning> FormulaReader::of_numbers(const Expression& operation, const Varied& left, const Varied& right) {
  const double value = find_binary(operation.text)(left.value, right.value);
  if (std::isfinite(value)) {
    const Partials partials = operation_partials(operation.text, left.value, right.value);
    Varied result = applied(left, right, value, partials.left, partials.right);
    // Where the sides of a comparison tie, the parameter decides it.
    if (is_comparison(operation.text) && left.value == right.value) result = unfollowed(unfollowed(result, left), right);
    return Meaning{constant_sum(std::move(result)), std::nullopt};
  }
  reporter().error("E-not-finite", operation.span,
                   operation.text == "/" && right.value == 0.0 ? "division by zero" : "the result is not a finite number");
  return std::nullopt;
}

std::optional<FormulaReader::Meaning> FormulaReader::of_comparison(const Expression& operation, const Sum& left, const Sum& right) {
  const bool or_equal = operation.text.size() == 2;
  const Condition asked = operation.text[0] == '>' ? builder_.greater(left, right, or_equal) : builder_.greater(right, left, or_equal);
  return Meaning{asked.value, asked};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_logic(const Expression& operation, const Expression& left_part, const Meaning& left,
                                                              const Meaning& right) {
  const std::optional<Condition> a = condition_of(left, left_part);
  const std::optional<Condition> b = condition_of(right, operation.arguments[1]);
  if (!a || !b) return std::nullopt;
  const bool is_and = operation.text[0] == '&';
  for (const auto& [one, other] : {std::pair(&*a, &*b), std::pair(&*b, &*a)}) {
    if (!one->is_constant()) continue;
    const Condition result = one->holds() == is_and ? *other : *one;
    return Meaning{result.value, result};
  }
  const Condition result = is_and ? builder_.both(*a, *b) : builder_.either(*a, *b);
  return Meaning{result.value, result};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_product(const Expression& operation, const Meaning& left, const Meaning& right) {
  if (left.condition && right.condition) {
    const Condition result = builder_.both(*left.condition, *right.condition);
    return Meaning{result.value, result};
  }
  if (left.condition) return Meaning{builder_.choose(*left.condition, right.value, {}), std::nullopt};
  if (right.condition) return Meaning{builder_.choose(*right.condition, left.value, {}), std::nullopt};
  return Meaning{product(operation, left.value, right.value), std::nullopt};
}

/// What has no switched form by itself may have one when all elements are there.
AffineSum FormulaReader::product(const Expression& operation, const Sum& a, const Sum& b) {
  if (std::optional<Sum> product = builder_.product(a, b)) return std::move(*product);
  Sum product = builder_.open_product(a, b);
  open_products_.emplace_back(product.terms[0].first, operation.span);
  return product;
}

std::optional<FormulaReader::Meaning> FormulaReader::of_quotient(const Expression& operation, const Sum& a, const Sum& b) {
  if (const std::optional<Sum> reciprocal = builder_.reciprocal(b)) return Meaning{product(operation, a, *reciprocal), std::nullopt};
  Sum quotient = builder_.open_quotient(a, b);
  open_products_.emplace_back(quotient.terms[0].first, operation.span);
  return Meaning{std::move(quotient), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_power(const Expression& operation, const Sum& base, const Sum& exponent) {
  const double times = exponent.is_constant() ? exponent.constant.value : 0.0;
  lose(exponent);
  if (times == 1.0) return Meaning{base, std::nullopt};
  if (times < 2.0 || times > largest_power || times != std::floor(times)) return of_smooth(operation, *find_builtin("pow"), base, exponent);
  Sum power = base;
  for (int k = 1; k < static_cast<int>(times); ++k) power = product(operation, power, base);
  return Meaning{std::move(power), std::nullopt};
}

std::optional<FormulaReader::Meaning> FormulaReader::of_choice(const Expression& yes, const Expression& no, const Expression& asked,
                                                               const Context& context) {
  const std::optional<Condition> which = condition(asked, context);
  if (!which) return std::nullopt;
  if (which->is_constant()) return meaning(which->holds() ? yes : no, context);
  const std::optional<Sum> a = sum(yes, context);
  const std::optional<Sum> b = sum(no, context);
  if (!a || !b) return std::nullopt;
  return Meaning{builder_.choose(*which, *a, *b), std::nullopt};
}

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
  const auto piecewise = [](Sum value) { return Meaning{std::move(value), std::nullopt}; };
  if (key == "u" || key == "stp" || key == "uramp") {
    if (!count_is(expression, 1, 1)) return std::nullopt;
    return piecewise(key == "uramp" ? builder_.positive(values[0]) : builder_.step(values[0]));
  }
  const BuiltinFunction* builtin = find_builtin(key);
  if (builtin == nullptr) {
    const bool is_delay = key == "delay" || key == "absdelay";
    reporter().error(is_delay ? "E-not-supported" : "E-unknown-function", expression.span,
                     is_delay
                         ? fmt::format("{}: {} in an expression is not supported; try Laplace=1/(1+s*T), a low pass of that time constant",
                                       instance_.name, key)
                         : fmt::format("unknown function '{}'", expression.text));
    return std::nullopt;
  }
  if (!count_is(expression, builtin->least, builtin->most)) return std::nullopt;
  if (std::all_of(values.begin(), values.end(), [](const Sum& value) { return value.is_number(); })) {
    std::vector<Varied> arguments;
    std::vector<double> numbers;
    for (const Sum& value : values) {
      arguments.push_back(value.constant);
      numbers.push_back(value.constant.value);
    }
    const double value = builtin->value(numbers);
    if (std::isfinite(value) || builtin->passes_infinity) return piecewise(constant_sum(varied_result(*builtin, arguments, value)));
    reporter().error("E-not-finite", expression.span,
                     fmt::format("{}({}) is not a finite number", expression.text, fmt::join(numbers, ", ")));
    return std::nullopt;
  }
  if (key == "buf" || key == "inv") {
    const Condition high = builder_.greater(values[0], constant_sum(0.5));
    const Condition result = key == "buf" ? high : elements::FormulaBuilder::negation(high);
    return Meaning{result.value, result};
  }
  if (key == "abs") return piecewise(builder_.absolute(values[0]));
  if (key == "sgn") return piecewise(builder_.sign(values[0]));
  if (key == "limit") return piecewise(builder_.limit(values[0], values[1], values[2]));
  if (key == "min" || key == "max") {
    Sum extreme = values[0];
    for (std::size_t k = 1; k < values.size(); ++k)
      extreme = key == "min" ? builder_.minimum(extreme, values[k]) : builder_.maximum(extreme, values[k]);
    return piecewise(std::move(extreme));
  }
  if (std::optional<Sum> of_time = rounded(key, values)) return piecewise(std::move(*of_time));
  if (key == "tanh" && is_steep(values[0])) return of_saturation(expression, values[0]);
  return of_smooth(expression, *builtin, values[0], values.size() > 1 ? values[1] : Sum{});
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
