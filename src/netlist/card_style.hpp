#pragma once
/// The syntax that the first word of a card implies: all that the grammar knows about keywords.

#include <string_view>

namespace pwlsim::netlist {

class CardStyle {
 public:
  explicit CardStyle(std::string_view name);

  /// The card defines a function, whose body needs no braces.
  [[nodiscard]] bool is_function() const { return function_; }
  /// The card is a rule of LTspice's state machines: two states, and a condition without braces.
  [[nodiscard]] bool is_rule() const { return rule_; }
  /// The card is an output of such a machine: a node in parentheses, and an expression without braces.
  [[nodiscard]] bool is_machine_output() const { return machine_output_; }
  /// The card holds one expression: .if, .elseif.
  [[nodiscard]] bool is_condition() const { return condition_; }
  /// The card defines parameters; the equals signs may be left out.
  [[nodiscard]] bool is_parameters() const { return dot_ && parameters_ && !takes_params_; }
  /// Braces around parameters count as parentheses.
  [[nodiscard]] bool is_model() const { return model_; }
  /// The card measures: keywords and expressions without braces in a row.
  [[nodiscard]] bool is_measurement() const { return measurement_; }
  /// `params:` is a separate word, even without a blank after it.
  [[nodiscard]] bool takes_params() const { return takes_params_; }
  /// The value assigned to `left` may be an expression without braces.
  [[nodiscard]] bool open_expression(std::string_view left) const;
  /// A blank may separate `word` from the parenthesis that makes it a group.
  [[nodiscard]] bool joins_parenthesis(std::string_view word) const;

 private:
  bool dot_ = false;
  bool function_ = false;
  bool rule_ = false;
  bool machine_output_ = false;
  bool condition_ = false;
  bool model_ = false;
  bool measurement_ = false;
  bool takes_params_ = false;
  bool parameters_ = false;
  bool source_values_ = false;
  bool is_resistor_ = false;
};

/// A keyword on a card that measures, in a place where an expression is possible, too: AVG, FROM, WHEN, …
[[nodiscard]] bool is_measurement_keyword(std::string_view word);
/// The analysis that such a card may name first: tran, ac, …
[[nodiscard]] bool is_analysis_name(std::string_view word);

}  // namespace pwlsim::netlist
