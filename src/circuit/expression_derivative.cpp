#include "circuit/expression_derivative.hpp"

#include <algorithm>
#include <limits>

#include "base/names.hpp"
#include "circuit/function_derivatives.hpp"
#include "circuit/random.hpp"

namespace pwlsim::circuit {
namespace {

using Kind = netlist::Expression::Kind;

bool is_random(const netlist::Expression& expression) {
  return (expression.kind == Kind::call && is_random_function(expression.text)) ||
         std::any_of(expression.arguments.begin(), expression.arguments.end(), is_random);
}

Gradient unknown(std::size_t count) { return Gradient(count, std::numeric_limits<double>::quiet_NaN()); }

}  // namespace

void accumulate(Gradient& sum, const Gradient& gradient, double factor) {
  if (gradient.empty() || factor == 0.0) return;
  sum.resize(std::max(sum.size(), gradient.size()), 0.0);
  for (std::size_t k = 0; k < gradient.size(); ++k) sum[k] += factor * gradient[k];
}

double Differentiator::value(const Expression& expression) {
  return Evaluator(scope_, 0, arguments_).value(expression).value_or(std::numeric_limits<double>::quiet_NaN());
}

Gradient Differentiator::of(const netlist::Item& item) {
  return item.kind == netlist::Item::Kind::expression ? of(*item.expression) : Gradient();
}

Gradient Differentiator::of(const Expression& expression) {
  switch (expression.kind) {
    case Kind::number:
      return {};
    case Kind::name:
      return of_name(expression);
    case Kind::unary: {
      Gradient result;
      if (expression.text != "!") accumulate(result, of(expression.arguments[0]), expression.text == "-" ? -1.0 : 1.0);
      return result;
    }
    case Kind::binary:
      return of_binary(expression);
    case Kind::call:
      return of_call(expression);
    case Kind::conditional:
      return of_choice(expression.arguments[0], expression.arguments[1], expression.arguments[2]);
  }
  return {};
}

Gradient Differentiator::of_name(const Expression& expression) {
  if (arguments_ != nullptr) {
    const auto& formals = arguments_->function->formals;
    const auto found =
        std::find_if(formals.begin(), formals.end(), [&](const std::string& formal) { return same_name(formal, expression.text); });
    if (found != formals.end()) return (*gradients_)[static_cast<std::size_t>(found - formals.begin())];
  }
  return scope_.gradient_of(expression.text);
}

Gradient Differentiator::of_binary(const Expression& expression) {
  const Gradient left = of(expression.arguments[0]), right = of(expression.arguments[1]);
  if (left.empty() && right.empty()) return {};
  if (is_random(expression)) return unknown(std::max(left.size(), right.size()));
  const Partials partials = operation_partials(expression.text, value(expression.arguments[0]), value(expression.arguments[1]));
  Gradient result;
  if (!left.empty()) accumulate(result, left, partials.left);
  if (!right.empty()) accumulate(result, right, partials.right);
  return result;
}

Gradient Differentiator::of_choice(const Expression& condition, const Expression& yes, const Expression& no) {
  return of(value(condition) != 0.0 ? yes : no);
}

Gradient Differentiator::of_call(const Expression& expression) {
  Scope* home = nullptr;
  if (const FunctionText* function = find_function(scope_, without_case(expression.text), home))
    return of_function(expression, *function, *home);
  if (expression.arguments.size() == 3 && (same_name(expression.text, "if") || same_name(expression.text, "ternary_fcn")))
    return of_choice(expression.arguments[0], expression.arguments[1], expression.arguments[2]);
  std::vector<Gradient> gradients;
  std::size_t size = 0;
  for (const Expression& argument : expression.arguments) {
    gradients.push_back(of(argument));
    size = std::max(size, gradients.back().size());
  }
  if (size == 0) return {};
  const BuiltinFunction* function = find_builtin(expression.text);
  if (function == nullptr || is_random(expression)) return unknown(size);
  std::vector<double> values, partials(gradients.size());
  for (const Expression& argument : expression.arguments) values.push_back(value(argument));
  bool has_kink = false;
  function_partials(*function, values, partials, has_kink);
  if (has_kink) return unknown(size);
  Gradient result;
  for (std::size_t k = 0; k < gradients.size(); ++k) accumulate(result, gradients[k], partials[k]);
  return result;
}

Gradient Differentiator::of_function(const Expression& expression, const FunctionText& function, Scope& home) {
  Arguments arguments{&function, {}};
  std::vector<Gradient> gradients;
  for (const Expression& argument : expression.arguments) {
    arguments.values.push_back(value(argument));
    gradients.push_back(of(argument));
  }
  if (arguments.values.size() != function.formals.size() || function.body == nullptr) return {};
  return Differentiator(home, &arguments, &gradients).of(*function.body);
}

elements::Varied varied_result(const BuiltinFunction& function, const std::vector<elements::Varied>& arguments, double value) {
  elements::Varied result = value;
  if (std::none_of(arguments.begin(), arguments.end(), [](const elements::Varied& a) { return a.moves(); })) return result;
  std::vector<double> numbers, partials(arguments.size());
  for (const elements::Varied& argument : arguments) numbers.push_back(argument.value);
  bool has_kink = is_random_function(function.name);
  function_partials(function, numbers, partials, has_kink);
  for (std::size_t k = 0; k < numbers.size(); ++k)
    result = has_kink ? unfollowed(result, arguments[k]) : applied(result, arguments[k], value, 1.0, partials[k]);
  return result;
}

}  // namespace pwlsim::circuit
