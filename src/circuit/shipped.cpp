#include "circuit/shipped.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/cards.hpp"
#include "circuit/census.hpp"
#include "circuit/logic_subcircuit.hpp"
#include "netlist/load.hpp"

namespace pwlsim::circuit {
namespace {

/// Other simulators' names of what is shipped under another.
struct Alias {
  std::string_view name, shipped;
};
constexpr Alias aliases[] = {
    {"level.1", "universalopamp1"}, {"level1", "universalopamp1"}, {"level.2", "universalopamp2"}, {"level2", "universalopamp2"}};

/// "" where there is none.
std::string text_of(std::string_view name) {
  const auto* alias = std::find_if(std::begin(aliases), std::end(aliases), [&](const Alias& a) { return same_name(a.name, name); });
  if (alias != std::end(aliases)) {
    std::string text = text_of(alias->shipped);
    return text.replace(text.find(alias->shipped), alias->shipped.size(), without_case(name));
  }
  const auto all = shipped_subcircuits();
  const auto found = std::find_if(all.begin(), all.end(), [&](const ShippedSubcircuit& s) { return same_name(s.name, name); });
  return found == all.end() ? logic_subcircuit(name) : std::string(found->text);
}

struct Called {
  std::string name, text;
  SourceSpan span;
};

/// Those that some card calls from where nothing of that name is seen, each once.
std::vector<Called> called_from(const Definitions& definitions) {
  std::vector<Called> list;
  for (const auto& definition : definitions.all) {
    for (const netlist::Card* card : definition->elements) {
      const netlist::Item* name = is_call(*card) ? called_subcircuit(*card) : nullptr;
      if (name == nullptr || find_subcircuit(*definition, name->text) != nullptr) continue;
      const auto is_same = [&](const Called& called) { return same_name(called.name, name->text); };
      if (std::any_of(list.begin(), list.end(), is_same)) continue;
      if (std::string text = text_of(name->text); !text.empty()) list.push_back({without_case(name->text), std::move(text), name->span});
    }
  }
  return list;
}

}  // namespace

std::vector<netlist::Deck> add_shipped_subcircuits(Definitions& definitions, SourceStore& sources, Reporter& reporter) {
  std::vector<netlist::Deck> decks;
  Definition& top = *definitions.all.front();
  for (const Called& called : called_from(definitions)) {
    if (called.text.find("universal operational amplifier") != std::string::npos)
      reporter.note(
          "N-universal-opamp", called.span,
          fmt::format(
              "{} is the shipped one: Avol, GBW, Vos and Rin count, at level 2 Slew and Rail too; Ilimit, phimargin and noise do not",
              called.name));
    Diagnostics scratch;
    const std::string name = fmt::format("pwlsim's {}.sub", called.name);
    decks.push_back(netlist::parse(name, fmt::format("{}\n{}", name, called.text), sources, scratch));
    reporter.forward(scratch);
    reporter.leave_out_notes_of(decks.back().title_span.file);
    Definitions own = read_definitions(decks.back(), reporter);
    for (const auto& [key, definition] : own.all.front()->subcircuits) top.subcircuits.emplace(key, definition);
    for (auto& definition : own.all) {
      if (definition->parent == own.all.front().get()) definition->parent = &top;
    }
    definitions.all.insert(definitions.all.end(), std::make_move_iterator(own.all.begin() + 1), std::make_move_iterator(own.all.end()));
  }
  return decks;
}

}  // namespace pwlsim::circuit
