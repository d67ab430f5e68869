#include "api/element_value.hpp"

#include <algorithm>
#include <iterator>

#include "base/names.hpp"
#include "netlist/number.hpp"

namespace pwlsim::api {
namespace {

using netlist::Card;
using netlist::Item;

char letter_of(const Card& card) { return card.name.empty() ? ' ' : lower_letter(card.name.front()); }

bool is_number(const Item& item) {
  return item.kind == Item::Kind::expression || (item.kind == Item::Kind::word && netlist::read_number(item.text).valid);
}

/// Items before the value where no name leads to it.
std::optional<std::size_t> items_before(const Card& card) {
  constexpr std::string_view two = "rclvi", three = "fh", four = "eg";
  const char letter = letter_of(card);
  if (two.find(letter) != std::string_view::npos) return 2;
  if (three.find(letter) != std::string_view::npos) return 3;
  if (four.find(letter) != std::string_view::npos) return 4;
  if (letter == 'k' && card.items.size() >= 3) return card.items.size() - 1;
  return {};
}

bool ends_waveform(const Item& item) {
  return item.kind == Item::Kind::assignment || (item.kind == Item::Kind::word && same_name(item.text, "ac"));
}

std::optional<ValuePlace> named_place(const Card& card) {
  for (std::size_t i = 0; i < card.items.size(); ++i) {
    const Item& item = card.items[i];
    if (item.kind == Item::Kind::assignment && (same_name(item.text, card.name.substr(0, 1)) || same_name(item.text, "value")))
      return ValuePlace{i, i + 1};
  }
  return {};
}

}  // namespace

bool has_parameter(const std::vector<Card>& cards, std::string_view name) {
  int depth = 0;
  for (const Card& card : cards) {
    depth += static_cast<int>(same_name(card.name, ".subckt")) - static_cast<int>(same_name(card.name, ".ends"));
    if (depth != 0 || !same_name(card.name, ".param")) continue;
    const auto is_it = [name](const Item& item) { return item.kind == Item::Kind::assignment && same_name(item.text, name); };
    if (std::any_of(card.items.begin(), card.items.end(), is_it)) return true;
  }
  return false;
}

Card* find_card(std::vector<Card>& cards, std::string_view name) {
  Card* found = nullptr;
  int depth = 0;
  for (Card& card : cards) {
    depth += static_cast<int>(same_name(card.name, ".subckt")) - static_cast<int>(same_name(card.name, ".ends"));
    if (depth == 0 && same_name(card.name, name)) found = &card;
  }
  return found;
}

std::optional<ValuePlace> place_of_value(const Card& card) {
  const std::optional<std::size_t> first = items_before(card);
  if (!first) return {};
  const char letter = letter_of(card);
  if (letter == 'v' || letter == 'i') {
    const auto end = std::find_if(card.items.begin() + static_cast<std::ptrdiff_t>(std::min(*first, card.items.size())), card.items.end(),
                                  ends_waveform);
    return ValuePlace{*first, static_cast<std::size_t>(end - card.items.begin())};
  }
  if (const auto named = named_place(card)) return letter == 'r' || letter == 'c' || letter == 'l' ? named : std::nullopt;
  if (card.items.size() <= *first || !is_number(card.items[*first])) return {};
  return ValuePlace{*first, *first + 1};
}

std::string head_of_value(const Card& card, const ValuePlace& place) {
  std::string text = card.name;
  for (std::size_t i = 0; i < place.first; ++i) text += " n" + std::to_string(i);
  return text;
}

void replace_value(Card& card, const ValuePlace& place, const Card& parsed) {
  std::vector<Item> value;
  if (parsed.items.size() > place.first) value.assign(parsed.items.begin() + static_cast<std::ptrdiff_t>(place.first), parsed.items.end());
  auto& items = card.items;
  const auto first = items.begin() + static_cast<std::ptrdiff_t>(place.first),
             last = items.begin() + static_cast<std::ptrdiff_t>(place.last);
  items.insert(items.erase(first, last), std::make_move_iterator(value.begin()), std::make_move_iterator(value.end()));
}

std::optional<double> value_of(const elements::Instance& instance) {
  if (instance.formula) return {};
  switch (instance.kind->tail) {
    case elements::Tail::value:
      return instance.values.get(instance.kind->parameters.front().name);
    case elements::Tail::gain:
      if (instance.coefficients.size() != 2 || instance.coefficients.front() != 0.0) return {};
      return instance.coefficients.back();
    case elements::Tail::waveform:
      if (!instance.waveform) return 0.0;
      if (const auto* constant = std::get_if<model::Dc>(&*instance.waveform)) return constant->value;
      return {};
    default:
      return {};
  }
}

}  // namespace pwlsim::api
