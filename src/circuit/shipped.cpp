#include "circuit/shipped.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/cards.hpp"
#include "circuit/census.hpp"
#include "circuit/devices.hpp"
#include "circuit/logic_subcircuit.hpp"
#include "netlist/load.hpp"

namespace pwlsim::circuit {
namespace {

constexpr std::string_view file_begin = "pwlsim's ", file_end = ".sub";

/// Types in devices.txt that are subcircuits, and which.
struct Packaged {
  std::string_view type, subcircuit;
};
constexpr Packaged packaged_types[] = {{"OPAMP", "universalopamp2"}, {"COMPARATOR", "comparator"}, {"PUSHPULL", "comparator2"}};

/// Types of single parts, as a subcircuit that holds one: its ports and its card.
struct SinglePart {
  std::string_view type, ports, card, words;
};
constexpr SinglePart single_parts[] = {{"D", "a k", "D1 a k", "anode cathode"},
                                       {"VDMOS", "d g s", "M1 d g s", "drain gate source"},
                                       {"NPN", "c b e", "Q1 c b e", "collector base emitter"},
                                       {"PNP", "c b e", "Q1 c b e", "collector base emitter"}};

template <class Row>
const Row* find_type(std::span<const Row> rows, const std::optional<Device>& device) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return device && device->type == row.type; });
  return found == rows.end() ? nullptr : &*found;
}

const ShippedSubcircuit* find_shipped(std::string_view name) {
  const auto all = shipped_subcircuits();
  const auto found = std::find_if(all.begin(), all.end(), [&](const ShippedSubcircuit& s) { return same_name(s.name, name); });
  return found == all.end() ? nullptr : &*found;
}

/// The levels of LTspice's universal amplifier: `level.2`, `level2`, `level3a`, …; "" for other names.
std::string_view amplifier_level(std::string_view name) {
  constexpr std::string_view word = "level";
  if (!same_name(name.substr(0, word.size()), word)) return "";
  std::string_view level = name.substr(word.size());
  if (level.starts_with('.')) level.remove_prefix(1);
  if (level == "1") return "universalopamp1";
  return level == "2" || same_name(level, "3a") || same_name(level, "3b") ? "universalopamp2" : "";
}

/// The text under another name.
std::string renamed(const ShippedSubcircuit& shipped, std::string_view name) {
  std::string text(shipped.text);
  return text.replace(text.find(shipped.name), shipped.name.size(), name);
}

/// A shipped amplifier or comparator with the numbers of a common one; "" for other names.
std::string packaged(std::string_view name) {
  const std::optional<Device> device = find_device(name);
  const Packaged* type = find_type<Packaged>(packaged_types, device);
  const ShippedSubcircuit* shipped = type == nullptr ? nullptr : find_shipped(type->subcircuit);
  if (shipped == nullptr) return "";
  std::string text = renamed(*shipped, name);
  std::string_view rest = device->parameters;
  while (!rest.empty()) {
    const std::string_view assignment = rest.substr(0, rest.find(' '));
    rest.remove_prefix(std::min(assignment.size() + 1, rest.size()));
    const std::size_t at = text.find(' ' + std::string(assignment.substr(0, assignment.find('=') + 1))) + 1;
    text.replace(at, text.find_first_of(" \n", at) - at, assignment);
  }
  return text;
}

/// A subcircuit that holds one diode or transistor; "" for other names.
std::string single_part(std::string_view name) {
  const std::optional<Device> device = find_device(name);
  const SinglePart* part = find_type<SinglePart>(single_parts, device);
  if (part == nullptr) return "";
  return fmt::format(".subckt {} {}\n{} part\n.model part {}({})\n.ends\n", name, part->ports, part->card, part->type, device->parameters);
}

/// The timers of PSpice's libraries, which have a parameter of their own; "" for other names.
std::string timer_of_pspice(std::string_view name) {
  constexpr std::string_view names[] = {"555b", "555c", "555d"};
  const auto is_it = [&](std::string_view each) { return same_name(each, name); };
  if (std::none_of(std::begin(names), std::end(names), is_it)) return "";
  std::string text = renamed(*find_shipped("ne555"), name);
  text.insert(text.find('\n'), " params: maxfreq=3Meg");
  return text;
}

/// Of an amplifier whose output another one drives, too.
constexpr std::string_view shared_end = "~shared";

/// Such an amplifier: the output stage of the other, with a resistance and a limit to its current, which LTspice's have. "" for other names.
std::string with_shared_output(const std::string& text, std::string_view name, std::string_view amplifier) {
  constexpr std::string_view ideal = "E1 out 0 z 0 1\n", no_limit = "ilimit=inf";
  const std::size_t at = text.find(ideal);
  if (at == std::string::npos) return "";
  std::string shared = text;
  shared.replace(at, ideal.size(), "B1 0 out I={limit((V(z)-V(out))/10, -ilimit, ilimit)}\n");
  if (const std::size_t limit = shared.find(no_limit); limit != std::string::npos) shared.replace(limit, no_limit.size(), "ilimit=25m");
  return shared.replace(shared.find(amplifier), amplifier.size(), name);
}

/// "" where there is none.
std::string text_of(std::string_view name) {
  if (name.ends_with(shared_end)) {
    const std::string_view amplifier = name.substr(0, name.size() - shared_end.size());
    return with_shared_output(text_of(amplifier), name, amplifier);
  }
  const std::string_view level = amplifier_level(name);
  if (const ShippedSubcircuit* found = find_shipped(level.empty() ? name : level)) return renamed(*found, name);
  std::string text = packaged(name);
  if (text.empty()) text = timer_of_pspice(name);
  if (text.empty()) text = single_part(name);
  return text.empty() ? logic_subcircuit(name) : text;
}

/// It is not the deck's, and not called by the library's own names.
void tell_amplifier(const netlist::Item& name, Reporter& reporter) {
  if (!amplifier_level(name.text).empty())
    reporter.note(
        "N-universal-opamp", name.span,
        fmt::format(
            "{} is the shipped one: Avol, GBW, Vos and Rin are used, at level 2 Slew and Rail too; Ilimit, phimargin and noise are not",
            name.text));
  const std::string_view written =
      name.text.ends_with(shared_end) ? std::string_view(name.text).substr(0, name.text.size() - shared_end.size()) : name.text;
  const std::optional<Device> device = find_device(written);
  const SinglePart* part = find_type<SinglePart>(single_parts, device);
  if (part == nullptr && find_type<Packaged>(packaged_types, device) == nullptr) return;
  reporter.note("N-model-at-hand", name.span,
                fmt::format("{} is not defined, and is taken from the models at hand: {} ({}){}; try a .subckt for other numbers", written,
                            device->parameters, device->source, part != nullptr ? fmt::format(", with the nodes {}", part->words) : ""));
}

/// An amplifier of the library: in+ in- v+ v- out.
bool is_amplifier(std::string_view name) {
  const std::optional<Device> device = find_device(name);
  const Packaged* type = find_type<Packaged>(packaged_types, device);
  return !amplifier_level(name).empty() || (type != nullptr && type->subcircuit == "universalopamp2");
}

/// Two amplifiers whose outputs are one node (a window comparator) contradict each other if both are ideal sources.
void share_outputs(Definitions& definitions, Reporter& reporter) {
  constexpr std::size_t output = 4;
  for (const auto& definition : definitions.all) {
    std::map<std::string, std::vector<const netlist::Card**>> drivers;
    for (const netlist::Card*& card : definition->elements) {
      const netlist::Item* name = is_call(*card) && card->items.size() > output ? called_subcircuit(*card) : nullptr;
      if (name == nullptr || !is_amplifier(name->text) || find_subcircuit(*definition, name->text) != nullptr) continue;
      drivers[without_case(card->items[output].text)].push_back(&card);
    }
    for (auto& [node, cards] : drivers) {
      if (cards.size() < 2) continue;
      reporter.note("N-universal-opamp", (*cards[1])->name_span,
                    fmt::format("{} and {} drive one node: their outputs have 10 ohm and give Ilimit at most (25 mA if it is not given)",
                                (*cards[0])->name, (*cards[1])->name));
      for (const netlist::Card** card : cards) {
        netlist::Card shared = **card;
        for (netlist::Item& item : shared.items)
          if (item.span.begin == called_subcircuit(**card)->span.begin) item.text += shared_end;
        *card = &definitions.made.emplace_back(std::move(shared));
      }
    }
  }
}

struct Called {
  std::string name, text;
};

/// Those that some card calls from where nothing of that name is seen, each once.
std::vector<Called> called_from(const Definitions& definitions, Reporter& reporter) {
  std::vector<Called> list;
  for (const auto& definition : definitions.all) {
    for (const netlist::Card* card : definition->elements) {
      const netlist::Item* name = is_call(*card) ? called_subcircuit(*card) : nullptr;
      if (name == nullptr || find_subcircuit(*definition, name->text) != nullptr) continue;
      const auto is_same = [&](const Called& called) { return same_name(called.name, name->text); };
      if (std::any_of(list.begin(), list.end(), is_same)) continue;
      std::string text = text_of(name->text);
      if (text.empty()) continue;
      tell_amplifier(*name, reporter);
      list.push_back({without_case(name->text), std::move(text)});
    }
  }
  return list;
}

}  // namespace

bool is_shipped(std::string_view file) { return file.starts_with(file_begin) && file.ends_with(file_end); }

std::vector<netlist::Deck> add_shipped_subcircuits(Definitions& definitions, SourceStore& sources, Reporter& reporter) {
  std::vector<netlist::Deck> decks;
  Definition& top = *definitions.all.front();
  share_outputs(definitions, reporter);
  for (const Called& called : called_from(definitions, reporter)) {
    Diagnostics scratch;
    const std::string name = fmt::format("{}{}{}", file_begin, called.name, file_end);
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
