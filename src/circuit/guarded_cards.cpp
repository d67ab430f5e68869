#include "circuit/guarded_cards.hpp"

#include <fmt/format.h>

#include <cctype>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/names.hpp"
#include "circuit/made_expressions.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Expression;
using netlist::Guard;
using netlist::Item;
using Kind = Expression::Kind;

Expression negated(Expression expression) {
  const SourceSpan span = expression.span;
  return {Kind::unary, 0.0, "!", {std::move(expression)}, span};
}

/// Of at least one guard.
Expression condition_of(const std::vector<Guard>& guards) {
  Expression all;
  for (std::size_t k = 0; k < guards.size(); ++k) {
    const Expression condition = make::value(guards[k].condition);
    Expression next = guards[k].holds ? condition : negated(condition);
    all = k == 0 ? std::move(next) : make::operation(std::move(all), "&&", std::move(next), guards[k].condition.span);
  }
  return all;
}

bool is_element(const Card& card) { return std::isalpha(static_cast<unsigned char>(card.name.front())) != 0; }

struct Variant {
  std::string name;
  Guard guard;
};

/// A subcircuit that is open.
struct Body {
  std::vector<Card> cards;
  std::unordered_map<std::string, Expression> parameters;  ///< the last definition of each
  std::map<std::string, std::vector<Variant>> models;      ///< by the name they share
};

class Decision {
 public:
  std::vector<Card> run(std::vector<Card> cards) {
    bodies_.emplace_back();
    for (Card& card : cards) {
      if (same_name(card.name, ".subckt")) begin(card);
      const bool ends = same_name(card.name, ".ends") && bodies_.size() > 1;
      take(std::move(card));
      if (ends) end();
    }
    while (bodies_.size() > 1) end();
    return std::move(bodies_.front().cards);
  }

 private:
  void begin(const Card& card) {
    bodies_.emplace_back();
    for (const Item& item : card.items)
      if (item.kind == Item::Kind::assignment && item.items.size() == 1) define(item.text, make::value(item.items[0]));
  }

  void end() {
    Body body = std::move(bodies_.back());
    bodies_.pop_back();
    for (Card& card : body.cards) place(std::move(card), body);
  }

  void define(const std::string& name, Expression value) {
    bodies_.back().parameters.insert_or_assign(without_case(name), std::move(value));
  }

  void take(Card card) {
    if (bodies_.size() > 1 && !card.damaged) {
      if (same_name(card.name, ".param") || same_name(card.name, ".params")) parameters(card);
      if (same_name(card.name, ".model") && !card.guards.empty()) model(card);
    }
    bodies_.back().cards.push_back(std::move(card));
  }

  void parameters(Card& card) {
    std::vector<Item> items;
    for (std::size_t k = 0; k < card.items.size(); ++k) {
      Item& item = card.items[k];
      const bool is_pair = item.kind == Item::Kind::word && k + 1 < card.items.size() && card.items[k + 1].kind != Item::Kind::assignment;
      if (is_pair || (item.kind == Item::Kind::assignment && item.items.size() == 1)) {
        items.push_back(parameter(item, is_pair ? card.items[++k] : item.items[0], card.guards));
      } else {
        items.push_back(std::move(item));
      }
    }
    card.items = std::move(items);
    card.guards.clear();
  }

  Item parameter(const Item& name, const Item& value, const std::vector<Guard>& guards) {
    Item item = name;
    item.kind = Item::Kind::assignment;
    item.items = {value};
    if (!guards.empty()) {
      const auto before = bodies_.back().parameters.find(without_case(name.text));
      Expression other =
          before != bodies_.back().parameters.end() ? before->second : make::name(name.text + std::string(undecided_end), name.span);
      item.items[0] =
          make::item({Kind::conditional, 0.0, "?", {condition_of(guards), make::value(value), std::move(other)}, value.span}, value.span);
    }
    define(name.text, make::value(item.items[0]));
    return item;
  }

  void model(Card& card) {
    if (card.items.empty() || card.items[0].kind != Item::Kind::word) return;
    std::vector<Variant>& variants = bodies_.back().models[without_case(card.items[0].text)];
    const Item condition = make::item(condition_of(card.guards), card.guards.front().condition.span);
    variants.push_back({fmt::format("{}~{}", card.items[0].text, variants.size() + 1), {condition, true}});
    card.items[0].text = variants.back().name;
    card.guards.clear();
  }

  /// In the body that contains the one that has ended.
  void place(Card card, const Body& body) {
    std::vector<Card>& cards = bodies_.back().cards;
    for (std::size_t k = 0; is_element(card) && k < card.items.size(); ++k) {
      const auto models = card.items[k].kind == Item::Kind::word ? body.models.find(without_case(card.items[k].text)) : body.models.end();
      if (models == body.models.end()) continue;
      Card other = card;
      for (const Variant& variant : models->second) {
        Card chosen = card;
        chosen.items[k].text = variant.name;
        chosen.guards.push_back(variant.guard);
        cards.push_back(std::move(chosen));
        other.guards.push_back({variant.guard.condition, false});
      }
      cards.push_back(std::move(other));
      return;
    }
    cards.push_back(std::move(card));
  }

  std::vector<Body> bodies_;
};

}  // namespace

bool may_be_undecided(const netlist::Item& value) {
  const Expression* at = value.expression.get();
  while (at != nullptr && at->kind == Kind::conditional) at = &at->arguments[2];
  return at != nullptr && at->kind == Kind::name && at->text.ends_with(undecided_end);
}

std::vector<Card> with_decided_definitions(std::vector<Card> cards) { return Decision().run(std::move(cards)); }

}  // namespace pwlsim::circuit
