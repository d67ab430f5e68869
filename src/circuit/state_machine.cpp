#include "circuit/state_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/names.hpp"
#include "circuit/made_expressions.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Expression;
using netlist::Item;
using ItemKind = Item::Kind;

constexpr std::string_view any_state = "*", state_word = "state";
constexpr double output_scale = 1e-3;  ///< A of an output whose expression is 1

Item assignment(std::string name, Item value) {
  Item item = made_word(std::move(name), value.span);
  item.kind = ItemKind::assignment;
  item.items.push_back(std::move(value));
  return item;
}

class Machine {
 public:
  Machine(const StateMachineText& text, Definition& definition, std::size_t number, Definitions& definitions, Reporter& reporter)
      : text_(text),
        definition_(definition),
        definitions_(definitions),
        reporter_(reporter),
        span_(text.begin->name_span),
        part_(fmt::format("machine~{}", number)) {}

  void make() {
    if (!read_states() || !read_rules() || !check_outputs()) return;
    for (const char letter : {'V', 'B', 'S', 'R'}) definition_.hidden.push_back(letter + part_);
    definition_.hidden.push_back(part_);
    add_model("sum", 0.0);
    add_model("latch", 0.5);
    add("V", "one", {word(node("one")), word("0"), word("1")});
    for (std::size_t k = 0; k < rules_.size(); ++k) add_rule(k);
    for (std::size_t k = 0; k < states_.size(); ++k) add_state(k);
    for (std::size_t k = 0; k < text_.outputs.size(); ++k) add_output(k);
    if (reporter_.first_time("LTspice's state machines"))
      reporter_.note(
          "N-idealised", span_,
          "LTspice's state machine is idealised: rules lead on in zero time, and an output is a current of 1 mA times its expression");
  }

 private:
  struct Rule {
    std::optional<std::size_t> from;  ///< none: any
    std::size_t to = 0;
    const Item* condition = nullptr;
  };

  bool fail(const std::string& id, SourceSpan span, const std::string& what) {
    reporter_.error(id, span, what);
    return false;
  }

  bool read_states() {
    for (const Card* card : text_.states) {
      if (card->damaged) return false;
      const bool is_read = card->items.size() == 2 && card->items[0].kind == ItemKind::word &&
                           (card->items[1].kind == ItemKind::word || card->items[1].kind == ItemKind::expression);
      if (!is_read) return fail("E-missing-value", card->span, "a state needs a name and a value; usage: .state name value");
      if (place_of(card->items[0].text))
        return fail("E-duplicate-element", card->items[0].span, fmt::format("a second state {}", card->items[0].text));
      states_.push_back(card);
    }
    return true;
  }

  [[nodiscard]] std::optional<std::size_t> place_of(std::string_view name) const {
    const auto found = std::find_if(states_.begin(), states_.end(), [&](const Card* card) { return same_name(card->items[0].text, name); });
    if (found == states_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - states_.begin());
  }

  /// Those from any state go before the others.
  bool read_rules() {
    for (const Card* card : text_.rules) {
      constexpr std::size_t parts = 3;
      if (card->damaged) return false;
      if (card->items.size() < parts || card->items[0].kind != ItemKind::word || card->items[1].kind != ItemKind::word)
        return fail("E-missing-value", card->span, "a rule needs two states and a condition; usage: .rule from to condition");
      if (card->items.size() > parts)
        return fail("E-unexpected", card->items[parts].span, "a rule ends with its condition; usage: .rule from to condition");
      Rule rule{place_of(card->items[0].text), 0, &card->items[2]};
      const std::optional<std::size_t> to = place_of(card->items[1].text);
      if (!rule.from && card->items[0].text != any_state) return unknown_state(card->items[0]);
      if (!to) return unknown_state(card->items[1]);
      rule.to = *to;
      rules_.push_back(rule);
    }
    std::stable_partition(rules_.begin(), rules_.end(), [](const Rule& rule) { return !rule.from; });
    return true;
  }

  bool unknown_state(const Item& item) {
    std::vector<std::string> names;
    for (const Card* card : states_) names.push_back(card->items[0].text);
    return fail("E-unknown-parameter", item.span, fmt::format("unknown state '{}'{}", item.text, suggestion(item.text, names)));
  }

  bool check_outputs() {
    for (const Card* card : text_.outputs) {
      if (card->damaged) return false;
      const auto is_node = [](const Item& item) {
        return item.kind == ItemKind::group && item.text.empty() && item.items.size() == 1 && item.items[0].kind == ItemKind::word;
      };
      if (card->items.size() != 2 || !is_node(card->items[0]))
        return fail("E-missing-value", card->span, "an output needs a node and an expression; usage: .output (node) expression");
    }
    return true;
  }

  [[nodiscard]] std::string node(const std::string& name) const { return part_ + "." + name; }
  [[nodiscard]] Item word(std::string text) const { return made_word(std::move(text), span_); }
  [[nodiscard]] Expression bit(const std::string& name) const { return make::call("v", {make::name(node(name), span_)}, span_); }

  void add(std::string_view letter, const std::string& name, std::vector<Item> items) { add(letter, name, span_, std::move(items)); }
  void add(std::string_view letter, const std::string& name, SourceSpan span, std::vector<Item> items) {
    Card card;
    card.name = fmt::format("{}{}", letter, node(name));
    card.name_span = card.span = span;
    card.items = std::move(items);
    definition_.elements.push_back(&definitions_.made.emplace_back(std::move(card)));
  }

  /// A switch with threshold 0.
  void add_model(const std::string& name, double hysteresis) {
    Item type = word("SW");
    type.kind = ItemKind::group;
    type.items = {assignment("Vt", word("0")), assignment("Vh", make::item(make::number(hysteresis, span_), span_))};
    Card card;
    card.name = ".model";
    card.name_span = card.span = span_;
    card.items = {word(node(name)), std::move(type)};
    definition_.models.emplace(node(name), &definitions_.made.emplace_back(std::move(card)));
  }

  /// Node `name` is 1 while the switch is closed, else 0; the control is `sum`.
  void add_bit(const std::string& name, Expression sum, const std::string& model, bool starts_closed) {
    add("B", "c" + name, {word(node("c" + name)), word("0"), assignment("V", make::item(std::move(sum), span_))});
    std::vector<Item> items{word(node("one")), word(node(name)), word(node("c" + name)), word("0"), word(node(model))};
    if (starts_closed) items.push_back(word("on"));
    add("S", name, std::move(items));
    add("R", name, {word(node(name)), word("0"), word("1")});
  }

  void add_rule(std::size_t k) {
    const Rule& rule = rules_[k];
    const std::string name = fmt::format("r{}", k), condition = fmt::format("if{}", k);
    Expression holds =
        make::call("if", {with_state(make::value(*rule.condition), true), make::number(1.0), make::number(0.0)}, rule.condition->span);
    add("B", condition, rule.condition->span,
        {word(node(condition)), word("0"), assignment("V", make::item(std::move(holds), rule.condition->span))});
    Expression sum = make::operation(bit(condition), "-", make::number(rule.from ? 1.5 : 0.5), span_);
    if (rule.from) sum = make::operation(std::move(sum), "+", bit(state_bit(*rule.from)), span_);
    for (std::size_t before = 0; before < k; ++before) {
      if (rules_[before].from && rules_[before].from != rule.from) continue;
      sum = make::operation(std::move(sum), "-", make::operation(make::number(2.0), "*", bit(fmt::format("r{}", before)), span_), span_);
    }
    add_bit(name, std::move(sum), "sum", false);
  }

  [[nodiscard]] static std::string state_bit(std::size_t state) { return fmt::format("s{}", state); }

  /// Rises with a rule that leads to it, falls with one that leads elsewhere.
  void add_state(std::size_t state) {
    Expression sum = make::number(0.0);
    for (std::size_t k = 0; k < rules_.size(); ++k)
      sum = make::operation(std::move(sum), rules_[k].to == state ? "+" : "-", bit(fmt::format("r{}", k)), span_);
    add_bit(state_bit(state), std::move(sum), "latch", state == 0);
  }

  void add_output(std::size_t k) {
    const Card& card = *text_.outputs[k];
    Expression current = make::operation(make::number(output_scale), "*", with_state(make::value(card.items[1])), card.items[1].span);
    add("B", fmt::format("out{}", k), card.items[1].span,
        {word("0"), card.items[0].items[0], assignment("I", make::item(std::move(current), card.items[1].span))});
  }

  /// What depends on nothing but the word `state` is a number for each state: the sum of these numbers times the bits, as a condition compared with 0.5.
  [[nodiscard]] Expression with_state(Expression expression, bool is_condition = false) const {
    if (is_probe(expression) || !names_state(expression)) return expression;
    if (!reads_signals(expression)) {
      const SourceSpan span = expression.span;
      Expression sum = number_of_state(expression);
      return is_condition ? make::operation(std::move(sum), ">", make::number(0.5), span) : sum;
    }
    constexpr std::string_view logical[] = {"!", "~", "&", "&&", "|", "||"};
    const bool is_logical = std::find(std::begin(logical), std::end(logical), expression.text) != std::end(logical);
    const bool chooses = expression.kind == Expression::Kind::conditional || same_name(expression.text, "if");
    for (std::size_t k = 0; k < expression.arguments.size(); ++k)
      expression.arguments[k] = with_state(std::move(expression.arguments[k]), is_logical || (chooses && k == 0));
    return expression;
  }

  static bool is_probe(const Expression& expression) {
    return expression.kind == Expression::Kind::call && (same_name(expression.text, "v") || same_name(expression.text, "i"));
  }
  static bool is_named(const Expression& expression, std::string_view name) {
    return expression.kind == Expression::Kind::name && same_name(expression.text, name);
  }
  static bool names_state(const Expression& expression) {
    return is_named(expression, state_word) ||
           (!is_probe(expression) && std::any_of(expression.arguments.begin(), expression.arguments.end(), names_state));
  }
  static bool reads_signals(const Expression& expression) {
    return is_probe(expression) || is_named(expression, "time") ||
           std::any_of(expression.arguments.begin(), expression.arguments.end(), reads_signals);
  }

  [[nodiscard]] Expression number_of_state(const Expression& expression) const {
    if (states_.empty()) return in_state(expression, make::number(0.0));
    Expression sum = make::number(0.0);
    for (std::size_t k = 0; k < states_.size(); ++k) {
      Expression number = in_state(expression, make::value(states_[k]->items[1]));
      sum = make::operation(std::move(sum), "+", make::operation(std::move(number), "*", bit(state_bit(k)), span_), span_);
    }
    return sum;
  }

  static Expression in_state(Expression expression, const Expression& value) {
    if (is_named(expression, state_word)) return value;
    for (Expression& argument : expression.arguments) argument = in_state(std::move(argument), value);
    return expression;
  }

  const StateMachineText& text_;
  Definition& definition_;
  Definitions& definitions_;
  Reporter& reporter_;
  SourceSpan span_;
  std::string part_;
  std::vector<const Card*> states_;
  std::vector<Rule> rules_;
};

}  // namespace

void make_state_machines(Definitions& definitions, Reporter& reporter) {
  for (const auto& definition : definitions.all)
    for (std::size_t k = 0; k < definition->machines.size(); ++k)
      Machine(definition->machines[k], *definition, k + 1, definitions, reporter).make();
}

}  // namespace pwlsim::circuit
