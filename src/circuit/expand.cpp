#include "circuit/expand.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/cards.hpp"
#include "circuit/census.hpp"
#include "circuit/evaluator.hpp"
#include "circuit/logic_device.hpp"
#include "circuit/logic_subcircuit.hpp"
#include "circuit/shipped.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = Item::Kind;

/// Of the subcircuits that logic_subcircuit writes.
constexpr std::string_view gate_output_ports[] = {"o6", "o7"};
constexpr std::string_view call_usage = "X<name> n1 n2 ... subcircuit [p=value ...]";
constexpr std::string_view condition_usage = ".ic v(node)=value i(inductor)=value";

}  // namespace

void Expander::expand(Place& place) {
  const std::vector<const Card*>& elements = place.scope.definition().elements;
  for (const std::string& part : place.scope.definition().hidden) circuit_.hidden.names.insert(without_case(place.prefix + part));
  const bool has_guards = std::any_of(elements.begin(), elements.end(), [](const Card* card) { return !card->guards.empty(); });
  std::unordered_map<std::string, const Card*> counted;
  for (const Card* card : elements) {
    if (reporter().full()) return;
    if (has_guards && !counts(place, *card, counted)) continue;
    is_call(*card) ? call(place, *card) : binder_.element(place, *card);
  }
  for (const Card* card : place.scope.definition().conditions) {
    for (const Item& item : card->items) condition(place, item);
  }
}

/// Whether its conditions hold here; a second of one name that counts is an error.
bool Expander::counts(Place& place, const Card& card, std::unordered_map<std::string, const Card*>& counted) {
  for (const netlist::Guard& guard : card.guards) {
    const std::optional<double> value = Evaluator(place.scope, 0).value(guard.condition);
    if (!value || (*value != 0.0) != guard.holds) return false;
  }
  const auto [entry, is_new] = counted.try_emplace(without_case(card.name), &card);
  if (!is_new)
    reporter().error("E-duplicate-element", card.name_span,
                     fmt::format("a second element {}; the first is at {}", card.name, reporter().where(entry->second->name_span)));
  return is_new;
}

void Expander::call(Place& place, const Card& card) {
  const Item* name = called_subcircuit(card);
  const Definition* called = name != nullptr ? find_subcircuit(place.scope.definition(), name->text) : nullptr;
  called != nullptr ? enter(place, card, *name, *called) : unknown_call(place, card, name);
}

/// Apart from call(), so that what recurses keeps a small frame.
void Expander::unknown_call(Place& place, const Card& card, const Item* name) {
  circuit_.has_gaps = true;
  if (name == nullptr) {
    if (!card.damaged)
      reporter().error("E-missing-value", card.span, fmt::format("{} calls no subcircuit; usage: {}", card.name, call_usage));
    return;
  }
  for (const Item* item : actual_nodes(card, *name)) (void)binder_.node(place, *item);
  if (card.damaged) return;
  std::vector<std::string> names = subcircuit_names(place.scope.definition());
  for (const ShippedSubcircuit& shipped : shipped_subcircuits()) names.emplace_back(shipped.name);
  reporter().error("E-unknown-subckt", name->span, fmt::format("unknown subcircuit '{}'{}", name->text, suggestion(name->text, names)));
}

std::vector<const Item*> Expander::actual_nodes(const Card& card, const Item& name) {
  std::vector<const Item*> nodes;
  for (const Item& item : card.items) {
    if (&item == &name) break;
    if (item.kind == ItemKind::word) {
      nodes.push_back(&item);
    } else {
      reporter().error("E-unexpected", item.span, fmt::format("unexpected '{}'; usage: {}", reporter().text(item.span), call_usage));
    }
  }
  return nodes;
}

void Expander::enter(Place& place, const Card& card, const Item& name, const Definition& called) {
  Scope scope(called, &place.scope.enclosing(*called.parent), session_);
  Place inner{scope, place.prefix + card.name + ".", {}, card.made_call};
  if (card.made_call) circuit_.hidden.names.insert(without_case(place.prefix + card.name));
  connect(place, card, name, inner);
  give_parameters(place, card, name, scope);
  scope.evaluate_all();
  expand(inner);
  if (card.made_call && has_two_levels(name.text)) note_gate_outputs(inner);
}

/// Those whose common is ground.
void Expander::note_gate_outputs(const Place& inner) {
  const auto common = inner.nodes.find("com");
  if (common == inner.nodes.end() || common->second != model::ground) return;
  const auto level = [&](std::string_view name) {
    return Evaluator(inner.scope, 0).value(netlist::Expression{netlist::Expression::Kind::name, 0.0, std::string(name), {}, {}});
  };
  for (const std::string_view port : gate_output_ports) {
    const auto node = inner.nodes.find(std::string(port));
    if (node == inner.nodes.end()) continue;
    const std::optional<double> low = level("vlow"), high = level("vhigh");
    if (low && high) circuit_.gate_outputs.push_back({node->second, *low, *high});
  }
}

void Expander::connect(Place& place, const Card& card, const Item& name, Place& inner) {
  const Definition& called = inner.scope.definition();
  const std::vector<const Item*> nodes = actual_nodes(card, name);
  if (nodes.size() != called.ports.size()) circuit_.has_gaps = true;
  if (nodes.size() != called.ports.size() && !card.damaged) {
    reporter().error("E-node-count", card.span,
                     fmt::format("{} gives {} nodes, but {} has {} ({})", card.name, nodes.size(), called.name, called.ports.size(),
                                 fmt::join(called.ports, " ")));
  }
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const model::NodeIndex node = binder_.node(place, *nodes[k]);
    if (k >= called.ports.size()) continue;
    if (called.ports[k] != ground_port)
      connect_port(inner, card, *nodes[k], called.ports[k], node);
    else if (node != model::ground)
      reporter().warning("W-ground-port", nodes[k]->span,
                         fmt::format("{} is not connected to {}: this port of {} is ground itself, the same node everywhere",
                                     nodes[k]->text, card.name, called.name));
  }
}

/// A port that stands twice in the subcircuit's list (`.subckt scr 1 2 3 2`) is one node, so a call gives it one.
void Expander::connect_port(Place& inner, const Card& card, const Item& word, const std::string& port, model::NodeIndex node) {
  const auto [known, is_new] = inner.nodes.emplace(port, node);
  if (is_new || known->second == node) return;
  reporter().error(
      "E-duplicate-port", word.span,
      fmt::format("{} gives {} a second node for the port {}, which occurs twice in its list; try the same node in both places", card.name,
                  inner.scope.definition().name, port));
}

void Expander::give_parameters(Place& place, const Card& card, const Item& name, Scope& inner) {
  const auto first = static_cast<std::size_t>(&name - card.items.data()) + 1;
  for (std::size_t k = first; k < card.items.size(); ++k) {
    const Item& item = card.items[k];
    if (item.kind == ItemKind::assignment) {
      give(place, card, item, inner);
    } else if (!same_name(item.text, "params:") && reporter().text(item.span) != "\"\"") {  // an empty value of a schematic's symbol
      reporter().error("E-unexpected", item.span, fmt::format("unexpected '{}'; usage: {}", reporter().text(item.span), call_usage));
    }
  }
}

/// A parameter that the subcircuit declares, or reads in some expression without declaring it, as in LTspice.
void Expander::give(Place& place, const Card& card, const Item& assignment, Scope& inner) {
  std::optional<Number> number;
  if (assignment.items.empty()) {
    reporter().error("E-missing-value", assignment.span, fmt::format("{} has no value", assignment.text));
  } else {
    number = place.scope.number(assignment.items[0], !card.made_call);
    if (number) place.scope.claim(*number);
  }
  if (card.made_call && number && number->value < 0.0 && must_not_be_negative(assignment.text))
    reporter().error("E-range", assignment.span,
                     fmt::format("{} of {} must not be negative, not {}", assignment.text, card.name, number->value));
  const Definition& called = inner.definition();
  if (declares(called, assignment.text)) {
    if (!assignment.items.empty())
      inner.give(assignment.text, number ? number->value : 0.0, number ? number->gradient : std::vector<double>());
  } else if (!reads(called, assignment.text)) {
    reporter().error("E-unknown-parameter", assignment.text_span,
                     fmt::format("the subcircuit {} has no parameter '{}'{}", called.name, assignment.text,
                                 suggestion(assignment.text, declared_parameters(called))));
  } else if (number) {
    inner.define(assignment.text, number->value, assignment.text_span, number->gradient);
  } else {
    inner.define_failed(assignment.text, assignment.text_span);
  }
  if (!assignment.items.empty()) inner.set_bare_femto(assignment.text, place.scope.bare_femto(assignment.items[0]));
}

std::string Expander::full_node_name(const Place& place, const std::string& name) const {
  if (place.prefix.empty() || is_ground_name(name)) return name;
  const std::string key = without_case(name);
  const auto known = place.nodes.find(key);
  if (known == place.nodes.end()) return binder_.is_global(key) ? name : place.prefix + name;
  return known->second == model::ground ? "0" : circuit_.nodes()[static_cast<std::size_t>(known->second)].name;
}

void Expander::condition(Place& place, const Item& item) {
  const bool shaped = item.kind == ItemKind::assignment && item.items.size() == 2 && item.items[1].items.size() == 1 &&
                      item.items[1].items[0].kind == ItemKind::word;
  const Item* quantity = shaped ? &item.items[1] : nullptr;
  const bool is_voltage = shaped && same_name(quantity->text, "v");
  const bool is_current = shaped && same_name(quantity->text, "i");
  if (!is_voltage && !is_current) {
    reporter().error("E-ic", item.span, fmt::format("unexpected '{}'; usage: {}", reporter().text(item.span), condition_usage));
    return;
  }
  const std::optional<Number> number = place.scope.number(item.items[0]);
  if (number) place.scope.claim(*number);
  const Item& word = quantity->items[0];
  const std::string name = is_voltage ? full_node_name(place, word.text) : place.prefix + word.text;
  circuit_.conditions.push_back(
      {is_current, name, number ? number->value : 0.0, word.span, number ? number->gradient : std::vector<double>()});
}

}  // namespace pwlsim::circuit
