#pragma once
/// The cards of a deck sorted by the subcircuit definition that contains them, before anything is evaluated.

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// A node at such a port is not connected: ground is the same node everywhere.
inline constexpr std::string_view ground_port = "0";

/// Keys are names without case.
using CardMap = std::unordered_map<std::string, const netlist::Card*>;

struct ParameterText {
  std::string name;  ///< as written
  SourceSpan span;
  const netlist::Item* value = nullptr;
};

struct FunctionText {
  std::string name;
  SourceSpan span;
  std::vector<std::string> formals;  ///< keys
  const netlist::Item* body = nullptr;
};

/// From .machine to .endmachine.
struct StateMachineText {
  const netlist::Card* begin = nullptr;
  std::vector<const netlist::Card*> states, rules, outputs;
};

struct Definition {
  std::string name;  ///< as written; "" for the deck itself
  SourceSpan span;
  SourceSpan body;                     ///< from .subckt to .ends; of the deck itself unknown
  const Definition* parent = nullptr;  ///< the definition that contains it
  std::vector<std::string> ports;      ///< keys; `ground_port` if ground itself is written
  std::vector<ParameterText> formals;  ///< `params:`
  std::vector<ParameterText> parameters;
  std::unordered_map<std::string, FunctionText> functions;
  CardMap models;
  std::unordered_map<std::string, const Definition*> subcircuits;
  std::vector<const netlist::Card*> elements;  ///< X cards too, in order
  std::vector<const netlist::Card*> conditions;
  std::vector<StateMachineText> machines;
  std::vector<std::string> hidden;  ///< parts of names that were made: `part.x` is not saved by default
};

/// Keeps pointers into the deck.
struct Definitions {
  std::vector<std::unique_ptr<Definition>> all;  ///< all[0] is the deck itself
  std::unordered_set<std::string> global_nodes;  ///< keys
  std::vector<const netlist::Card*> options, transients, steady_states, small_signals, sensitivities, response_prints, operating_points,
      saves, measurements, fourier_analyses, sweeps, raw_systems;
  std::deque<netlist::Card> made;   ///< in place of cards of the deck
  bool written_by_ltspice = false;  ///< by its cards `.backanno` or `.lib …standard.dio`
  bool misplaced_analysis = false;  ///< an analysis card is misplaced, or the file is not a deck: a missing analysis is not a further error
  std::string_view other_analysis;  ///< the last ignored card that requests an analysis, `.dc`, or none
  bool prints = false;              ///< has a card `.print` or `.plot`
};

/// Reports cards that are unknown, misplaced or not supported, two definitions of one name, and .subckt without .ends.
[[nodiscard]] Definitions read_definitions(const netlist::Deck& deck, Reporter& reporter);

/// A word of a generated card.
[[nodiscard]] netlist::Item made_word(std::string text, SourceSpan span);

/// Replaces element cards: `make(definition, card)` returns the new cards, or nothing if the card stays.
template <class Make>
void replace_elements(Definitions& definitions, const Make& make) {
  for (const auto& definition : definitions.all) {
    std::vector<const netlist::Card*> elements;
    for (const netlist::Card* card : definition->elements) {
      std::optional<std::vector<netlist::Card>> made = make(*definition, *card);
      if (!made) elements.push_back(card);
      for (std::size_t k = 0; made && k < made->size(); ++k) elements.push_back(&definitions.made.emplace_back(std::move((*made)[k])));
    }
    definition->elements = std::move(elements);
  }
}

/// The nearest definition of that name, seen from `from` outwards; null if there is none.
[[nodiscard]] const Definition* find_subcircuit(const Definition& from, std::string_view name);
[[nodiscard]] std::vector<std::string> subcircuit_names(const Definition& from);

/// A parameter after `params:` or on a .param card.
[[nodiscard]] bool declares(const Definition& definition, std::string_view parameter);
[[nodiscard]] std::vector<std::string> declared_parameters(const Definition& definition);
/// Whether some expression of the definition, or of one within it, contains that name; a damaged card may contain it.
[[nodiscard]] bool reads(const Definition& definition, std::string_view name);

}  // namespace pwlsim::circuit
