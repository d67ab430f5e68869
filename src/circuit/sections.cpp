#include "circuit/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "base/names.hpp"
#include "circuit/cards.hpp"
#include "circuit/commands.hpp"
#include "circuit/definitions.hpp"
#include "circuit/evaluation.hpp"
#include "circuit/evaluator.hpp"
#include "circuit/guarded_cards.hpp"
#include "circuit/scope.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;

bool is_card(const Card& card, CardRole role) {
  const CardKind* kind = card.name.front() == '.' ? find_card(card.name) : nullptr;
  return kind != nullptr && kind->role == role;
}

bool is_named(const Card& card, std::string_view name) { return same_name(card.name, name); }

/// One `.if` that is open.
struct Open {
  const Card* begin = nullptr;
  bool is_taken = false;                 ///< of the section we are in
  bool was_taken = false;                ///< of one before it, or of this
  bool is_last = false;                  ///< behind `.else`
  bool is_guarded = false;               ///< within a subcircuit
  std::vector<netlist::Guard> guards{};  ///< of the section we are in
};

class Chooser {
 public:
  Chooser(const netlist::Deck& deck, std::size_t run, Reporter& reporter) : deck_(deck), run_(run), reporter_(reporter) {
    result_.title = deck.title;
    result_.title_span = deck.title_span;
    result_.names_ltspice_library = deck.names_ltspice_library;
    note_common_cards();
  }

  netlist::Deck choose() {
    for (const Card& card : deck_.cards) {
      if (is_card(card, CardRole::section)) {
        section(card);
      } else if (is_taken()) {
        add(card);
      }
    }
    for (const Open& open : open_) reporter_.error("E-missing-ends", open.begin->name_span, ".if has no .endif");
    result_.cards = with_decided_definitions(std::move(result_.cards));
    return std::move(result_);
  }

 private:
  /// What conditions may read: the parameters, functions and steps of the deck that stand in no section.
  void note_common_cards() {
    int depth = 0, subcircuits = 0;
    for (const Card& card : deck_.cards) {
      if (is_named(card, ".if")) ++depth;
      if (is_named(card, ".endif")) --depth;
      subcircuits += is_card(card, CardRole::subcircuit) ? 1 : is_card(card, CardRole::end_of_subcircuit) ? -1 : 0;
      if (depth == 0 && subcircuits == 0 && is_read_by_conditions(card)) known_.cards.push_back(card);
    }
  }

  static bool is_read_by_conditions(const Card& card) {
    return is_card(card, CardRole::parameter) || is_card(card, CardRole::function) || is_card(card, CardRole::sweep);
  }

  [[nodiscard]] bool is_taken() const {
    return std::all_of(open_.begin(), open_.end(), [](const Open& open) { return open.is_taken; });
  }

  void section(const Card& card) {
    if (is_named(card, ".if")) {
      Open open{&card};
      open.is_guarded = subcircuits_ > 0;
      open_.push_back(std::move(open));
      return enter(card, true);
    }
    if (open_.empty()) return reporter_.error("E-misplaced", card.name_span, fmt::format("{} without .if", card.name));
    const bool has_condition = is_named(card, ".elseif");
    if (!has_condition && !card.items.empty())
      reporter_.error("E-misplaced", card.items.front().span,
                      fmt::format("nothing may follow {}{}", card.name, is_named(card, ".else") ? "; try .elseif (a == 1)" : ""));
    if (is_named(card, ".endif")) return open_.pop_back();
    if (open_.back().is_last) return reporter_.error("E-misplaced", card.name_span, fmt::format("{} after .else", card.name));
    open_.back().is_last = !has_condition;
    enter(card, has_condition);
  }

  /// The section that begins with this card.
  void enter(const Card& card, bool has_condition) {
    Open& open = open_.back();
    const netlist::Item* condition = has_condition && !card.items.empty() ? &card.items.front() : nullptr;
    if (has_condition && condition == nullptr && !card.damaged)
      reporter_.error("E-missing-value", card.span, fmt::format("{0} needs a condition; usage: {0} (a == 1)", card.name));
    if (open.is_guarded) return guard(open, condition);
    open.is_taken = false;
    const bool is_read = !open.was_taken && is_outer_taken();
    open.is_taken = is_read && (has_condition ? condition != nullptr && holds(*condition) : true);
    open.was_taken |= open.is_taken;
  }

  [[nodiscard]] bool is_outer_taken() const {
    return std::all_of(open_.begin(), open_.end() - 1, [](const Open& open) { return open.is_taken; });
  }

  /// The sections before it did not count, and this one's condition holds.
  static void guard(Open& open, const netlist::Item* condition) {
    open.is_taken = true;
    if (!open.guards.empty()) open.guards.back().holds = false;
    if (condition != nullptr) open.guards.push_back({*condition, true});
  }

  bool holds(const netlist::Item& condition) {
    Diagnostics unheard;
    Reporter scratch = reporter_.beside(unheard);
    const Definitions definitions = read_definitions(known_, scratch);
    const ExpressionEvaluation evaluation;
    Session session(reporter_, evaluation);
    Scope scope(*definitions.all.front(), nullptr, session);
    Sweeps sweeps;
    read_sweeps(definitions, scope, scratch, sweeps);
    give_stepped_parameters(sweeps, run_, scope);
    return Evaluator(scope, 0).value(condition).value_or(0.0) != 0.0;
  }

  void add(const Card& card) {
    subcircuits_ += is_card(card, CardRole::subcircuit) ? 1 : is_card(card, CardRole::end_of_subcircuit) ? -1 : 0;
    result_.cards.push_back(card);
    if (subcircuits_ == 0 && !open_.empty() && is_read_by_conditions(card)) known_.cards.push_back(card);
    for (const Open& open : open_) {
      if (!open.is_guarded) continue;
      const bool is_element = std::isalpha(static_cast<unsigned char>(card.name.front())) != 0;
      if (!is_element && !is_card(card, CardRole::parameter) && !is_card(card, CardRole::model))
        return reporter_.error(
            "E-not-supported", card.name_span,
            fmt::format("{} in a section of .if within a subcircuit: such sections hold elements, .param and .model; try "
                        "a section around the subcircuit",
                        card.name));
      std::vector<netlist::Guard>& guards = result_.cards.back().guards;
      guards.insert(guards.end(), open.guards.begin(), open.guards.end());
    }
  }

  const netlist::Deck& deck_;
  std::size_t run_;
  Reporter& reporter_;
  netlist::Deck known_, result_;
  std::vector<Open> open_;
  int subcircuits_ = 0;  ///< that are open
};

}  // namespace

std::optional<netlist::Deck> with_chosen_sections(const netlist::Deck& deck, std::size_t run, Reporter& reporter) {
  const bool has_sections =
      std::any_of(deck.cards.begin(), deck.cards.end(), [](const Card& card) { return is_card(card, CardRole::section); });
  if (!has_sections) return std::nullopt;
  return Chooser(deck, run, reporter).choose();
}

}  // namespace pwlsim::circuit
