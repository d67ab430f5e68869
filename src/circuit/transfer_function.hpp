#pragma once
/// Expressions in s -> fractions of polynomials: numbers, parameters, functions of .func, s, + - * / and whole powers.

#include <optional>
#include <string_view>

#include "circuit/scope.hpp"
#include "elements/formula.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// Reports anything that is not a proper fraction; `owner` is the element.
[[nodiscard]] std::optional<elements::RationalFunction> read_transfer_function(const netlist::Expression& expression, Scope& scope,
                                                                               Reporter& reporter, std::string_view owner);

}  // namespace pwlsim::circuit
