/// Any bytes are read without a crash, and what is read keeps the promises of ast.hpp, number.hpp and diagnostic.hpp.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "base/decimal.hpp"
#include "base/diagnostic.hpp"
#include "base/names.hpp"
#include "netlist/load.hpp"
#include "netlist/number.hpp"

namespace {

using pwlsim::netlist::Card;
using pwlsim::netlist::Expression;
using pwlsim::netlist::Item;

void require(bool promise, const char* what) {
  if (!promise) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

class Checker {
 public:
  explicit Checker(const pwlsim::SourceStore& sources) : sources_(sources) {}

  void check(const Card& card) {
    damaged_ = card.damaged;
    check(card.span);
    check(card.name_span);
    require(!card.name.empty(), "a card has a name");
    for (const auto& item : card.items) {
      check(item);
    }
  }

 private:
  void check(const pwlsim::SourceSpan& span) const {
    require(span.known() && span.begin <= span.end && span.end <= sources_.text(span.file).size(), "a span lies in its text");
  }

  void check(const Item& item) {
    check(item.span);
    check(item.text_span);
    require(item.span.begin <= item.text_span.begin && item.text_span.end <= item.span.end, "an item covers its text");
    const std::string_view source = sources_.text(item.text_span);
    switch (item.kind) {
      case Item::Kind::word:
        require(item.text == source || source.find('\n') != std::string_view::npos, "a word is spelled as in the source");
        check_number(item.text);
        break;
      case Item::Kind::expression:
        require(item.expression != nullptr, "an expression item has an expression");
        check(*item.expression);
        break;
      case Item::Kind::assignment:
        require(item.items.size() <= 2, "an assignment has a value and a left side at most");
        break;
      default:
        break;
    }
    for (const auto& inner : item.items) {
      check(inner);
    }
  }

  void check(const Expression& expression) {
    check(expression.span);
    const std::size_t count = expression.arguments.size();
    switch (expression.kind) {
      case Expression::Kind::number:
        require(damaged_ || !std::isnan(expression.number), "only damage makes NaN");
        [[fallthrough]];
      case Expression::Kind::name:
        require(count == 0, "numbers and names have no arguments");
        break;
      case Expression::Kind::unary:
        require(count == 1, "a sign has one argument");
        break;
      case Expression::Kind::binary:
        require(count == 2, "an operator has two arguments");
        break;
      case Expression::Kind::conditional:
        require(count == 3, "a condition has three arguments");
        break;
      case Expression::Kind::call:
        require(!expression.text.empty(), "a function has a name");
        break;
    }
    for (const auto& argument : expression.arguments) {
      check(argument);
    }
  }

  static void check_number(std::string_view text) {
    const auto number = pwlsim::netlist::read_number(text);
    require(!std::isnan(number.value), "no text is NaN");
    const auto decimal = pwlsim::parse_decimal(number.decimal_digits);
    require(!decimal || pwlsim::to_double(*decimal) == number.value, "the decimal text is the number");
  }

  const pwlsim::SourceStore& sources_;
  bool damaged_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pwlsim::SourceStore sources;
  pwlsim::Diagnostics diagnostics;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto deck = pwlsim::netlist::parse("fuzz.net", text, sources, diagnostics);
  Checker checker(sources);
  bool damaged = false;
  for (const auto& card : deck.cards) {
    checker.check(card);
    damaged = damaged || card.damaged;
  }
  require(!damaged || diagnostics.has_errors(), "damage is reported");
  for (const auto& diagnostic : diagnostics.all()) {
    require(!render(diagnostic, sources).empty(), "a message has text");
  }
  return 0;
}
