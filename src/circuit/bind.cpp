#include "circuit/bind.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/bind_block.hpp"
#include "circuit/bind_source.hpp"
#include "circuit/card_cursor.hpp"
#include "circuit/cards.hpp"
#include "circuit/formula_reader.hpp"
#include "circuit/made_expressions.hpp"
#include "circuit/number_cure.hpp"
#include "circuit/polynomial.hpp"
#include "circuit/values.hpp"
#include "elements/catalogue.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using elements::ControlSyntax;
using elements::Instance;
using elements::Parameter;
using elements::Tail;
using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

/// Forms of E, F, G and H that take an expression or a table, and those that are no piecewise-linear circuit elements.
constexpr std::string_view voltage_forms[] = {"value", "vol", "v"};
constexpr std::string_view current_forms[] = {"value", "cur", "i"};
constexpr std::string_view foreign_forms[] = {"freq", "chebyshev"};
/// How LTspice computes what Laplace= says.
constexpr std::string_view laplace_options[] = {"window", "nfft", "mtol"};

/// One element card on its way to an instance. Each step reports its own errors; after one the rest of the card is left alone.
class CardBinding {
 public:
  CardBinding(Binder& binder, Place& place, const Card& card, Instance& instance)
      : binder_(binder), place_(place), card_(card), instance_(instance), kind_(*instance.kind), cursor_(card.items) {}

  void bind() {
    if (kind_.tail == Tail::block) {
      if (bind_block(binder_, place_, cursor_, card_, instance_)) rest();
      return;
    }
    if (!terminals()) return;
    if (kind_.tail == Tail::gain) {
      if (gain()) rest();
    } else if (kind_.tail == Tail::waveform) {
      if (bind_source(cursor_, place_.scope, reporter(), card_, instance_)) binder_.note_two_values(card_);
    } else if (kind_.tail == Tail::formula) {
      if (formula()) rest();
    } else if (control() && tail()) {
      rest();
    }
  }

  /// A resistor whose resistance is an expression of time or of signals: the current v/R.
  void bind_resistance(const netlist::Expression& resistance) {
    if (!terminals()) return;
    const netlist::Expression voltage = make::voltage_between(card_.items[0], card_.items[1], resistance.span);
    (void)FormulaReader(binder_, place_, instance_).read(make::operation(voltage, "/", resistance, resistance.span), true);
  }

  /// Of a card with a syntax error: its nodes as far as they go, so that they are known.
  void bind_damaged() {
    for (int k = 0; k < kind_.terminals && cursor_.at(ItemKind::word); ++k)
      instance_.nodes.push_back(binder_.node(place_, *cursor_.next()));
  }

 private:
  Reporter& reporter() { return binder_.reporter(); }

  bool missing(std::string id, std::string_view what) {
    reporter().error(std::move(id), card_.span, fmt::format("{} needs {}; usage: {}", card_.name, what, kind_.usage));
    binder_.leave_gap();
    return false;
  }

  bool unexpected(const Item& item) {
    reporter().error("E-unexpected", item.span, fmt::format("unexpected '{}'; usage: {}", reporter().text(item.span), kind_.usage));
    return false;
  }

  bool terminals() {
    for (int k = 0; k < kind_.terminals; ++k) {
      if (!cursor_.at(ItemKind::word)) {
        reporter().error("E-missing-node", card_.span,
                         fmt::format("{} needs {} nodes, {} given; usage: {}", card_.name, kind_.terminals, k, kind_.usage));
        return false;
      }
      instance_.nodes.push_back(binder_.node(place_, *cursor_.next()));
    }
    for (int k = 0; k < kind_.optional_terminals && at_optional_terminal(); ++k) {
      const bool is_terminal = has_optional_nodes(*cursor_.peek(1));
      const Item& node = *cursor_.next();
      if (is_terminal) instance_.nodes.push_back(binder_.node(place_, node));
    }
    return true;
  }

  bool has_optional_nodes(const Item& model) const {
    const elements::ModelKind* kind = binder_.models().kind_of(place_.scope, model);
    return kind == nullptr || kind->has_optional_nodes;
  }

  /// Two words are left, the second of which can be the model.
  bool at_optional_terminal() const {
    if (!cursor_.at(ItemKind::word) || !cursor_.at(ItemKind::word, 1)) return false;
    if (Models::known(place_.scope, *cursor_.peek(1))) return true;
    return !Models::known(place_.scope, *cursor_.peek()) && !same_name(cursor_.peek(1)->text, "off");
  }

  bool node_pair() {
    if (!cursor_.at(ItemKind::word) || !cursor_.at(ItemKind::word, 1)) return missing("E-missing-node", "a pair of controlling nodes");
    const model::NodeIndex p = binder_.node(place_, *cursor_.next());
    const model::NodeIndex n = binder_.node(place_, *cursor_.next());
    instance_.control_nodes.push_back({p, n});
    return true;
  }

  bool reference() {
    if (!cursor_.at(ItemKind::word)) return missing("E-missing-value", "a controlling element");
    const Item& name = *cursor_.next();
    instance_.references.push_back({place_.prefix + name.text, name.span, -1});
    return true;
  }

  bool control() {
    switch (kind_.control) {
      case ControlSyntax::none:
        return true;
      case ControlSyntax::node_pair:
        return node_pair();
      case ControlSyntax::element:
        return reference();
      case ControlSyntax::element_list:
        break;
    }
    const bool value_by_name = cursor_.peek(cursor_.positional_left()) != nullptr;
    const std::size_t behind = value_by_name ? 0 : 1;
    if (cursor_.positional_left() < 2 + behind) return missing("E-missing-value", "two inductors and a coefficient");
    while (cursor_.positional_left() > behind) {
      if (!reference()) return false;
    }
    return true;
  }

  bool tail() { return kind_.tail == Tail::model ? model() : value(); }

  bool value() {
    const Parameter& parameter = kind_.parameters[0];
    const std::optional<double> factor = model_value();
    const bool model_behind = !factor && at_model(1);
    if (const std::size_t most = model_behind ? 2 : 1; cursor_.positional_left() > most && !parallel_units(*cursor_.peek(most)))
      return too_many(*cursor_.peek(most - 1), *cursor_.peek(most));
    if (cursor_.at_positional()) {
      ValueReader(place_.scope, reporter(), card_.name).positional(*cursor_.next(), parameter, instance_.values);
      if (model_behind) (void)model_value();  // the value on the card rules
      if (factor && instance_.values.has(parameter.name))
        instance_.values.set(parameter.name, *factor * instance_.values.get(parameter.name), instance_.values.span(parameter.name));
      return true;
    }
    for (std::size_t k = 0; cursor_.peek(k) != nullptr; ++k) {
      const Item& item = *cursor_.peek(k);
      if (item.kind == ItemKind::assignment && (same_name(item.text, parameter.name) || is_refused(item))) return true;
    }
    if (factor) instance_.values.set(parameter.name, *factor);
    return factor.has_value() || missing("E-missing-value", "a value");
  }

  bool at_model(std::size_t k = 0) const {
    return !kind_.models.empty() && cursor_.at(ItemKind::word, k) && Models::known(place_.scope, *cursor_.peek(k));
  }

  /// What a model of R, C or L, where one comes next, has for the value.
  std::optional<double> model_value() {
    if (!at_model()) return std::nullopt;
    const int index = binder_.models().use(place_.scope, *cursor_.next(), kind_);
    return index < 0 ? 1.0 : binder_.models().at(index).values.get(kind_.parameters[0].name);
  }

  bool too_many(const Item& value, const Item& surplus) {
    const std::string nodes = kind_.terminals == 0 ? "" : fmt::format("{} nodes and ", kind_.terminals);
    reporter().error("E-node-count", surplus.span,
                     fmt::format("{} takes {}one value, and '{}' is one more; {}", card_.name, nodes, reporter().text(surplus.span),
                                 surplus_cure(value, surplus, reporter(), kind_.usage)));
    binder_.leave_gap();
    return false;
  }

  bool is_refused(const Item& item) const {
    const Parameter* parameter = elements::find_parameter(kind_.parameters, item.text);
    return parameter != nullptr && parameter->use == elements::Use::refused;
  }

  /// The last of the nodes is a model, and none follows.
  bool has_node_too_few() const {
    const Item* last = cursor_.previous();
    return last != nullptr && last->kind == ItemKind::word && Models::known(place_.scope, *last) &&
           (!cursor_.at(ItemKind::word) || at_flag());
  }

  bool model() {
    if (has_node_too_few()) {
      reporter().error(
          "E-node-count", card_.span,
          fmt::format("{} has one node too few before its model {}; usage: {}", card_.name, cursor_.previous()->text, kind_.usage));
      binder_.leave_gap();
      return false;
    }
    if (!cursor_.at(ItemKind::word)) return missing("E-missing-model", "a model");
    const Item& name = *cursor_.next();
    if (!Models::known(place_.scope, name) && cursor_.at(ItemKind::word) && Models::known(place_.scope, *cursor_.peek())) {
      reporter().error("E-node-count", card_.span,
                       fmt::format("{} has one node too many before its model; usage: {}", card_.name, kind_.usage));
      return false;
    }
    instance_.model = binder_.models().use(place_.scope, name, kind_);
    const Parameter* area = elements::find_parameter(kind_.parameters, "area");
    if (area != nullptr && cursor_.at_positional() && !cursor_.at(ItemKind::group) && !at_flag()) {
      const Item& item = *cursor_.next();
      if (place_.scope.number(item) && reporter().first_time("ignored:area")) {
        reporter().warning("W-ignored-parameter", item.span, "the area factor is ignored");
      }
    }
    if (at_flag()) flag(*cursor_.next());
    return true;
  }

  bool at_flag() const {
    return cursor_.at(ItemKind::word) && (same_name(cursor_.peek()->text, "on") || same_name(cursor_.peek()->text, "off"));
  }

  void flag(const Item& item) {
    if (kind_.takes_flag) {
      instance_.flag = same_name(item.text, "on");
    } else if (elements::find_parameter(kind_.parameters, item.text) == nullptr) {
      unexpected(item);
    } else if (reporter().first_time("ignored:" + without_case(item.text))) {
      reporter().warning("W-ignored-parameter", item.span, fmt::format("{} is ignored: the start is found without it", item.text));
    }
  }

  bool gain() {
    transfer_ = find_transfer();
    if (at_form()) return form();
    if (cursor_.at(ItemKind::group) && same_name(cursor_.peek()->text, "poly")) return polynomial();
    if (!control()) return false;
    if (at_table()) return table(nullptr);
    if (transfer_ != nullptr) return transfer(nullptr, gives_current());
    if (!cursor_.at_positional()) return missing("E-missing-value", "a gain");
    const std::optional<Number> number = place_.scope.number(*cursor_.next());
    instance_.coefficients = {0.0, number ? number->value : 0.0};
    return true;
  }

  /// value={…}, TABLE {…} …, V(…): a word is one only where no second word follows, for a node may bear that name.
  bool at_form() const {
    const Item* item = cursor_.peek();
    if (item == nullptr ||
        !(is_value_form(item->text) || same_name(item->text, "table") || is_laplace(*item) || is_one_of(foreign_forms, item->text)))
      return false;
    return item->kind == ItemKind::assignment || item->kind == ItemKind::group ||
           (item->kind == ItemKind::word && !cursor_.at(ItemKind::word, 1));
  }

  bool gives_current() const { return kind_.letter == 'G' || kind_.letter == 'F'; }
  bool is_value_form(std::string_view word) const {
    return gives_current() ? is_one_of(current_forms, word) : is_one_of(voltage_forms, word);
  }
  bool at_table() const { return cursor_.peek() != nullptr && same_name(cursor_.peek()->text, "table"); }

  bool form() {
    const Item& item = *cursor_.next();
    if (same_name(item.text, "table")) return table(&item);
    if (is_one_of(foreign_forms, item.text)) {
      reporter().error("E-not-supported", item.span,
                       fmt::format("{} with {} is not supported; usage: {}", card_.name, item.text, kind_.usage));
      return false;
    }
    if (is_laplace(item)) return transfer_of_expression(item);
    const Item* value = item.kind == ItemKind::assignment ? (item.items.empty() ? nullptr : &item.items[0]) : cursor_.next();
    return value != nullptr ? expression(*value, gives_current()) : missing("E-missing-value", "an expression");
  }

  bool expression(const Item& item, bool is_current) {
    const std::optional<netlist::Expression> value = expression_of(item);
    if (!value) return false;
    if (transfer_ != nullptr) return transfer(&*value, is_current);
    return FormulaReader(binder_, place_, instance_).read(*value, is_current);
  }

  std::optional<netlist::Expression> expression_of(const Item& item) {
    if (item.kind == ItemKind::expression) return *item.expression;
    const std::optional<Number> number = place_.scope.number(item);
    if (!number) return std::nullopt;
    return netlist::Expression{netlist::Expression::Kind::number, number->value, std::string(reporter().text(item.span)), {}, item.span};
  }

  static bool is_laplace(const Item& item) { return same_name(item.text, "laplace"); }

  /// Laplace= anywhere on the card.
  const Item* find_transfer() const {
    for (std::size_t k = 0; cursor_.peek(k) != nullptr; ++k)
      if (cursor_.peek(k)->kind == ItemKind::assignment && is_laplace(*cursor_.peek(k))) return cursor_.peek(k);
    return nullptr;
  }

  /// Of the value of the card, or of its control.
  bool transfer(const netlist::Expression* input, bool is_current) {
    read_transfer_ = transfer_;
    if (transfer_->items.empty()) return missing("E-missing-value", "a fraction in s");
    const std::optional<netlist::Expression> fraction = expression_of(transfer_->items[0]);
    return fraction && FormulaReader(binder_, place_, instance_).read_transfer(input, *fraction, is_current);
  }

  /// LAPLACE {V(in)} = {1/(1+s)}, with or without the equals sign.
  bool transfer_of_expression(const Item& head) {
    const bool is_assigned = head.kind == ItemKind::assignment && !head.items.empty();
    const Item* input = is_assigned ? &head.items[0] : cursor_.next();
    if (is_assigned && !cursor_.at(ItemKind::expression)) return missing("E-missing-node", "a pair of controlling nodes before Laplace=");
    const Item* fraction = cursor_.at(ItemKind::expression) ? cursor_.next() : nullptr;
    if (input == nullptr || fraction == nullptr) return missing("E-missing-value", "an expression and a fraction in s, each in braces");
    const std::optional<netlist::Expression> value = expression_of(*input);
    return value && FormulaReader(binder_, place_, instance_).read_transfer(&*value, *fraction->expression, gives_current());
  }

  /// V={…} or I={…} of B, in any place behind the nodes.
  bool formula() {
    const Item* given = nullptr;
    transfer_ = find_transfer();
    for (std::size_t k = 0; cursor_.peek(k) != nullptr; ++k) {
      const Item& item = *cursor_.peek(k);
      if (!is_b_value(item)) continue;
      if (given != nullptr) return unexpected(item);
      given = &item;
    }
    if (given == nullptr) return missing("E-missing-value", "V={expression} or I={expression}");
    return given->items.empty() ? missing("E-missing-value", "an expression") : expression(given->items[0], same_name(given->text, "i"));
  }

  bool is_b_value(const Item& item) const {
    return kind_.tail == Tail::formula && item.kind == ItemKind::assignment && (same_name(item.text, "v") || same_name(item.text, "i"));
  }

  /// TABLE {x} = (x1,y1) (x2,y2) … behind `head`; without one table=(…) behind a control.
  bool table(const Item* head) {
    const Item* x = nullptr;
    if (head != nullptr && head->kind != ItemKind::assignment) {
      x = cursor_.at(ItemKind::expression) ? cursor_.next() : nullptr;
      if (x == nullptr) return missing("E-missing-value", "an expression in braces after TABLE");
    } else if (head != nullptr && kind_.control != ControlSyntax::element && instance_.control_nodes.empty()) {
      return missing("E-missing-node", "a pair of controlling nodes before table=");
    } else if (head == nullptr) {
      head = cursor_.next();
    }
    std::vector<elements::Varied> numbers;
    for (const Item& item : head->items)
      if (!table_numbers(item, numbers)) return false;
    while (cursor_.at_positional())
      if (!table_numbers(*cursor_.next(), numbers)) return false;
    if (numbers.empty() || numbers.size() % 2 != 0) return missing("E-missing-value", "pairs of numbers in its table");
    std::vector<elements::TablePoint> points;
    for (std::size_t k = 0; k < numbers.size(); k += 2) points.push_back({numbers[k], numbers[k + 1]});
    if (!check_table(points, head->span, reporter())) return false;
    return FormulaReader(binder_, place_, instance_).read_table(x != nullptr ? x->expression.get() : nullptr, points, gives_current());
  }

  bool table_numbers(const Item& item, std::vector<elements::Varied>& numbers) {
    if (item.kind == ItemKind::group && item.text.empty())
      return std::all_of(item.items.begin(), item.items.end(), [&](const Item& inner) { return table_numbers(inner, numbers); });
    const std::optional<Number> number = place_.scope.number(item);
    if (number) numbers.emplace_back(number->value, number->gradient);
    if (number) place_.scope.claim(*number);
    return number.has_value();
  }

  bool polynomial() {
    const Item& head = *cursor_.next();
    const std::optional<Number> dimension = head.items.size() == 1 ? place_.scope.number(head.items[0]) : std::nullopt;
    if (!dimension || dimension->value < 1.0 || dimension->value != std::floor(dimension->value) || dimension->value > 1e6) {
      reporter().error("E-poly", head.span, fmt::format("POLY needs the number of controls, 1 or more; usage: {}", kind_.usage));
      return false;
    }
    const auto count = static_cast<std::size_t>(dimension->value);
    std::vector<netlist::Expression> controls;
    for (std::size_t k = 0; k < count; ++k) {
      const Item* first = cursor_.peek();
      if (!control()) return false;
      controls.push_back(kind_.control == ControlSyntax::element ? make::current_through(*first)
                                                                 : make::voltage_between(*first, *cursor_.previous(), first->span));
    }
    return coefficients(Polynomial(std::move(controls)), count);
  }

  bool coefficients(Polynomial polynomial, std::size_t controls) {
    if (!cursor_.at_positional()) return missing("E-missing-value", "a coefficient");
    while (cursor_.at_positional()) {
      const Item& item = *cursor_.next();
      const std::optional<Number> number = place_.scope.number(item);
      if (polynomial.take(number ? number->value : 0.0, item.span)) continue;
      reporter().error("E-poly", item.span,
                       fmt::format("this coefficient of {} is not linear: only p0 ... p{} may differ from zero", card_.name, controls));
      return false;
    }
    if (polynomial.has_products()) return polynomial_as_formula(polynomial);
    instance_.coefficients = polynomial.linear();
    if (controls == 1 && instance_.coefficients.size() == 1) {
      reporter().error(
          "E-poly", card_.span,
          fmt::format("a single coefficient of POLY(1) is p0 in some simulators and p1 in others; try both p0 and p1 on {}", card_.name));
      return false;
    }
    instance_.coefficients.resize(controls + 1, 0.0);
    return true;
  }

  /// With products of controls: as value={…}, which has a form where one factor takes two values.
  bool polynomial_as_formula(const Polynomial& polynomial) {
    instance_.control_nodes.clear();
    instance_.references.clear();
    return FormulaReader(binder_, place_, instance_).read(polynomial.expression(), gives_current());
  }

  void rest() {
    ValueReader reader(place_.scope, reporter(), card_.name);
    while (const Item* item = cursor_.next()) {
      if (is_b_value(*item) || item == read_transfer_) continue;
      if (read_transfer_ != nullptr && item->kind == ItemKind::assignment && is_one_of(laplace_options, item->text)) {
        if (reporter().first_time("ignored:" + without_case(item->text)))
          reporter().warning("W-ignored-parameter", item->span, fmt::format("{} is ignored: Laplace= is exact here", item->text));
        continue;
      }
      if (item->kind == ItemKind::assignment) {
        reader.assignment(*item, instance_.values);
        if (same_name(item->text, "tc")) skip_numbers();
      } else if (item->kind == ItemKind::word && at_known_flag(*item)) {
        flag(*item);
      } else if (const std::optional<double> units = parallel_units(*item)) {
        instance_.values.set("m", *units, item->span);
      } else {
        unexpected(*item);
      }
    }
  }

  /// `x4`, as LTspice writes m=4 behind the value of R, C and L.
  std::optional<double> parallel_units(const Item& item) const {
    const bool is_part = kind_.letter == 'R' || kind_.letter == 'C' || kind_.letter == 'L';
    if (!is_part || item.kind != ItemKind::word || lower_letter(item.text.front()) != 'x' || instance_.values.has("m")) return std::nullopt;
    const netlist::NumberText number = netlist::read_number(std::string_view(item.text).substr(1));
    return number.valid && number.value >= 1.0 && std::isfinite(number.value) ? std::optional(number.value) : std::nullopt;
  }

  /// The second of tc=a,b.
  void skip_numbers() {
    while (cursor_.at(ItemKind::word) && netlist::read_number(cursor_.peek()->text).valid) cursor_.next();
  }

  bool at_known_flag(const Item& item) const {
    return kind_.tail == Tail::model && (same_name(item.text, "on") || same_name(item.text, "off"));
  }

  Binder& binder_;
  Place& place_;
  const Card& card_;
  Instance& instance_;
  const elements::Kind& kind_;
  CardCursor cursor_;
  const Item* transfer_ = nullptr;       ///< Laplace=
  const Item* read_transfer_ = nullptr;  ///< that same, once it counts
};

/// Time, a voltage or a current.
bool reads_signals(const netlist::Expression& expression) {
  using Kind = netlist::Expression::Kind;
  const bool is_signal = expression.kind == Kind::call && (same_name(expression.text, "v") || same_name(expression.text, "i"));
  return is_signal || (expression.kind == Kind::name && same_name(expression.text, "time")) ||
         std::any_of(expression.arguments.begin(), expression.arguments.end(), reads_signals);
}

/// Of a resistor's card whose resistance changes; null: it is a number.
const netlist::Expression* changing_resistance(const Card& card) {
  if (card.damaged || lower_letter(card.name.front()) != 'r') return nullptr;
  for (const Item& item : card.items) {
    const bool is_assigned = item.kind == ItemKind::assignment && same_name(item.text, "r") && !item.items.empty();
    const Item& value = is_assigned ? item.items[0] : item;
    if (value.kind == ItemKind::expression && reads_signals(*value.expression)) return value.expression.get();
  }
  return nullptr;
}

}  // namespace

namespace {

/// A formula or a table read a varied parameter: nobody follows that.
void note_reads_apart(Session& session, Instance& instance) {
  for (std::size_t k = 0; k < session.read_apart.size(); ++k) {
    if (session.read_apart[k] == 0) continue;
    std::vector<double> gradient(k + 1, 0.0);
    gradient[k] = 1.0;
    instance.written.push_back({{}, 0.0, std::move(gradient)});
    session.read_apart[k] = 0;
  }
}

}  // namespace

void Binder::element(Place& place, const Card& card) {
  Instance instance;
  const netlist::Expression* resistance = changing_resistance(card);
  const std::size_t written = place.scope.session().written.size();
  instance.kind = elements::find_kind(resistance != nullptr ? 'B' : card.name.front());
  instance.name = place.prefix + card.name;
  instance.span = card.name_span;
  if (instance.kind == nullptr) {
    if (!card.damaged) refuse(card);
  } else {
    instance.values = elements::Values(instance.kind->parameters);
    CardBinding binding(*this, place, card, instance);
    if (resistance != nullptr)
      binding.bind_resistance(*resistance);
    else
      card.damaged ? binding.bind_damaged() : binding.bind();
  }
  instance.written = place.scope.take_written(written);
  note_reads_apart(place.scope.session(), instance);
  const std::size_t terminals = instance.kind != nullptr ? static_cast<std::size_t>(instance.kind->terminals) : 0;
  if (card.damaged || instance.kind == nullptr || instance.nodes.size() < terminals) circuit().has_gaps = true;
  circuit().instances.push_back(std::move(instance));
}

void Binder::refuse(const Card& card) {
  const RefusedElement* refused = find_refused_element(card.name.front());
  if (refused == nullptr) {
    reporter().error("E-unknown-card", card.name_span, fmt::format("{} is not a known element", card.name));
  } else {
    reporter().error("E-not-supported", card.name_span, fmt::format("{}: the element {} is not supported", card.name, refused->name));
  }
}

}  // namespace pwlsim::circuit
