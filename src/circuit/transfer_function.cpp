#include "circuit/transfer_function.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/evaluator.hpp"
#include "circuit/expression_derivative.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Expression;
using ExpressionKind = Expression::Kind;
using elements::Varied;
using Polynomial = std::vector<Varied>;  ///< ascending powers of s, at least one

constexpr double largest_degree = 100;

Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  Polynomial product(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) product[i + j] = product[i + j] + a[i] * b[j];
  return product;
}

Polynomial sum_of(const Polynomial& a, const Polynomial& b, double factor) {
  Polynomial sum(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] = sum[i] + a[i];
  for (std::size_t i = 0; i < b.size(); ++i) sum[i] = sum[i] + factor * b[i];
  return sum;
}

bool is_zero(const Polynomial& a) {
  return std::all_of(a.begin(), a.end(), [](const Varied& c) { return c.value == 0.0; });
}

struct Quotient {
  Polynomial num{0.0}, den{1.0};

  [[nodiscard]] bool is_number() const { return num.size() == 1 && den.size() == 1; }
  [[nodiscard]] Varied number() const { return num[0] / den[0]; }
};

Quotient number_of(const Varied& value) { return {{value}, {1.0}}; }

/// What has one denominator keeps it: no pole is added that cancels.
Quotient sum_of(const Quotient& a, const Quotient& b, double factor) {
  if (a.den == b.den) return {sum_of(a.num, b.num, factor), a.den};
  return {sum_of(a.num * b.den, b.num * a.den, factor), a.den * b.den};
}

class TransferReader {
 public:
  using Names = std::unordered_map<std::string, Quotient>;
  /// Where names are looked up: a scope, and the arguments of the .func function whose body is read.
  struct Place {
    Scope& scope;
    const Names* arguments = nullptr;
    int depth = 0;
  };

  TransferReader(Reporter& reporter, std::string_view owner) : reporter_(reporter), owner_(owner) {}

  std::optional<elements::RationalFunction> read(const Expression& expression, Scope& scope) {
    std::optional<Quotient> quotient = value(expression, {scope});
    if (!quotient) return std::nullopt;
    cancel_s(*quotient);
    without_leading_zeros(quotient->num);
    without_leading_zeros(quotient->den);
    const auto is_infinite = [](const Varied& c) { return !std::isfinite(c.value); };
    if (std::any_of(quotient->num.begin(), quotient->num.end(), is_infinite) ||
        std::any_of(quotient->den.begin(), quotient->den.end(), is_infinite))
      return fail("E-not-finite", expression, "a coefficient of the fraction is not a finite number");
    if (quotient->num.size() > quotient->den.size()) return improper(expression, *quotient);
    std::reverse(quotient->num.begin(), quotient->num.end());
    std::reverse(quotient->den.begin(), quotient->den.end());
    return elements::RationalFunction{std::move(quotient->num), std::move(quotient->den)};
  }

 private:
  std::nullopt_t fail(std::string id, const Expression& expression, std::string_view what) {
    reporter_.error(std::move(id), expression.span, fmt::format("{}: {}", owner_, what));
    return std::nullopt;
  }

  std::nullopt_t improper(const Expression& expression, const Quotient& quotient) {
    return fail(
        "E-not-supported", expression,
        fmt::format("the numerator is of degree {} in s, the denominator of degree {}: such a fraction differentiates its input; try a "
                    "pole far above all frequencies of interest, as in (…)/(1+s/1e9), or ddt() in an expression",
                    quotient.num.size() - 1, quotient.den.size() - 1));
  }

  /// Common factors s, which numerators and denominators of sums collect.
  static void cancel_s(Quotient& quotient) {
    while (quotient.num.size() > 1 && quotient.den.size() > 1 && quotient.num[0].is_nothing() && quotient.den[0].is_nothing()) {
      quotient.num.erase(quotient.num.begin());
      quotient.den.erase(quotient.den.begin());
    }
  }

  static void without_leading_zeros(Polynomial& polynomial) {
    // A parameter that would raise the degree is not followed.
    while (polynomial.size() > 1 && polynomial.back().value == 0.0) {
      polynomial[0] = unfollowed(polynomial[0], polynomial.back());
      polynomial.pop_back();
    }
  }

  std::optional<Quotient> value(const Expression& expression, const Place& place) {
    if (is_plain(expression, place)) {
      const std::optional<Varied> number = varied_number(expression, place.scope, place.depth);
      return number ? std::optional(number_of(*number)) : std::nullopt;
    }
    switch (expression.kind) {
      case ExpressionKind::name:
        return of_name(expression, place);
      case ExpressionKind::unary:
        return of_unary(expression, place);
      case ExpressionKind::binary:
        return of_binary(expression, place);
      case ExpressionKind::call:
        return of_call(expression, place);
      default:
        return fail("E-not-supported", expression, "a choice that depends on s is not a fraction of polynomials");
    }
  }

  /// Whether neither s nor an argument enters, nor a function whose body may hold s: a number like any other.
  static bool is_plain(const Expression& expression, const Place& place) {
    if (expression.kind == ExpressionKind::name) {
      const bool is_argument = place.arguments != nullptr && place.arguments->contains(without_case(expression.text));
      return !is_argument && !same_name(expression.text, "s");
    }
    Scope* home = nullptr;
    if (expression.kind == ExpressionKind::call && find_function(place.scope, without_case(expression.text), home) != nullptr) return false;
    return std::all_of(expression.arguments.begin(), expression.arguments.end(), [&](const Expression& a) { return is_plain(a, place); });
  }

  static std::optional<Quotient> of_name(const Expression& expression, const Place& place) {
    if (place.arguments != nullptr) {
      const auto argument = place.arguments->find(without_case(expression.text));
      if (argument != place.arguments->end()) return argument->second;
    }
    return Quotient{{0.0, 1.0}, {1.0}};
  }

  std::optional<Quotient> of_unary(const Expression& expression, const Place& place) {
    std::optional<Quotient> inner = value(expression.arguments[0], place);
    if (!inner || expression.text == "+") return inner;
    if (expression.text == "-") return sum_of(number_of(0.0), *inner, -1.0);
    return fail("E-not-supported", expression, fmt::format("'{}' has no meaning for s", expression.text));
  }

  std::optional<Quotient> of_binary(const Expression& expression, const Place& place) {
    const std::optional<Quotient> a = value(expression.arguments[0], place), b = value(expression.arguments[1], place);
    if (!a || !b) return std::nullopt;
    const std::string_view op = expression.text;
    if (op == "+" || op == "-") return sum_of(*a, *b, op == "+" ? 1.0 : -1.0);
    if (op == "*") return Quotient{a->num * b->num, a->den * b->den};
    if (op == "^" || op == "**") return power(expression, *a, *b);
    if (op != "/") return fail("E-not-supported", expression, fmt::format("'{}' has no meaning for s", op));
    if (is_zero(b->num)) return fail("E-not-finite", expression, "division by zero");
    return Quotient{a->num * b->den, a->den * b->num};
  }

  std::optional<Quotient> power(const Expression& expression, const Quotient& base, const Quotient& exponent) {
    const double times = exponent.is_number() ? exponent.number().value : 0.5;
    if (times != std::floor(times))
      return fail("E-not-supported", expression, "only whole powers of s are fractions of polynomials; try an approximation by one");
    if (std::abs(times) * static_cast<double>(std::max(base.num.size(), base.den.size()) - 1) > largest_degree)
      return fail("E-not-supported", expression, fmt::format("a fraction of a degree above {} is not supported", largest_degree));
    Quotient result = number_of(1.0);
    if (exponent.is_number()) result.num[0] = unfollowed(1.0, exponent.number());
    for (double k = 0.0; k < std::abs(times); k += 1.0) result = {result.num * base.num, result.den * base.den};
    if (times < 0.0) std::swap(result.num, result.den);
    if (is_zero(result.den)) return fail("E-not-finite", expression, "division by zero");
    return result;
  }

  std::optional<Quotient> of_call(const Expression& expression, const Place& place) {
    std::vector<Quotient> values;
    for (const Expression& argument : expression.arguments) {
      std::optional<Quotient> one = value(argument, place);
      if (!one) return std::nullopt;
      values.push_back(std::move(*one));
    }
    Scope* home = nullptr;
    if (const FunctionText* function = find_function(place.scope, without_case(expression.text), home))
      return of_function(expression, *function, *home, place, values);
    if (values.size() == 2 && same_name(expression.text, "pow")) return power(expression, values[0], values[1]);
    if (std::all_of(values.begin(), values.end(), [](const Quotient& q) { return q.is_number(); })) return of_numbers(expression, values);
    const bool is_delay = same_name(expression.text, "exp");
    return fail(
        "E-not-supported", expression,
        fmt::format("{} of s is not a fraction of polynomials, and has no circuit of finitely many states; try {}", expression.text,
                    is_delay ? "an approximation of the delay: (1-s*T/2)/(1+s*T/2), or powers of it with T/n" : "an approximation by one"));
  }

  std::optional<Quotient> of_numbers(const Expression& expression, const std::vector<Quotient>& values) {
    const BuiltinFunction* builtin = find_builtin(expression.text);
    if (builtin == nullptr) return fail("E-unknown-function", expression, fmt::format("unknown function '{}'", expression.text));
    if (values.size() < builtin->least || values.size() > builtin->most)
      return fail("E-argument-count", expression, fmt::format("{} does not take {} arguments", expression.text, values.size()));
    std::vector<double> numbers;
    std::vector<Varied> arguments;
    for (const Quotient& each : values) {
      arguments.push_back(each.number());
      numbers.push_back(arguments.back().value);
    }
    const double result = builtin->value(numbers);
    if (!std::isfinite(result)) return fail("E-not-finite", expression, "the result is not a finite number");
    return number_of(varied_result(*builtin, arguments, result));
  }

  std::optional<Quotient> of_function(const Expression& expression, const FunctionText& function, Scope& home, const Place& place,
                                      const std::vector<Quotient>& values) {
    if (values.size() != function.formals.size())
      return fail("E-argument-count", expression,
                  fmt::format("{} takes {} arguments, not {}", function.name, function.formals.size(), values.size()));
    if (place.depth > Session::deepest) return fail("E-too-deep", expression, "functions call one another too deeply");
    Names arguments;
    for (std::size_t k = 0; k < values.size(); ++k) arguments.emplace(function.formals[k], values[k]);
    const Place inside{home, &arguments, place.depth + 1};
    if (function.body->kind == netlist::Item::Kind::expression) return value(*function.body->expression, inside);
    const std::optional<Varied> number = varied_number(*function.body, home, inside.depth);
    return number ? std::optional(number_of(*number)) : std::nullopt;
  }

  Reporter& reporter_;
  std::string_view owner_;
};

}  // namespace

std::optional<elements::RationalFunction> read_transfer_function(const Expression& expression, Scope& scope, Reporter& reporter,
                                                                 std::string_view owner) {
  return TransferReader(reporter, owner).read(expression, scope);
}

}  // namespace pwlsim::circuit
