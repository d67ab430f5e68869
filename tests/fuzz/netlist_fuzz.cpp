/// Any bytes are read and flattened without a crash, and keep the promises of ast.hpp, number.hpp, diagnostic.hpp and compile.hpp.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "base/decimal.hpp"
#include "base/diagnostic.hpp"
#include "base/names.hpp"
#include "circuit/compile.hpp"
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

/// Calls of subcircuits within one another multiply: a few lines ask for millions of elements, which is no mistake and takes its time.
constexpr std::ptrdiff_t most_calls = 8;

bool is_small(const pwlsim::netlist::Deck& deck) {
  return std::count_if(deck.cards.begin(), deck.cards.end(),
                       [](const Card& card) { return pwlsim::lower_letter(card.name.front()) == 'x'; }) <= most_calls;
}

void require_finite(double value) { require(std::isfinite(value), "a network's values are finite"); }

void require_finite(const pwlsim::model::LinearForm& form) {
  for (const auto& term : form) require_finite(term.coefficient);
}

void check_values(const pwlsim::model::Network& network) {
  for (const auto& part : network.resistors) require_finite(part.resistance);
  for (const auto& part : network.capacitors) require_finite(part.capacitance);
  for (const auto& part : network.inductors) require_finite(part.inductance);
  for (const auto& part : network.branches) require_finite(part.voltage);
  for (const auto& part : network.injections) require_finite(part.current);
  for (const auto& part : network.complementarities) require_finite(part.slack);
  for (const auto& part : network.switches) require_finite(part.control);
  for (const auto& signal : network.signals) require_finite(signal.form);
}

void compile(const pwlsim::netlist::Deck& deck, pwlsim::SourceStore& sources, pwlsim::Diagnostics& diagnostics) {
  const auto compiled =
      pwlsim::circuit::compile(deck, sources, diagnostics, {.analysis_required = false, .measure = true, .keep_circuit = true});
  require(compiled.has_value() != diagnostics.has_errors(), "a network or an error");
  if (!compiled) return;
  require(compiled->measured_signals <= compiled->network.signals.size(), "measured signals are signals");
  check_values(compiled->network);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pwlsim::SourceStore sources;
  pwlsim::Diagnostics diagnostics;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto deck = pwlsim::netlist::parse(text.starts_with("Version") ? "fuzz.asc" : "fuzz.net", text, sources, diagnostics);
  Checker checker(sources);
  bool damaged = false;
  for (const auto& card : deck.cards) {
    checker.check(card);
    damaged = damaged || card.damaged;
  }
  require(!damaged || diagnostics.has_errors(), "damage is reported");
  if (is_small(deck)) compile(deck, sources, diagnostics);
  for (const auto& diagnostic : diagnostics.all()) {
    require(!render(diagnostic, sources).empty(), "a message has text");
  }
  return 0;
}
