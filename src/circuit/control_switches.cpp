#include "circuit/control_switches.hpp"

#include <algorithm>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;

/// Null where the card has none.
const Item* control_of(const Card& card) {
  if (lower_letter(card.name.front()) != 's' || card.damaged || card.items.size() < 3) return nullptr;
  const auto found = std::find_if(card.items.begin(), card.items.end(), [](const Item& item) {
    return item.kind == Item::Kind::assignment && same_name(item.text, "control") && item.items.size() == 1 && item.items[0].expression;
  });
  return found == card.items.end() ? nullptr : &*found;
}

/// The source of the control, from a node of its own to ground.
Card source_of(const Card& card, const Item& control, const Item& node) {
  Card source = card;
  source.name = "B" + node.text;
  Item value = control;
  value.text = "V";
  source.items = {node, made_word("0", control.span), std::move(value)};
  return source;
}

Card switch_of(const Card& card, const Item& control, const Item& node) {
  Card contact = card;
  std::erase_if(contact.items, [&](const Item& item) { return item.kind == Item::Kind::assignment && same_name(item.text, control.text); });
  contact.items.insert(contact.items.begin() + 2, {node, made_word("0", control.span)});
  return contact;
}

}  // namespace

void replace_control_switches(Definitions& definitions) {
  replace_elements(definitions, [](const Definition&, const Card& card) -> std::optional<std::vector<Card>> {
    const Item* control = control_of(card);
    if (control == nullptr) return std::nullopt;
    const Item node = made_word(card.name + "~control", control->span);
    return std::vector{source_of(card, *control, node), switch_of(card, *control, node)};
  });
}

}  // namespace pwlsim::circuit
