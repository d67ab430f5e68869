#include "circuit/formula_moves.hpp"

#include <algorithm>

#include "base/names.hpp"
#include "circuit/evaluator.hpp"
#include "circuit/expression_derivative.hpp"

namespace pwlsim::circuit {
namespace {

using elements::AffineSum;
using netlist::Expression;
using Kind = Expression::Kind;

/// A sum, and its derivative to each parameter.
struct Moving {
  AffineSum value;
  std::vector<AffineSum> moved;

  [[nodiscard]] bool is_number() const { return value.is_constant(); }
};

bool is_signal(const Expression& expression) {
  return expression.kind == Kind::call && (same_name(expression.text, "v") || same_name(expression.text, "i"));
}

bool reads_no_signal(const Expression& expression) {
  const bool is_time = expression.kind == Kind::name && same_name(expression.text, "time");
  return !is_time && !is_signal(expression) && std::all_of(expression.arguments.begin(), expression.arguments.end(), reads_no_signal);
}

class Reader {
 public:
  Reader(Scope& scope, const SignalOf& signal) : scope_(scope), signal_(signal), count_(scope.session().varied.size()) {}

  std::optional<Moving> of(const Expression& expression) const {
    if (reads_no_signal(expression)) return of_number(expression);
    if (is_signal(expression)) {
      const std::optional<AffineSum> value = signal_(expression);
      return value ? std::optional(Moving{*value, std::vector<AffineSum>(count_)}) : std::nullopt;
    }
    if (expression.kind == Kind::unary && expression.text != "!") {
      const std::optional<Moving> value = of(expression.arguments[0]);
      return value ? std::optional(times(number(expression.text == "-" ? -1.0 : 1.0), *value)) : std::nullopt;
    }
    return expression.kind == Kind::binary ? of_binary(expression) : std::nullopt;
  }

 private:
  [[nodiscard]] Moving number(double value) const { return {elements::constant_sum(value), std::vector<AffineSum>(count_)}; }

  [[nodiscard]] std::optional<Moving> of_number(const Expression& expression) const {
    const std::optional<double> value = Evaluator(scope_, 0).value(expression);
    if (!value) return std::nullopt;
    Moving result = number(*value);
    const Gradient gradient = Differentiator(scope_).of(expression);
    for (std::size_t k = 0; k < gradient.size(); ++k) result.moved[k].constant = gradient[k];
    return result;
  }

  [[nodiscard]] std::optional<Moving> of_binary(const Expression& expression) const {
    const std::optional<Moving> left = of(expression.arguments[0]), right = of(expression.arguments[1]);
    if (!left || !right) return std::nullopt;
    const std::string& op = expression.text;
    if (op == "+") return plus(*left, 1.0, *right);
    if (op == "-") return plus(*left, -1.0, *right);
    if (op == "*" && left->is_number()) return times(*left, *right);
    if (op == "*" && right->is_number()) return times(*right, *left);
    if (op == "/" && right->is_number() && right->value.constant != 0.0) return times(inverse(*right), *left);
    return std::nullopt;
  }

  [[nodiscard]] Moving plus(const Moving& a, double factor, const Moving& b) const {
    Moving sum{a.value + factor * b.value, {}};
    for (std::size_t k = 0; k < count_; ++k) sum.moved.push_back(a.moved[k] + factor * b.moved[k]);
    return sum;
  }

  [[nodiscard]] Moving times(const Moving& factor, const Moving& b) const {
    const double c = factor.value.constant;
    Moving product{c * b.value, {}};
    for (std::size_t k = 0; k < count_; ++k) product.moved.push_back(c * b.moved[k] + factor.moved[k].constant * b.value);
    return product;
  }

  [[nodiscard]] Moving inverse(const Moving& a) const {
    const double c = 1.0 / a.value.constant;
    Moving result = number(c);
    for (std::size_t k = 0; k < count_; ++k) result.moved[k].constant = -c * c * a.moved[k].constant;
    return result;
  }

  Scope& scope_;
  const SignalOf& signal_;
  std::size_t count_;
};

}  // namespace

std::vector<AffineSum> formula_moves(const Expression& expression, Scope& scope, const SignalOf& signal) {
  std::optional<Moving> result = Reader(scope, signal).of(expression);
  return result ? std::move(result->moved) : std::vector<AffineSum>();
}

}  // namespace pwlsim::circuit
