#include "netlist/expression.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "netlist/expression_builder.hpp"

namespace pwlsim::netlist {

namespace {

using Outcome = ExpressionBuilder::Outcome;

void skip_blanks(const char*& at, const char* last) { at = std::find_if_not(at, last, is_blank); }

/// Behind the character that closes what `first` opens, or `last`.
const char* behind_closing(const char* first, const char* last) {
  if (*first == '\'') {
    const char* const closing = std::find(first + 1, last, '\'');
    return closing == last ? last : closing + 1;
  }
  int depth = 0;
  for (const char* at = first; at != last; ++at) {
    depth += *at == '{' ? 1 : *at == '}' ? -1 : 0;
    if (depth == 0) {
      return at + 1;
    }
  }
  return last;
}

bool report_unexpected(const char* at, const char* last, const ParseContext& context) {
  const std::string_view character = first_character(at, last);
  context.report("E-syntax-expression", character, "'" + std::string(character) + "' does not belong in an expression");
  return false;
}

/// Why `token` ended an expression that only its closing character may end.
bool report_ended_by(const Token& token, const char* opening, const ParseContext& context) {
  if (token.text == "{") {  // no expression holds one: another begins
    context.report("E-syntax-unclosed", part(opening, opening + 1), "'" + std::string(1, *opening) + "' is never closed");
    return false;
  }
  const std::string text(token.whole);
  const bool closes = token.kind == Token::Kind::close;
  context.report("E-syntax-expression", token.whole,
                 closes                             ? "'" + text + "' closes nothing"
                 : token.kind == Token::Kind::comma ? "',' separates function arguments, but there is no function here"
                 : token.kind == Token::Kind::colon ? "':' has no '?'"
                                                    : "an operator is missing before '" + text + "'");
  return false;
}

/// Skips the quotes of par('…').
class ParQuotes {
 public:
  bool skip(const char*& at, const ExpressionBuilder& builder) {
    if (*at != '\'' || !(is_open_ || builder.at_quote())) return false;
    is_open_ = !is_open_;
    ++at;
    return true;
  }

 private:
  bool is_open_ = false;
};

bool read_delimited(const char*& at, const char* last, const ParseContext& context, Expression& result) {
  const char* const opening = at++;
  ExpressionBuilder builder(context);
  ParQuotes quotes;
  Token token;
  for (skip_blanks(at, last); at != last; skip_blanks(at, last)) {
    if (*opening == '\'' && *at == '\'') {
      const bool complete = builder.finish(at, result);
      ++at;
      return complete;
    }
    if (*opening == '{' && quotes.skip(at, builder)) continue;
    if (!next_token(at, last, token)) {
      return report_unexpected(at, last, context);
    }
    const Outcome outcome = builder.take(token);
    if (outcome == Outcome::ended && *opening == '{' && token.text == "}") {
      return builder.finish(token.whole.data(), result);
    }
    if (outcome != Outcome::taken) {
      return outcome == Outcome::ended && report_ended_by(token, opening, context);
    }
  }
  context.report("E-syntax-unclosed", part(opening, opening + 1), "'" + std::string(1, *opening) + "' is never closed");
  return false;
}

bool read_open(const char*& first, const char* last, const ParseContext& context, Expression& result) {
  ExpressionBuilder builder(context);
  ParQuotes quotes;
  Token token;
  const char* at = first;
  for (skip_blanks(at, last); at != last; skip_blanks(at, last)) {
    if (quotes.skip(at, builder)) continue;
    if (!next_token(at, last, token)) {
      if (builder.complete()) {
        break;
      }
      return report_unexpected(at, last, context);
    }
    const Outcome outcome = builder.take(token);
    if (outcome == Outcome::failed) {
      return false;
    }
    if (outcome == Outcome::ended) {
      break;
    }
    first = at;
  }
  return builder.finish(first, result);
}

void make_unknown(Expression& result, SourceSpan span) {
  result = Expression{Expression::Kind::number, std::numeric_limits<double>::quiet_NaN(), {}, {}, span};
}

}  // namespace

bool parse_delimited_expression(const char*& first, const char* last, const ParseContext& context, Expression& result) {
  const char* const begin = first;
  if (read_delimited(first, last, context, result)) {
    return true;
  }
  first = behind_closing(begin, last);
  make_unknown(result, context.line.span(begin, first));
  return false;
}

bool parse_open_expression(const char*& first, const char* last, const ParseContext& context, Expression& result) {
  const char* const begin = first;
  if (read_open(first, last, context, result)) {
    return true;
  }
  first = last;
  make_unknown(result, context.line.span(begin, first));
  return false;
}

}  // namespace pwlsim::netlist
