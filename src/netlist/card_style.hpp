#pragma once
/// What the first word of a card tells about its syntax: all that the grammar knows of keywords.

#include <string_view>

namespace pwlsim::netlist {

class CardStyle {
 public:
  explicit CardStyle(std::string_view name);

  /// The card defines a function, whose body needs no braces.
  [[nodiscard]] bool is_function() const { return function_; }
  /// The card belongs to a state machine of LTspice, which is not read.
  [[nodiscard]] bool is_unread() const { return unread_; }
  /// The card holds one expression: .if, .elseif.
  [[nodiscard]] bool is_condition() const { return condition_; }
  /// The card defines parameters; the equals signs may be left out.
  [[nodiscard]] bool is_parameters() const { return dot_ && parameters_ && !takes_params_; }
  /// Braces around parameters are taken for parentheses.
  [[nodiscard]] bool is_model() const { return model_; }
  /// The card measures: keywords and expressions without braces stand in a row.
  [[nodiscard]] bool is_measurement() const { return measurement_; }
  /// `params:` is a word of its own, even without a blank behind it.
  [[nodiscard]] bool takes_params() const { return takes_params_; }
  /// What is assigned to `left` may be an expression without braces.
  [[nodiscard]] bool open_expression(std::string_view left) const;
  /// A blank may part `word` from the parenthesis that makes a group of it.
  [[nodiscard]] bool joins_parenthesis(std::string_view word) const;

 private:
  bool dot_ = false;
  bool function_ = false;
  bool unread_ = false;
  bool condition_ = false;
  bool model_ = false;
  bool measurement_ = false;
  bool takes_params_ = false;
  bool parameters_ = false;
  bool source_values_ = false;
  bool is_resistor_ = false;
};

/// A word of a card that measures, where an expression might stand too: AVG, FROM, WHEN, …
[[nodiscard]] bool is_measurement_keyword(std::string_view word);
/// The analysis that a card that measures may name first: tran, ac, …
[[nodiscard]] bool is_analysis_name(std::string_view word);

}  // namespace pwlsim::netlist
