#pragma once
/// Derivatives of a deck's expressions to parameters, by the rules of calculus, exact: through `.param`, `.func` and calls of subcircuits.

#include <string_view>
#include <vector>

#include "circuit/evaluator.hpp"
#include "elements/varied.hpp"

namespace pwlsim::circuit {

/// Derivatives to each varied parameter (Session::varied), in order; empty if all are zero.
using Gradient = std::vector<double>;

class Differentiator {
 public:
  explicit Differentiator(Scope& scope, const Arguments* arguments = nullptr, const std::vector<Gradient>* gradients = nullptr)
      : scope_(scope), arguments_(arguments), gradients_(gradients) {}

  /// The derivatives of an expression with a value. Not finite if it draws random numbers.
  [[nodiscard]] Gradient of(const netlist::Expression& expression);
  [[nodiscard]] Gradient of(const netlist::Item& item);

 private:
  using Expression = netlist::Expression;
  [[nodiscard]] Gradient of_name(const Expression& expression);
  [[nodiscard]] Gradient of_binary(const Expression& expression);
  [[nodiscard]] Gradient of_call(const Expression& expression);
  [[nodiscard]] Gradient of_function(const Expression& expression, const FunctionText& function, Scope& home);
  [[nodiscard]] Gradient of_choice(const Expression& condition, const Expression& yes, const Expression& no);
  [[nodiscard]] double value(const Expression& expression);

  Scope& scope_;
  const Arguments* arguments_;
  const std::vector<Gradient>* gradients_;
};

/// A number in a formula, an expression or an item, with its derivatives, which the reader follows. Empty after an error.
template <class Text>
[[nodiscard]] std::optional<elements::Varied> varied_number(const Text& text, Scope& scope, int depth) {
  Session& session = scope.session();
  ++session.numbers;  // no number that nobody follows
  std::optional<elements::Varied> number;
  if (const std::optional<double> value = Evaluator(scope, depth).value(text)) number.emplace(*value);
  if (number && !session.varied.empty()) number->gradient = Differentiator(scope).of(text);
  --session.numbers;
  return number;
}

/// f(numbers) = value, with its derivatives; random numbers have none.
[[nodiscard]] elements::Varied varied_result(const BuiltinFunction& function, const std::vector<elements::Varied>& arguments, double value);

/// sum += factor·gradient
void accumulate(Gradient& sum, const Gradient& gradient, double factor);

}  // namespace pwlsim::circuit
