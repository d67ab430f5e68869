#pragma once
/// The functions of expressions, as data.

#include <cstddef>
#include <span>
#include <string_view>

namespace pwlsim::circuit {

struct BuiltinFunction {
  std::string_view name;
  std::size_t least = 1, most = 1;  ///< number of arguments
  double (*value)(std::span<const double> arguments) = nullptr;
  bool passes_infinity = false;  ///< may return an argument that is a written `inf`
};

/// `if` and `ternary_fcn` are not here: they leave one of their arguments unevaluated.
[[nodiscard]] std::span<const BuiltinFunction> builtin_functions();
[[nodiscard]] const BuiltinFunction* find_builtin(std::string_view name);

using BinaryOperator = double (*)(double, double);
/// As decks spell it; nan is the value of one that is unknown.
[[nodiscard]] BinaryOperator find_binary(std::string_view op);

}  // namespace pwlsim::circuit
