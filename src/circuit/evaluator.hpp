#pragma once
/// Values of expressions.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
  /// Of an item that holds a number or an expression.
  [[nodiscard]] std::optional<double> value(const netlist::Item& item);

  static constexpr int deepest = 1000;          ///< parameters and functions within one another
  static constexpr int deepest_nesting = 4000;  ///< parts of expressions within one another

 private:
  using Expression = netlist::Expression;

  std::optional<double> of_kind(const Expression& expression);
  std::optional<double> of_number(const Expression& expression);
  std::optional<double> of_name(const Expression& expression);
  std::optional<double> of_unary(const Expression& expression);
  std::optional<double> of_binary(const Expression& expression);
  std::optional<double> of_call(const Expression& expression);
  std::optional<double> of_choice(const Expression& condition, const Expression& yes, const Expression& no);
  std::optional<double> of_function(const Expression& expression, const FunctionText& function, Scope& home);
  std::optional<std::vector<double>> arguments_of(const Expression& expression);
  std::optional<double> finite(double value, const Expression& expression, std::string_view why = {});
  bool count_is_right(const Expression& expression, std::size_t least, std::size_t most);
  std::optional<double> unknown_name(const Expression& expression);
  std::optional<double> unknown_function(const Expression& expression);
  [[nodiscard]] Reporter& reporter() { return scope_.session_.reporter; }

  Scope& scope_;
  int depth_;
  const Arguments* arguments_;
};

}  // namespace pwlsim::circuit
