#include "circuit/measured_powers.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <unordered_map>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Expression;
using netlist::Item;
using Powers = std::unordered_map<std::string, std::shared_ptr<const Expression>>;

bool is_probe(const Expression& expression) {
  return expression.kind == Expression::Kind::call && (same_name(expression.text, "v") || same_name(expression.text, "i"));
}

bool reads_probes(const Expression& expression) {
  return is_probe(expression) || std::any_of(expression.arguments.begin(), expression.arguments.end(), reads_probes);
}

bool has_product_of_signals(const Expression& expression) {
  constexpr std::string_view products[] = {"*", "/"}, powers[] = {"^", "**", "pow"};
  const bool is_product = expression.kind == Expression::Kind::binary && is_one_of(products, expression.text);
  if (is_product && std::all_of(expression.arguments.begin(), expression.arguments.end(), reads_probes)) return true;
  if (is_one_of(powers, expression.text) && !expression.arguments.empty() && reads_probes(expression.arguments[0])) return true;
  return !is_probe(expression) && std::any_of(expression.arguments.begin(), expression.arguments.end(), has_product_of_signals);
}

/// v(node) alone; "" for another expression.
std::string node_of(const Expression& expression) {
  const bool is_voltage = is_probe(expression) && same_name(expression.text, "v") && expression.arguments.size() == 1;
  return is_voltage ? without_case(expression.arguments[0].text) : "";
}

bool reads_node(const Expression& expression, const std::string& node) {
  if (is_probe(expression))
    return same_name(expression.text, "v") && std::any_of(expression.arguments.begin(), expression.arguments.end(),
                                                          [&](const Expression& each) { return same_name(each.text, node); });
  return std::any_of(expression.arguments.begin(), expression.arguments.end(),
                     [&](const Expression& each) { return reads_node(each, node); });
}

Powers powers_of(const Definition& deck) {
  Powers powers;
  for (const Card* card : deck.elements) {
    constexpr std::size_t parts = 3;
    if (lower_letter(card->name.front()) != 'b' || card->damaged || card->items.size() < parts) continue;
    const Item& value = card->items[2];
    const bool is_held =
        card->items[0].kind == Item::Kind::word && card->items[1].kind == Item::Kind::word && is_ground_name(card->items[1].text);
    if (!is_held || value.kind != Item::Kind::assignment || !same_name(value.text, "v") || value.items.size() != 1) continue;
    const std::shared_ptr<const Expression>& expression = value.items[0].expression;
    const std::string node = without_case(card->items[0].text);
    if (expression && has_product_of_signals(*expression) && !reads_node(*expression, node)) powers.emplace(node, expression);
  }
  return powers;
}

/// Whether it has changed.
bool put_in(Expression& expression, const Powers& powers) {
  if (const auto power = powers.find(node_of(expression)); power != powers.end()) {
    expression = *power->second;
    return true;
  }
  bool changed = false;
  if (!is_probe(expression))
    for (Expression& argument : expression.arguments) changed |= put_in(argument, powers);
  return changed;
}

}  // namespace

void measure_powers(Definitions& definitions) {
  if (!definitions.written_by_ltspice) return;
  const Powers powers = powers_of(*definitions.all.front());
  if (powers.empty()) return;
  for (const Card*& card : definitions.measurements) {
    Card measured = *card;
    bool changed = false;
    for (Item& item : measured.items) {
      if (!item.expression) continue;
      Expression expression = *item.expression;
      if (!put_in(expression, powers)) continue;
      item.expression = std::make_shared<const Expression>(std::move(expression));
      changed = true;
    }
    if (changed) card = &definitions.made.emplace_back(std::move(measured));
  }
}

}  // namespace pwlsim::circuit
