#pragma once
/// Derivatives of a deck's expressions to parameters, by the rules of calculus, exact: through `.param`, `.func` and calls of subcircuits.

#include <string_view>
#include <vector>

#include "circuit/evaluator.hpp"

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

/// sum += factor·gradient
void accumulate(Gradient& sum, const Gradient& gradient, double factor);

}  // namespace pwlsim::circuit
