#pragma once
/// Values and derivatives of numbers and expressions on cards, for scopes.

#include "circuit/scope.hpp"

namespace pwlsim::circuit {

class ExpressionEvaluation : public Evaluation {
 public:
  [[nodiscard]] std::optional<double> value(Scope& scope, const netlist::Item& item, int depth) const override;
  [[nodiscard]] std::vector<double> gradient(Scope& scope, const netlist::Item& item) const override;
  [[nodiscard]] std::string fix(std::string_view text, Scope& scope) const override;
};

}  // namespace pwlsim::circuit
