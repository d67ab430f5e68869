#include "circuit/evaluation.hpp"

#include "circuit/evaluator.hpp"
#include "circuit/expression_derivative.hpp"
#include "circuit/number_cure.hpp"

namespace pwlsim::circuit {

std::optional<double> ExpressionEvaluation::value(Scope& scope, const netlist::Item& item, int depth) const {
  return Evaluator(scope, depth).value(item);
}

std::vector<double> ExpressionEvaluation::gradient(Scope& scope, const netlist::Item& item) const { return Differentiator(scope).of(item); }

std::string ExpressionEvaluation::fix(std::string_view text, Scope& scope) const { return number_cure(text, scope); }

}  // namespace pwlsim::circuit
