#include "circuit/number_cure.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "netlist/load.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Expression;

/// U+2212, U+2013 and U+2014 look like the minus of a keyboard.
std::string with_plain_minus(std::string_view text) {
  std::string plain(text);
  for (const std::string_view look_alike : {"\u2212", "\u2013", "\u2014"}) {
    for (std::size_t at = plain.find(look_alike); at != std::string::npos; at = plain.find(look_alike))
      plain.replace(at, look_alike.size(), "-");
  }
  return plain;
}

bool are_names_known(const Expression& expression, Scope& scope) {
  if (expression.kind == Expression::Kind::name && !scope.knows(expression.text)) return false;
  return std::all_of(expression.arguments.begin(), expression.arguments.end(),
                     [&](const Expression& argument) { return are_names_known(argument, scope); });
}

bool is_expression(std::string_view text, Scope& scope) {
  if (text.find_first_of("+-*/^(") == std::string_view::npos || text.find_first_of("{}\n") != std::string_view::npos) return false;
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Deck deck = netlist::parse("", fmt::format("\nR1 a b {{{}}}\n", text), sources, diagnostics);
  if (diagnostics.has_errors() || deck.cards.size() != 1 || deck.cards[0].items.size() != 3) return false;
  const netlist::Item& value = deck.cards[0].items[2];
  return value.kind == netlist::Item::Kind::expression && are_names_known(*value.expression, scope);
}

}  // namespace

std::string number_cure(std::string_view text, Scope& scope) {
  const std::string plain = with_plain_minus(text);
  if (plain != text && netlist::read_number(plain).valid) return fmt::format("; try {}", plain);
  return is_expression(plain, scope) ? fmt::format("; try {{{}}}", plain) : "";
}

std::string surplus_cure(const netlist::Item& value, const netlist::Item& surplus, Reporter& reporter, std::string_view usage) {
  constexpr auto word = netlist::Item::Kind::word;
  const bool are_words = value.kind == word && surplus.kind == word && !surplus.text.empty();
  const bool is_comma = reporter.text({value.span.file, value.span.end, surplus.span.begin}) == ",";
  constexpr std::size_t longest_unit = 5;  // Ohms, Farad
  const bool is_unit =
      are_words && surplus.text.size() <= longest_unit && std::isalpha(static_cast<unsigned char>(surplus.text.front())) != 0;
  const std::string whole = value.text + (is_comma ? "." : "") + surplus.text;
  if (!are_words || !(is_comma || is_unit) || !netlist::read_number(whole).valid) return fmt::format("usage: {}", usage);
  return fmt::format("a {} ends a value: try {}", is_comma ? "comma" : "blank", whole);
}

}  // namespace pwlsim::circuit
