#pragma once
/// Tokens -> Expression by operator precedence with explicit stacks, so that deep nesting does not exhaust the program's stack.
///
/// From weak to strong: ?: (right), || |, && &, == !=, < > <= >=, + -, * /, prefix - + !, ^ ** (left).

#include <vector>

#include "netlist/ast.hpp"
#include "netlist/context.hpp"
#include "netlist/token.hpp"

namespace pwlsim::netlist {

class ExpressionBuilder {
 public:
  explicit ExpressionBuilder(const ParseContext& context) : context_(context) {}

  enum class Outcome {
    taken,
    ended,  ///< the expression is complete and this token is not part of it
    failed  ///< an error has been reported
  };
  Outcome take(const Token& token);

  /// Whether the tokens so far are an expression.
  /// Whether this is after `par(`, where a quoted expression may follow (ngspice, HSPICE).
  [[nodiscard]] bool at_quote() const;
  [[nodiscard]] bool complete() const { return !operand_expected_ && parentheses_ == 0; }

  /// Call at the end, which is at `end`. False, with an error reported, if something is missing.
  bool finish(const char* end, Expression& result);

 private:
  /// An operator on the stack that waits for its right operand.
  struct Pending {
    enum class Kind { parenthesis, call, question, colon, prefix, infix };
    Kind kind = Kind::parenthesis;
    int precedence = 0;
    std::string_view text;
    std::string_view whole;
    std::size_t operands_before = 0;  ///< for a call: where its arguments begin
  };
  struct Operand {
    Expression expression;
    int depth = 1;
  };

  Outcome take_where_operand_expected(const Token& token);
  Outcome take_behind_operand(const Token& token);
  Outcome open(const Token& token, Pending::Kind kind);
  Outcome close(const Token& token);
  Outcome comma(const Token& token);
  Outcome question(const Token& token);
  Outcome colon(const Token& token);
  Outcome number(const Token& token);
  void signal(const Token& token);
  void push_operand(Expression::Kind kind, std::string_view text, std::string_view whole);
  bool reduce_above(int precedence, bool equal_too);
  bool reduce_top();
  bool combine(Expression::Kind kind, const Pending& operation, std::size_t count, SourceSpan span);
  Outcome fail(const char* id, std::string_view part, std::string text);

  const ParseContext& context_;
  std::vector<Pending> pending_;
  std::vector<Operand> operands_;
  int parentheses_ = 0;
  bool operand_expected_ = true;
};

}  // namespace pwlsim::netlist
