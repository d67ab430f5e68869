#pragma once
/// Derivatives of the functions and operators of expressions, in closed form.

#include <span>
#include <string_view>

#include "circuit/functions.hpp"

namespace pwlsim::circuit {

/// partials[i] = ∂f/∂(argument i). For steps, and if two arguments tie, that of one side; `has_kink` then becomes true.
void function_partials(const BuiltinFunction& function, std::span<const double> arguments, std::span<double> partials, bool& has_kink);

/// Of `left op right`: both.
struct Partials {
  double left = 0.0, right = 0.0;
};
[[nodiscard]] Partials operation_partials(std::string_view op, double left, double right);

}  // namespace pwlsim::circuit
