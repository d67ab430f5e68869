#pragma once
/// The functions of expressions, as data.

#include <cstddef>
#include <span>
#include <string_view>

namespace pwlsim::circuit {

/// Where a function has corners or jumps.
enum class Corners {
  none,
  at_zero,        ///< of its first argument
  at_half,        ///< where its first argument is 0.5
  at_integers,    ///< of its first argument
  at_halves,      ///< where its first argument is an integer and a half
  of_quotient,    ///< where its first argument is a multiple of the second
  of_differences  ///< where two arguments are equal
};

struct BuiltinFunction {
  std::string_view name;
  std::size_t least = 1, most = 1;  ///< number of arguments
  double (*value)(std::span<const double> arguments) = nullptr;
  bool passes_infinity = false;  ///< may return an argument that was written as `inf`
  Corners corners = Corners::none;
};

/// `if` and `ternary_fcn` are not here: they do not evaluate one of their arguments.
[[nodiscard]] std::span<const BuiltinFunction> builtin_functions();
[[nodiscard]] const BuiltinFunction* find_builtin(std::string_view name);

/// −1, 0 or 1.
[[nodiscard]] constexpr double sign(double x) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0); }

using BinaryOperator = double (*)(double, double);
/// Whether it is one of < > <= >= == !=, which jump where both sides are equal.
[[nodiscard]] bool compares(std::string_view op);
/// By the deck's spelling; nan if unknown.
[[nodiscard]] BinaryOperator find_binary(std::string_view op);

}  // namespace pwlsim::circuit
