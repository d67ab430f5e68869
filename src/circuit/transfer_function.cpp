#include "circuit/transfer_function.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/evaluator.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Expression;
using Kind = Expression::Kind;
using Polynomial = std::vector<double>;

constexpr double highest_power = 32.0;

bool is_variable(const Expression& expression) { return expression.kind == Kind::name && same_name(expression.text, "s"); }

bool depends_on_s(const Expression& expression) {
  return is_variable(expression) || std::any_of(expression.arguments.begin(), expression.arguments.end(), depends_on_s);
}

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial result(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
  return result;
}

Polynomial sum(const Polynomial& a, const Polynomial& b, double sign) {
  Polynomial result(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) result[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) result[i] += sign * b[i];
  return result;
}

TransferFunction product(const TransferFunction& a, const TransferFunction& b) {
  return {product(a.numerator, b.numerator), product(a.denominator, b.denominator)};
}

TransferFunction inverse(TransferFunction a) {
  std::swap(a.numerator, a.denominator);
  return a;
}

TransferFunction sum(const TransferFunction& a, const TransferFunction& b, double sign) {
  if (a.denominator == b.denominator) return {sum(a.numerator, b.numerator, sign), a.denominator};
  return {sum(product(a.numerator, b.denominator), product(b.numerator, a.denominator), sign), product(a.denominator, b.denominator)};
}

void drop_leading_zeros(Polynomial& list) {
  while (list.size() > 1 && list.back() == 0.0) list.pop_back();
}

class Reading {
 public:
  Reading(Scope& scope, Reporter& reporter, std::string_view owner) : scope_(scope), reporter_(reporter), owner_(owner) {}

  std::optional<TransferFunction> of(const Expression& expression) {
    if (is_variable(expression)) return TransferFunction{{0.0, 1.0}, {1.0}};
    if (!depends_on_s(expression)) return constant(expression);
    if (expression.kind == Kind::unary) return of_unary(expression);
    if (expression.kind == Kind::binary) return of_binary(expression);
    return refuse(expression);
  }

 private:
  std::optional<TransferFunction> constant(const Expression& expression) {
    const std::optional<double> value = Evaluator(scope_, 0).value(expression);
    if (!value) return std::nullopt;
    return TransferFunction{{*value}, {1.0}};
  }

  std::nullopt_t refuse(const Expression& expression) {
    reporter_.error("E-not-supported", expression.span,
                    fmt::format("{}: '{}' is no fraction of polynomials in s", owner_, reporter_.text(expression.span)));
    return std::nullopt;
  }

  std::optional<TransferFunction> of_unary(const Expression& expression) {
    std::optional<TransferFunction> result = of(expression.arguments[0]);
    if (!result || expression.text == "+") return result;
    if (expression.text != "-") return refuse(expression);
    return product(*result, {{-1.0}, {1.0}});
  }

  std::optional<TransferFunction> of_binary(const Expression& expression) {
    const std::string_view op = expression.text;
    if (op == "^" || op == "**") return of_power(expression);
    const std::optional<TransferFunction> a = of(expression.arguments[0]), b = of(expression.arguments[1]);
    if (!a || !b) return std::nullopt;
    if (op == "+" || op == "-") return sum(*a, *b, op == "+" ? 1.0 : -1.0);
    if (op == "*") return product(*a, *b);
    return op == "/" ? product(*a, inverse(*b)) : std::optional<TransferFunction>(refuse(expression));
  }

  std::optional<TransferFunction> of_power(const Expression& expression) {
    if (depends_on_s(expression.arguments[1])) return refuse(expression);
    const std::optional<TransferFunction> base = of(expression.arguments[0]);
    const std::optional<double> power = Evaluator(scope_, 0).value(expression.arguments[1]);
    if (!base || !power) return std::nullopt;
    if (*power != std::floor(*power) || std::abs(*power) > highest_power) return refuse(expression);
    TransferFunction result{{1.0}, {1.0}};
    for (double k = 0.0; k < std::abs(*power); ++k) result = product(result, *base);
    return *power < 0.0 ? inverse(std::move(result)) : result;
  }

  Scope& scope_;
  Reporter& reporter_;
  std::string_view owner_;
};

bool is_finite(const Polynomial& list) {
  return std::all_of(list.begin(), list.end(), [](double c) { return std::isfinite(c); });
}

}  // namespace

std::optional<TransferFunction> read_transfer_function(const Expression& expression, Scope& scope, Reporter& reporter,
                                                       std::string_view owner) {
  std::optional<TransferFunction> result = Reading(scope, reporter, owner).of(expression);
  if (!result) return std::nullopt;
  drop_leading_zeros(result->numerator);
  drop_leading_zeros(result->denominator);
  if (result->denominator.back() == 0.0 || !is_finite(result->numerator) || !is_finite(result->denominator)) {
    reporter.error("E-not-finite", expression.span,
                   result->denominator.back() == 0.0 ? "division by zero" : "the result is not a finite number");
    return std::nullopt;
  }
  if (result->numerator.size() <= result->denominator.size()) return result;
  reporter.error("E-range", expression.span,
                 fmt::format("the numerator of {} is of higher degree than its denominator; try ddt() of its input", owner));
  return std::nullopt;
}

}  // namespace pwlsim::circuit
