#include "netlist/expression_builder.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/names.hpp"
#include "netlist/number.hpp"

namespace pwlsim::netlist {

namespace {

constexpr int conditional_precedence = 1;
constexpr int prefix_precedence = 8;

// Whoever evaluates or frees an expression recurses into it. A thousand parentheses nest at most two and a half thousand nodes
// of any sensible shape; only a chain of thousands of operators goes deeper.
constexpr int deepest_expression = 2500;

int infix_precedence(std::string_view text) {
  static constexpr std::pair<std::string_view, int> table[] = {{"||", 2}, {"|", 2}, {"&&", 3}, {"&", 3},  {"==", 4}, {"!=", 4},
                                                               {"<", 5},  {">", 5}, {"<=", 5}, {">=", 5}, {"+", 6},  {"-", 6},
                                                               {"*", 7},  {"/", 7}, {"^", 9},  {"**", 9}};
  const auto* const found = std::find_if(std::begin(table), std::end(table), [&](const auto& row) { return row.first == text; });
  return found == std::end(table) ? 0 : found->second;
}

bool is_prefix(std::string_view text) { return text == "-" || text == "+" || text == "!" || text == "~"; }

/// PSpice and Xyce write ~ for it.
std::string_view without_tilde(std::string_view prefix) { return prefix == "~" ? "!" : prefix; }

/// par('expression') of output and measurement cards is the expression.
bool is_par(std::string_view name) { return same_name(name, "par"); }

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

}  // namespace

ExpressionBuilder::Outcome ExpressionBuilder::fail(const char* id, std::string_view part, std::string text) {
  context_.report(id, part, std::move(text));
  return Outcome::failed;
}

ExpressionBuilder::Outcome ExpressionBuilder::take(const Token& token) {
  return operand_expected_ ? take_where_operand_expected(token) : take_behind_operand(token);
}

ExpressionBuilder::Outcome ExpressionBuilder::take_where_operand_expected(const Token& token) {
  switch (token.kind) {
    case Token::Kind::number:
      return number(token);
    case Token::Kind::name:
      push_operand(Expression::Kind::name, token.text, token.whole);
      return Outcome::taken;
    case Token::Kind::signal:
      signal(token);
      return Outcome::taken;
    case Token::Kind::call:
      return open(token, Pending::Kind::call);
    case Token::Kind::open:
      return open(token, Pending::Kind::parenthesis);
    case Token::Kind::close:
      if (!pending_.empty() && pending_.back().kind == Pending::Kind::call && pending_.back().operands_before == operands_.size()) {
        operand_expected_ = false;
        return close(token);
      }
      break;
    case Token::Kind::sign:
      if (is_prefix(token.text)) {
        pending_.push_back({Pending::Kind::prefix, prefix_precedence, without_tilde(token.text), token.whole, 0});
        return Outcome::taken;
      }
      break;
    default:
      break;
  }
  return fail("E-syntax-expression", token.whole, "a value is missing before " + quoted(token.text));
}

ExpressionBuilder::Outcome ExpressionBuilder::take_behind_operand(const Token& token) {
  switch (token.kind) {
    case Token::Kind::sign: {
      const int precedence = infix_precedence(token.text);
      if (precedence == 0) {
        break;
      }
      if (!reduce_above(precedence, true)) {
        return Outcome::failed;
      }
      pending_.push_back({Pending::Kind::infix, precedence, token.text, token.whole, 0});
      operand_expected_ = true;
      return Outcome::taken;
    }
    case Token::Kind::question:
      return question(token);
    case Token::Kind::colon:
      return colon(token);
    case Token::Kind::close:
      return close(token);
    case Token::Kind::comma:
      return comma(token);
    default:
      break;
  }
  if (parentheses_ == 0) {
    return Outcome::ended;
  }
  return fail("E-syntax-expression", token.whole, "an operator or ')' is missing before " + quoted(token.whole));
}

ExpressionBuilder::Outcome ExpressionBuilder::number(const Token& token) {
  const NumberText read = read_number(token.text);
  if (!read.valid) {
    return fail("E-syntax-number", token.whole, quoted(token.text) + " is not a number");
  }
  push_operand(Expression::Kind::number, token.text, token.whole);
  operands_.back().expression.number = read.value;
  return Outcome::taken;
}

void ExpressionBuilder::signal(const Token& token) {
  push_operand(Expression::Kind::call, token.text, token.whole);
  Operand& call = operands_.back();
  call.depth = 2;
  call.expression.arguments.reserve(token.nodes.size());
  for (const std::string_view node : token.nodes) {
    call.expression.arguments.push_back({Expression::Kind::name, 0.0, std::string(node), {}, context_.line.span(node)});
  }
}

void ExpressionBuilder::push_operand(Expression::Kind kind, std::string_view text, std::string_view whole) {
  operands_.push_back({{kind, 0.0, std::string(text), {}, context_.line.span(whole)}, 1});
  operand_expected_ = false;
}

ExpressionBuilder::Outcome ExpressionBuilder::open(const Token& token, Pending::Kind kind) {
  if (parentheses_ == context_.parentheses) {
    const std::string_view parenthesis = token.whole.substr(token.whole.size() - 1);
    return fail("E-limit-parentheses", parenthesis,
                "parentheses nest deeper than " + std::to_string(context_.parentheses) + "; try a .param for the inner part");
  }
  ++parentheses_;
  pending_.push_back({kind, 0, token.text, token.whole, operands_.size()});
  return Outcome::taken;
}

ExpressionBuilder::Outcome ExpressionBuilder::close(const Token& token) {
  if (parentheses_ == 0) {
    return Outcome::ended;
  }
  if (!reduce_above(0, false)) {
    return Outcome::failed;
  }
  const Pending opened = pending_.back();
  if (opened.kind == Pending::Kind::question) {
    return fail("E-syntax-expression", opened.whole, "'?' has no ':'");
  }
  if ((opened.whole.back() == '{') != (token.text == "}")) {
    const std::string_view parenthesis = opened.whole.substr(opened.whole.size() - 1);
    return fail("E-syntax-unclosed", parenthesis, quoted(parenthesis) + " is closed by " + quoted(token.text));
  }
  pending_.pop_back();
  --parentheses_;
  const SourceSpan span = context_.line.span(opened.whole.data(), token.whole.data() + token.whole.size());
  const std::size_t arguments = operands_.size() - opened.operands_before;
  if (opened.kind == Pending::Kind::call && !(is_par(opened.text) && arguments == 1)) {
    return combine(Expression::Kind::call, opened, arguments, span) ? Outcome::taken : Outcome::failed;
  }
  operands_.back().expression.span = span;
  return Outcome::taken;
}

ExpressionBuilder::Outcome ExpressionBuilder::comma(const Token& token) {
  if (parentheses_ == 0) {
    return Outcome::ended;
  }
  if (!reduce_above(0, false)) {
    return Outcome::failed;
  }
  if (pending_.back().kind != Pending::Kind::call) {
    return fail("E-syntax-expression", token.whole, "',' separates function arguments, but there is no function here");
  }
  operand_expected_ = true;
  return Outcome::taken;
}

ExpressionBuilder::Outcome ExpressionBuilder::question(const Token& token) {
  if (!reduce_above(conditional_precedence, false)) {
    return Outcome::failed;
  }
  pending_.push_back({Pending::Kind::question, 0, token.text, token.whole, 0});
  operand_expected_ = true;
  return Outcome::taken;
}

ExpressionBuilder::Outcome ExpressionBuilder::colon(const Token& token) {
  if (!reduce_above(0, false)) {
    return Outcome::failed;
  }
  if (pending_.empty() || pending_.back().kind != Pending::Kind::question) {
    return parentheses_ == 0 ? Outcome::ended : fail("E-syntax-expression", token.whole, "':' has no '?'");
  }
  pending_.back().kind = Pending::Kind::colon;
  pending_.back().precedence = conditional_precedence;
  operand_expected_ = true;
  return Outcome::taken;
}

/// Combines what waits on the stack with a precedence above `precedence` (or equal to it).
bool ExpressionBuilder::reduce_above(int precedence, bool equal_too) {
  while (!pending_.empty() && (pending_.back().precedence > precedence || (equal_too && pending_.back().precedence == precedence))) {
    if (!reduce_top()) {
      return false;
    }
  }
  return true;
}

bool ExpressionBuilder::reduce_top() {
  const Pending top = pending_.back();
  pending_.pop_back();
  const SourceSpan& right = operands_.back().expression.span;
  switch (top.kind) {
    case Pending::Kind::prefix:
      return combine(Expression::Kind::unary, top, 1, cover(context_.line.span(top.whole), right));
    case Pending::Kind::colon:
      return combine(Expression::Kind::conditional, top, 3, cover(operands_[operands_.size() - 3].expression.span, right));
    default:
      return combine(Expression::Kind::binary, top, 2, cover(operands_[operands_.size() - 2].expression.span, right));
  }
}

/// Makes the last `count` operands the arguments of one.
bool ExpressionBuilder::combine(Expression::Kind kind, const Pending& operation, std::size_t count, SourceSpan span) {
  Operand combined{{kind, 0.0, std::string(operation.text), {}, span}, 1};
  combined.expression.arguments.reserve(count);
  const auto first = operands_.end() - static_cast<std::ptrdiff_t>(count);
  for (auto operand = first; operand != operands_.end(); ++operand) {
    combined.depth = std::max(combined.depth, operand->depth + 1);
    combined.expression.arguments.push_back(std::move(operand->expression));
  }
  operands_.erase(first, operands_.end());
  const bool allowed = combined.depth <= deepest_expression;
  operands_.push_back(std::move(combined));
  if (!allowed) {
    fail("E-limit-expression", operation.whole,
         "more than " + std::to_string(deepest_expression) + " nested operations; try a .param for a part of them");
  }
  return allowed;
}

bool ExpressionBuilder::at_quote() const {
  return operand_expected_ && !pending_.empty() && pending_.back().kind == Pending::Kind::call && is_par(pending_.back().text);
}

bool ExpressionBuilder::finish(const char* end, Expression& result) {
  if (operand_expected_) {
    const std::string_view last = pending_.empty() ? part(end, end) : pending_.back().whole;
    fail("E-syntax-expression", last, pending_.empty() ? "an expression is missing" : "a value is missing after " + quoted(last));
    return false;
  }
  if (!reduce_above(0, false)) {
    return false;
  }
  if (!pending_.empty()) {
    const Pending& opened = pending_.back();
    const bool question = opened.kind == Pending::Kind::question;
    fail(question ? "E-syntax-expression" : "E-syntax-unclosed", opened.whole.substr(opened.whole.size() - 1),
         question ? "'?' has no ':'" : quoted(opened.whole.substr(opened.whole.size() - 1)) + " is never closed");
    return false;
  }
  result = std::move(operands_.back().expression);
  return true;
}

}  // namespace pwlsim::netlist
