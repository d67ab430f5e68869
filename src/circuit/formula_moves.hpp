#pragma once
/// How formulas that are sums of signals move with the parameters of `.sens`.

#include <functional>
#include <optional>
#include <vector>

#include "circuit/scope.hpp"
#include "elements/formula.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The voltage or current that a call names, as a sum of parts of the formula.
using SignalOf = std::function<std::optional<elements::AffineSum>(const netlist::Expression& call)>;

/// The derivative of its constant and of its coefficients to each varied parameter (Session::varied). Empty where it is no sum of signals whose factors are numbers.
[[nodiscard]] std::vector<elements::AffineSum> formula_moves(const netlist::Expression& expression, Scope& scope, const SignalOf& signal);

}  // namespace pwlsim::circuit
