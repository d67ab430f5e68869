#pragma once
/// Expressions of B, E, F, G and H cards -> formulas. Constants are folded; V(…) and I(…) become controls of the instance; what has no
/// piecewise-linear form is an error at the smallest part that lacks one.

#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "circuit/binding.hpp"
#include "circuit/functions.hpp"
#include "elements/formula.hpp"

namespace pwlsim::circuit {

class FormulaReader {
 public:
  FormulaReader(Binding& binding, Place& place, elements::Instance& instance) : binding_(binding), place_(place), instance_(instance) {}

  /// Gives the instance its formula; false after an error.
  bool read(const netlist::Expression& expression, bool is_current);
  /// The same for a fraction in s of an expression, or of the first control of the instance.
  bool read_transfer(const netlist::Expression* input, const netlist::Expression& transfer, bool is_current);
  /// The same for a table of points, x an expression or the first control.
  bool read_table(const netlist::Expression* x, const std::vector<elements::TablePoint>& points, bool is_current);

 private:
  using Expression = netlist::Expression;
  using Sum = elements::AffineSum;

  /// A value, and a truth value if it comes from a comparison.
  struct Meaning {
    Sum value;
    std::optional<elements::Condition> condition;
  };
  static Meaning piecewise(Sum value) { return {std::move(value), std::nullopt}; }
  using Names = std::unordered_map<std::string, Meaning>;
  /// The context for names: a scope, and the arguments of the .func function whose body is read.
  struct Context {
    Scope& scope;
    const Names* arguments = nullptr;
    int depth = 0;
  };

  std::optional<Meaning> meaning(const Expression& expression, const Context& context);
  std::optional<Meaning> of_kind(const Expression& expression, const Context& context);
  std::optional<Sum> sum(const Expression& expression, const Context& context);
  std::optional<elements::Condition> condition(const Expression& expression, const Context& context);
  std::optional<elements::Condition> condition_of(const Meaning& meaning, const Expression& expression);
  std::optional<elements::Varied> constant(const Expression& expression, const Context& context, std::string_view what);

  std::optional<Meaning> of_name(const Expression& expression, const Context& context);
  std::optional<Meaning> of_unary(const Expression& expression, const Context& context);
  std::optional<Meaning> of_binary(const Expression& expression, const Context& context);
  std::optional<Meaning> of_operation(const Expression& operation, const Expression& left_part, const Meaning& left, const Meaning& right);
  std::optional<Meaning> of_logic(const Expression& operation, const Expression& left_part, const Meaning& left, const Meaning& right);
  std::optional<Meaning> of_numbers(const Expression& operation, const elements::Varied& left, const elements::Varied& right);
  std::optional<Meaning> of_product(const Expression& operation, const Meaning& left, const Meaning& right);
  std::optional<Meaning> of_quotient(const Expression& operation, const Sum& a, const Sum& b);
  std::optional<Meaning> of_power(const Expression& operation, const Sum& base, const Sum& exponent);
  std::optional<Meaning> of_comparison(const Expression& operation, const Sum& left, const Sum& right);
  std::optional<Meaning> of_choice(const Expression& yes, const Expression& no, const Expression& asked, const Context& context);
  std::optional<Meaning> of_call(const Expression& expression, const Context& context);
  std::optional<Meaning> of_signal(const Expression& expression);
  std::optional<Meaning> of_function(const Expression& expression, const FunctionText& function, Scope& home, const Context& context);
  std::optional<Meaning> of_table(const Expression& expression, const Context& context, bool extrapolated);
  std::optional<Meaning> of_integral(const Expression& expression, const Context& context);
  std::optional<Meaning> of_wrapped_integral(const Expression& expression, const Context& context);
  std::optional<Meaning> of_derivative(const Expression& expression, const Context& context);
  std::optional<Meaning> of_builtin(const Expression& expression, const Context& context);
  Meaning of_saturation(const Expression& expression, const Sum& x);
  Meaning of_smooth(const Expression& expression, const BuiltinFunction& function, const Sum& a, const Sum& b);
  std::optional<Meaning> of_values(const Expression& expression, const std::vector<Sum>& values);
  std::optional<Meaning> of_constants(const Expression& expression, const BuiltinFunction& builtin, const std::vector<Sum>& values);
  std::optional<Meaning> of_corners(std::string_view key, const std::vector<Sum>& values);
  void report_unknown(const Expression& expression, const std::string& key);

  Sum product(const Expression& operation, const Sum& a, const Sum& b);
  std::optional<Sum> rounded(std::string_view key, const std::vector<Sum>& values);

  void lose(const Sum& sum);
  Sum control();
  bool count_is(const Expression& expression, std::size_t least, std::size_t most);
  [[nodiscard]] bool keep(const Sum& value, bool is_current, SourceSpan span);
  std::nullopt_t refuse(const Expression& expression, std::string_view what);
  std::nullopt_t too_deep(const Expression& expression);
  [[nodiscard]] Reporter& reporter() { return binding_.reporter(); }

  Binding& binding_;
  Place& place_;
  elements::Instance& instance_;
  elements::FormulaBuilder builder_;
  std::vector<std::pair<int, SourceSpan>> open_products_;
  int nesting_ = 0;
};

/// Reports points whose x decreases; false then. `spans` may have one span per point.
bool check_table(const std::vector<elements::TablePoint>& points, SourceSpan span, Reporter& reporter);

}  // namespace pwlsim::circuit
