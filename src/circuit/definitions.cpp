#include "circuit/definitions.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/cards.hpp"
#include "netlist/card_style.hpp"
#include "netlist/number.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;
using ItemKind = netlist::Item::Kind;

bool stands_in(const netlist::Expression& expression, std::string_view name) {
  return (expression.kind == netlist::Expression::Kind::name && same_name(expression.text, name)) ||
         std::any_of(expression.arguments.begin(), expression.arguments.end(),
                     [&](const auto& argument) { return stands_in(argument, name); });
}

/// As a name in an expression.
bool stands_in(const Item& item, std::string_view name) {
  return (item.expression && stands_in(*item.expression, name)) ||
         std::any_of(item.items.begin(), item.items.end(), [&](const Item& inner) { return stands_in(inner, name); });
}

constexpr std::string_view func_usage = ".func name(a,b) {expression}";
constexpr std::string_view subckt_usage = ".subckt name n1 n2 ... [params: p=value ...]";

/// The function's head is the first item of its card: f(a,b).
bool is_function_head(const Item& item) { return item.kind == ItemKind::group && !item.text.empty(); }

/// `U1 __U1`: how KiCad writes a symbol without a model for simulation.
bool is_placeholder(const Definition& definition, const Card& card) {
  if (card.items.empty() || card.items.back().kind != ItemKind::word) return false;
  const std::string_view last = card.items.back().text;
  if (!last.starts_with("__") || last.size() - 2 > card.name.size()) return false;
  const std::string_view reference = last.substr(2);
  return same_name(std::string_view(card.name).substr(card.name.size() - reference.size()), reference) &&
         !definition.models.contains(without_case(last));
}

class DefinitionReader {
 public:
  DefinitionReader(const netlist::Deck& deck, Reporter& reporter) : deck_(deck), reporter_(reporter) {}

  Definitions read() {
    open({}, deck_.title_span);
    result_.written_by_ltspice = deck_.names_ltspice_library;
    result_.misplaced_analysis = deck_.is_board;
    for (const Card& card : deck_.cards) card.name.front() == '.' ? read_dot_card(card) : read_element(card);
    while (stack_.size() > 1) {
      reporter_.error("E-missing-ends", current().definition->span, fmt::format(".subckt {} has no .ends", current().definition->name));
      stack_.pop_back();
    }
    check_machine();
    for (const auto& definition : result_.all) leave_out_placeholders(*definition);
    return std::move(result_);
  }

 private:
  struct Open {
    Definition* definition = nullptr;
    std::unordered_map<std::string, SourceSpan> element_spans;
    std::unordered_map<std::string, SourceSpan> subcircuit_spans;
    bool in_machine = false;  ///< the definition's last one is open
  };

  Open& current() { return stack_.back(); }
  Definition& here() { return *current().definition; }
  bool at_top() const { return stack_.size() == 1; }

  void open(std::string name, SourceSpan span) {
    auto definition = std::make_unique<Definition>();
    definition->name = std::move(name);
    definition->span = span;
    definition->parent = stack_.empty() ? nullptr : current().definition;
    stack_.push_back({definition.get(), {}, {}, false});
    result_.all.push_back(std::move(definition));
  }

  void read_element(const Card& card) {
    if (std::isalpha(static_cast<unsigned char>(card.name.front())) == 0) {
      if (!card.damaged)
        reporter_.error("E-unknown-card", card.name_span, fmt::format("{} is not an element: names begin with a letter", card.name));
      return;
    }
    if (!card.guards.empty()) return here().elements.push_back(&card);  // each call counts names itself
    const auto [entry, is_new] = current().element_spans.try_emplace(without_case(card.name), card.name_span);
    if (is_new) {
      here().elements.push_back(&card);
    } else {
      report_second("E-duplicate-element", "element", card.name, card.name_span, entry->second);
    }
  }

  void leave_out_placeholders(Definition& definition) {
    std::erase_if(definition.elements, [&](const Card* card) {
      if (!is_placeholder(definition, *card)) return false;
      reporter_.warning(
          "W-no-model", card->span,
          fmt::format("{} has no model for simulation and is left out; try the fields Sim.Device and Sim.Params of its symbol in KiCad",
                      card->name));
      return true;
    });
  }

  void report_second(std::string id, std::string_view what, std::string_view name, SourceSpan second, SourceSpan first) {
    reporter_.error(std::move(id), second, fmt::format("a second {} {}; the first is at {}", what, name, reporter_.where(first)));
    reporter_.note("N-first-here", first, fmt::format("the first {} is here", name));
  }

  void read_dot_card(const Card& card) {
    const CardKind* kind = find_card(card.name);
    kind == nullptr ? report_unknown(card) : read_known(card, *kind);
  }

  void report_unknown(const Card& card) {
    std::vector<std::string> names;
    for (const CardKind& kind : card_kinds()) names.emplace_back(kind.name);
    reporter_.error("E-unknown-card", card.name_span, fmt::format("unknown card '{}'{}", card.name, suggestion(card.name, names)));
  }

  void read_known(const Card& card, const CardKind& kind) {
    switch (kind.role) {
      case CardRole::subcircuit:
        return read_subcircuit(card);
      case CardRole::end_of_subcircuit:
        return read_ends(card);
      case CardRole::parameter:
        return read_parameters(card, card.items, here().parameters);
      case CardRole::function:
        return read_function(card);
      case CardRole::model:
        return read_model(card);
      case CardRole::global:
        return read_global(card);
      case CardRole::condition:
        here().conditions.push_back(&card);
        return;
      case CardRole::options:
        result_.options.push_back(&card);
        return;
      case CardRole::transient:
        return read_analysis(card, result_.transients);
      case CardRole::operating_point:
        return read_analysis(card, result_.operating_points);
      case CardRole::steady_state:
        return read_analysis(card, result_.steady_states);
      case CardRole::small_signal:
        return read_analysis(card, result_.small_signals);
      case CardRole::sensitivity:
        return read_analysis(card, result_.sensitivities);
      case CardRole::save:
        return read_save(card);
      case CardRole::print:
        return read_print(card);
      case CardRole::measurement:
        return read_analysis(card, result_.measurements);
      case CardRole::fourier:
        return read_analysis(card, result_.fourier_analyses);
      case CardRole::sweep:
        return read_analysis(card, result_.sweeps);
      case CardRole::machine:
      case CardRole::machine_part:
      case CardRole::end_of_machine:
        return read_machine(card, kind);
      case CardRole::raw_system:
        return read_analysis(card, result_.raw_systems);
      case CardRole::ignored:
        result_.prints |= same_name(kind.name, ".plot");
        if (netlist::is_analysis_name(kind.name.substr(1))) result_.other_analysis = kind.name;
        if (reporter_.first_time(kind.name)) {
          reporter_.warning("W-ignored-card", card.name_span, fmt::format("{} is ignored: {}", card.name, kind.text));
        }
        return;
      case CardRole::ltspice:
        result_.written_by_ltspice = true;
        return;
      case CardRole::section:
      case CardRole::silent:
        return;
    }
  }

  void read_analysis(const Card& card, std::vector<const Card*>& list) {
    if (!at_top()) {
      reporter_.error("E-misplaced", card.name_span, fmt::format("{} is not allowed inside .subckt {}", card.name, here().name));
      result_.misplaced_analysis = true;
      return;
    }
    list.push_back(&card);
  }

  /// LTspice keeps .save inside a library's subcircuit, for the schematic it was drawn with.
  void read_save(const Card& card) {
    if (at_top()) return result_.saves.push_back(&card);
    if (reporter_.first_time("save inside subcircuit")) {
      reporter_.warning(
          "W-ignored-card", card.name_span,
          fmt::format("{} inside .subckt {} is ignored; try it outside, with names like {}", card.name, here().name, "v(x1.node)"));
    }
  }

  void read_print(const Card& card) {
    result_.prints = true;
    const bool is_group = !card.items.empty() && card.items[0].kind == ItemKind::group;
    if (is_group || (!card.items.empty() && same_name(card.items[0].text, "tran"))) return read_save(card);
    if (!card.items.empty() && same_name(card.items[0].text, "ac")) return read_analysis(card, result_.response_prints);
    const std::string what = card.items.empty() ? "" : " " + card.items[0].text;
    reporter_.warning("W-ignored-card", card.name_span,
                      fmt::format("{}{} is ignored: only .print tran and .print ac name signals", card.name, what));
  }

  void read_subcircuit(const Card& card) {
    const bool named = !card.items.empty() && card.items[0].kind == ItemKind::word;
    if (!named && !card.damaged)
      reporter_.error("E-missing-value", card.span, fmt::format(".subckt needs a name; usage: {}", subckt_usage));
    const std::string name = named ? card.items[0].text : "";
    const SourceSpan span = named ? card.items[0].text_span : card.name_span;
    const auto [entry, is_new] = current().subcircuit_spans.try_emplace(without_case(name), span);
    if (!is_new) report_second("E-duplicate-subckt", "subcircuit", name, span, entry->second);
    Definition& outer = here();
    open(name, span);
    here().body = card.span;
    if (is_new) outer.subcircuits[without_case(name)] = &here();
    for (std::size_t k = 1; k < card.items.size(); ++k) read_formal(card.items[k]);
  }

  void read_formal(const Item& item) {
    if (item.kind == ItemKind::assignment) {
      here().formals.push_back({item.text, item.text_span, value_of(item)});
    } else if (item.kind != ItemKind::word) {
      reporter_.error("E-unexpected", item.span, fmt::format("a port is a name; usage: {}", subckt_usage));
    } else if (is_ground_name(item.text)) {
      here().ports.emplace_back(ground_port);
    } else if (!same_name(item.text, "params:")) {
      here().ports.push_back(without_case(item.text));
    }
  }

  const Item* value_of(const Item& assignment) {
    if (!assignment.items.empty()) return &assignment.items[0];
    reporter_.error("E-missing-value", assignment.span, fmt::format("{} has no value", assignment.text));
    return nullptr;
  }

  void read_ends(const Card& card) {
    if (at_top()) {
      reporter_.error("E-misplaced", card.name_span, ".ends without .subckt");
      return;
    }
    here().body.end = card.span.end;
    if (!card.items.empty() && !same_name(card.items[0].text, here().name)) {
      reporter_.error("E-ends-name", card.items[0].span, fmt::format(".ends {} ends .subckt {}", card.items[0].text, here().name));
    }
    check_machine();
    stack_.pop_back();
  }

  void read_parameters(const Card& card, const std::vector<Item>& items, std::vector<ParameterText>& list) {
    if (items.empty() && !card.damaged)
      reporter_.error("E-missing-value", card.span, ".param defines nothing; usage: .param name=value ...");
    for (std::size_t k = 0; k < items.size(); ++k) {
      const Item& item = items[k];
      if (item.kind == ItemKind::word && k + 1 < items.size() && items[k + 1].kind != ItemKind::assignment) {
        list.push_back({item.text, item.text_span, &items[++k]});  // .param K 0.7
      } else if (item.kind != ItemKind::assignment) {
        reporter_.error("E-unexpected", item.span, ".param takes name=value only");
      } else if (item.items.size() > 1) {
        reporter_.error("E-unexpected", item.text_span,
                        fmt::format("{} is not a parameter name; for a function use {}", item.text, func_usage));
      } else if (netlist::read_number(item.text).valid) {
        reporter_.error("E-unexpected", item.text_span,
                        fmt::format("{} is a number, not a parameter name; usage: .param name=value ...", item.text));
      } else {
        list.push_back({item.text, item.text_span, value_of(item)});
      }
    }
  }

  void read_function(const Card& card) {
    if (card.damaged) return;
    if (card.items.size() != 2 || !is_function_head(card.items[0])) {
      reporter_.error("E-function", card.span, fmt::format("a function needs a head and a body; usage: {}", func_usage));
      return;
    }
    const Item& head = card.items[0];
    FunctionText function{head.text, head.text_span, {}, &card.items[1]};
    for (const Item& formal : head.items) {
      if (formal.kind != ItemKind::word)
        reporter_.error("E-function", formal.span, fmt::format("an argument is a name; usage: {}", func_usage));
      function.formals.push_back(without_case(formal.text));
    }
    here().functions[without_case(head.text)] = std::move(function);
  }

  void read_model(const Card& card) {
    if (card.items.empty() || card.items[0].kind != ItemKind::word) {
      if (!card.damaged)
        reporter_.error("E-missing-value", card.span, ".model needs a name and a type; usage: .model name TYPE(p=value ...)");
      return;
    }
    const auto [entry, is_new] = here().models.try_emplace(without_case(card.items[0].text), &card);
    if (!is_new) settle_second_model(card, entry->second);
  }

  /// Two in one file that differ are a mistake; the deck's own model rules over one of a library, and the first of two libraries over the second.
  void settle_second_model(const Card& second, const Card*& kept) {
    const Card& first = *kept;
    const std::string& name = second.items[0].text;
    if (first.span.file == second.span.file) {
      if (reporter_.text(first.span) != reporter_.text(second.span))
        report_second("E-duplicate-model", "model", name, second.items[0].span, first.items[0].span);
      return;
    }
    if (second.span.file == deck_.title_span.file) kept = &second;
    const Card& other = kept == &second ? first : second;
    reporter_.warning("W-second-model", other.items[0].span,
                      fmt::format("this model {} is not used: the one at {} takes precedence", name, reporter_.where(kept->items[0].span)));
  }

  void read_machine(const Card& card, const CardKind& kind) {
    const bool begins = kind.role == CardRole::machine;
    if (begins == current().in_machine) {
      reporter_.error("E-misplaced", card.name_span, fmt::format("{} {} a state machine", card.name, begins ? "within" : "outside of"));
      return;
    }
    current().in_machine = kind.role != CardRole::end_of_machine;
    if (begins) {
      here().machines.push_back({&card, {}, {}, {}});
    } else if (kind.role == CardRole::machine_part) {
      StateMachineText& machine = here().machines.back();
      (kind.name == ".state" ? machine.states : kind.name == ".rule" ? machine.rules : machine.outputs).push_back(&card);
    }
  }

  /// At the end of a definition.
  void check_machine() {
    if (current().in_machine)
      reporter_.error("E-missing-ends", here().machines.back().begin->name_span,
                      fmt::format("{} has no .endmachine", here().machines.back().begin->name));
  }

  void read_global(const Card& card) {
    for (const Item& item : card.items) {
      if (item.kind == ItemKind::word) {
        result_.global_nodes.insert(without_case(item.text));
      } else {
        reporter_.error("E-unexpected", item.span, ".global takes node names only");
      }
    }
  }

  const netlist::Deck& deck_;
  Reporter& reporter_;
  Definitions result_;
  std::vector<Open> stack_;
};

}  // namespace

Definitions read_definitions(const netlist::Deck& deck, Reporter& reporter) { return DefinitionReader(deck, reporter).read(); }

netlist::Item made_word(std::string text, SourceSpan span) {
  netlist::Item item;
  item.text = std::move(text);
  item.span = item.text_span = span;
  return item;
}

const Definition* find_subcircuit(const Definition& from, std::string_view name) {
  const std::string key = without_case(name);
  for (const Definition* at = &from; at != nullptr; at = at->parent) {
    const auto found = at->subcircuits.find(key);
    if (found != at->subcircuits.end()) return found->second;
  }
  return nullptr;
}

std::vector<std::string> subcircuit_names(const Definition& from) {
  std::vector<std::string> names;
  for (const Definition* at = &from; at != nullptr; at = at->parent) {
    for (const auto& entry : at->subcircuits) names.push_back(entry.second->name);
  }
  return names;
}

std::vector<std::string> declared_parameters(const Definition& definition) {
  std::vector<std::string> names;
  for (const auto* list : {&definition.formals, &definition.parameters})
    for (const ParameterText& parameter : *list) names.push_back(parameter.name);
  return names;
}

bool declares(const Definition& definition, std::string_view parameter) {
  const auto is_it = [&](const ParameterText& text) { return same_name(text.name, parameter); };
  return std::any_of(definition.formals.begin(), definition.formals.end(), is_it) ||
         std::any_of(definition.parameters.begin(), definition.parameters.end(), is_it);
}

bool reads(const Definition& definition, std::string_view name) {
  const auto in_item = [&](const Item* item) { return item != nullptr && stands_in(*item, name); };
  const auto in_card = [&](const Card* card) {
    return card->damaged || std::any_of(card->items.begin(), card->items.end(), [&](const Item& item) { return stands_in(item, name); });
  };
  for (const auto* list : {&definition.formals, &definition.parameters})
    if (std::any_of(list->begin(), list->end(), [&](const ParameterText& text) { return in_item(text.value); })) return true;
  for (const auto* list : {&definition.elements, &definition.conditions})
    if (std::any_of(list->begin(), list->end(), in_card)) return true;
  return std::any_of(definition.functions.begin(), definition.functions.end(), [&](const auto& f) { return in_item(f.second.body); }) ||
         std::any_of(definition.models.begin(), definition.models.end(), [&](const auto& model) { return in_card(model.second); }) ||
         std::any_of(definition.subcircuits.begin(), definition.subcircuits.end(),
                     [&](const auto& inner) { return reads(*inner.second, name); });
}

}  // namespace pwlsim::circuit
