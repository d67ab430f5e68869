#pragma once
/// Values of expressions.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "circuit/functions.hpp"
#include "circuit/scope.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// Arguments of the .func function whose body is being evaluated.
struct Arguments {
  const FunctionText* function = nullptr;
  std::vector<double> values;
};

/// Evaluates in one scope. Infinite values come only from a written `inf`; anything else that is not finite is an error at the
/// smallest part of the expression that produces it.
class Evaluator {
 public:
  Evaluator(Scope& scope, int depth, const Arguments* arguments = nullptr) : scope_(scope), depth_(depth), arguments_(arguments) {}

  [[nodiscard]] std::optional<double> value(const netlist::Expression& expression);
  /// The value of an item that is a number or an expression.
  [[nodiscard]] std::optional<double> value(const netlist::Item& item);

  static constexpr int deepest_nesting = 3000;  ///< nesting of expressions

 private:
  using Expression = netlist::Expression;

  struct Callee {
    const FunctionText* function = nullptr;
    Scope* home = nullptr;  ///< where the function is defined
    bool is_choice = false;
    const BuiltinFunction* builtin = nullptr;
  };

  [[nodiscard]] Callee callee_of(std::string_view name);
  /// The part that the conditions choose; none if a condition has no value.
  const Expression* without_conditions(const Expression& expression);
  std::optional<double> of_kind(const Expression& expression);
  std::optional<double> of_number(const Expression& expression);
  std::optional<double> of_name(const Expression& expression);
  void note_read(std::string_view name);
  [[nodiscard]] const double* argument_named(std::string_view name) const;
  std::optional<double> of_constant(const Expression& expression);
  std::optional<double> of_unary(const Expression& expression);
  std::optional<double> of_binary(const Expression& expression);
  std::optional<double> of_operation(const Expression& operation, double left, double right);
  std::optional<double> of_call(const Expression& expression);
  std::optional<double> of_random(const Expression& expression);
  std::optional<double> of_builtin(const Expression& expression, const BuiltinFunction& builtin, const std::vector<double>& values);
  std::optional<double> of_choice(const Expression& condition, const Expression& yes, const Expression& no);
  std::optional<double> of_function(const Expression& expression, const FunctionText& function, Scope& home);
  /// Appends the values of the arguments. False if one has none.
  bool arguments_of(const Expression& expression, std::vector<double>& values);
  std::optional<double> finite(double value, const Expression& expression, std::string_view why = {});
  bool count_is_right(const Expression& expression, std::size_t least, std::size_t most);
  std::optional<double> too_nested(const Expression& expression);
  std::optional<double> too_many_calls(const FunctionText& function);
  std::optional<double> unknown_name(const Expression& expression);
  std::optional<double> unknown_function(const Expression& expression);
  [[nodiscard]] Reporter& reporter() { return scope_.session_.reporter; }

  Scope& scope_;
  int depth_;
  const Arguments* arguments_;
};

}  // namespace pwlsim::circuit
