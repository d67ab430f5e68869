#include "circuit/output_expression.hpp"

#include <algorithm>
#include <array>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Expression;
using netlist::Item;
using ExpressionKind = Expression::Kind;
using ItemKind = Item::Kind;

/// A number, a piecewise-linear expression of signals, or something else.
enum class Degree { constant, linear, other };

Degree largest(const std::vector<Expression>& parts);

Degree degree_of_call(const Expression& call) {
  static constexpr std::array<std::string_view, 4> piecewise{"abs", "min", "max", "limit"};
  if (same_name(call.text, "v")) return Degree::linear;
  if (same_name(call.text, "i")) {
    constexpr std::string_view without_current = "fkx";  // no source can follow theirs
    const bool is_named = call.arguments.size() == 1 && !call.arguments[0].text.empty();
    return is_named && without_current.find(lower_letter(call.arguments[0].text.front())) == std::string_view::npos ? Degree::linear
                                                                                                                    : Degree::other;
  }
  const Degree inner = largest(call.arguments);
  return inner == Degree::constant || is_one_of(piecewise, call.text) ? inner : Degree::other;
}

Degree degree_of(const Expression& expression) {
  switch (expression.kind) {
    case ExpressionKind::number:
      return Degree::constant;
    case ExpressionKind::name:
      return same_name(expression.text, "time") ? Degree::linear : Degree::constant;
    case ExpressionKind::call:
      return degree_of_call(expression);
    case ExpressionKind::unary:
      return expression.text == "!" ? Degree::other : largest(expression.arguments);
    case ExpressionKind::conditional:
      return Degree::other;
    case ExpressionKind::binary:
      break;
  }
  const Degree all = largest(expression.arguments);
  if (all != Degree::linear || expression.text == "+" || expression.text == "-") return all;
  const Degree right = degree_of(expression.arguments[1]);
  const bool one_is_constant = right == Degree::constant || degree_of(expression.arguments[0]) == Degree::constant;
  if (expression.text == "*") return one_is_constant ? Degree::linear : Degree::other;
  return expression.text == "/" && right == Degree::constant ? Degree::linear : Degree::other;
}

Degree largest(const std::vector<Expression>& parts) {
  Degree result = Degree::constant;
  for (const Expression& part : parts) result = std::max(result, degree_of(part));
  return result;
}

}  // namespace

std::optional<SaveRequest> output_expression(const Item& item, Definitions& definitions, const Reporter& reporter, FlatCircuit& circuit) {
  const bool is_named = item.kind == ItemKind::assignment && item.items.size() == 1;
  const Item& call = is_named ? item.items[0] : item;
  if (call.kind != ItemKind::group || !same_name(call.text, "par") || call.items.size() != 1 ||
      call.items[0].kind != ItemKind::expression || degree_of(*call.items[0].expression) == Degree::other)
    return std::nullopt;
  SaveRequest request;
  request.column = is_named ? item.text : std::string(reporter.text(item.span));
  const std::string source = "B" + request.column;
  circuit.hidden.names.insert(without_case(source));
  request.first = source + ".value";
  request.first_span = item.span;
  Item value = made_word("V", call.span);
  value.kind = ItemKind::assignment;
  value.items.push_back(call.items[0]);
  netlist::Card card;
  card.name = source + ".source";
  card.name_span = card.span = item.span;
  card.items = {made_word(request.first, call.span), made_word("0", call.span), std::move(value)};
  const auto is_same = [&](const netlist::Card* other) { return same_name(other->name, card.name); };
  auto& elements = definitions.all.front()->elements;
  if (std::none_of(elements.begin(), elements.end(), is_same)) elements.push_back(&definitions.made.emplace_back(std::move(card)));
  return request;
}

}  // namespace pwlsim::circuit
