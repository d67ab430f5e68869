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
  const std::optional<elements::RationalFunction> fraction = read_transfer_function(transfer, place_.scope, reporter(), instance_.name);
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

}  // namespace pwlsim::circuit
