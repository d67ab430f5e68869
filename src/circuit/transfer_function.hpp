#pragma once
/// Fractions of polynomials in s, as LAPLACE has them.

#include <optional>
#include <string_view>
#include <vector>

#include "circuit/scope.hpp"

namespace pwlsim::circuit {

/// Coefficients, lowest power of s first.
struct TransferFunction {
  std::vector<double> numerator{0.0}, denominator{1.0};
};

/// Of an expression of s, numbers and parameters with + - * / and whole powers. What is no such fraction, or has a numerator of higher degree than its
/// denominator, is an error of `owner`; none then.
[[nodiscard]] std::optional<TransferFunction> read_transfer_function(const netlist::Expression& expression, Scope& scope,
                                                                     Reporter& reporter, std::string_view owner);

}  // namespace pwlsim::circuit
