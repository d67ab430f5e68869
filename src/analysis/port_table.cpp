#include "analysis/port_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/names.hpp"

namespace pwlsim::analysis {
namespace {

using model::Label;

constexpr std::size_t most_names = 8;  ///< listed where none is near

/// "D1#reverse" of "D1 (reverse)".
std::string spelled(const Label& label) {
  const std::string element = element_of(label);
  if (element.size() == label.name.size()) return element;
  return element + '#' + label.name.substr(element.size() + 2, label.name.size() - element.size() - 3);
}

bool same_form(const model::LinearForm& a, const model::LinearForm& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const model::Term& x, const model::Term& y) {
    return x.kind == y.kind && x.index == y.index && x.coefficient == y.coefficient;
  });
}

bool driven_together(const model::Switch& a, const model::Switch& b) {
  return a.label.name == b.label.name && a.on_level == b.on_level && a.off_level == b.off_level && same_form(a.control, b.control);
}

std::vector<SwitchGroup> groups_of(const std::vector<model::Switch>& switches) {
  std::vector<SwitchGroup> groups;
  for (std::size_t i = 0; i < switches.size(); ++i) {
    const auto found = std::find_if(groups.begin(), groups.end(), [&](const SwitchGroup& group) {
      return driven_together(switches[static_cast<std::size_t>(group.contacts.front())], switches[i]);
    });
    if (found == groups.end()) {
      groups.push_back({"", {static_cast<int>(i)}, switches[i].initially_on});
    } else {
      found->contacts.push_back(static_cast<int>(i));
    }
  }
  return groups;
}

std::vector<Label> labels_of(const model::Network& network) {
  std::vector<Label> labels;
  const auto add = [&labels](const auto& list) {
    for (const auto& item : list) labels.push_back(item.label);
  };
  add(network.branches);
  add(network.injections);
  add(network.resistors);
  add(network.capacitors);
  add(network.inductors);
  add(network.couplings);
  add(network.diodes);
  add(network.complementarities);
  add(network.switches);
  return labels;
}

bool holds(const std::vector<engine::IslandModel>& islands, const std::string& element) {
  return std::any_of(islands.begin(), islands.end(), [&](const engine::IslandModel& island) {
    const std::vector<std::string> names = element_names(island.island);
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) { return same_name(name, element); });
  });
}

}  // namespace

std::string element_of(const Label& label) { return label.name.substr(0, label.name.find(" (")); }

std::vector<std::string> element_names(const model::Island& island) {
  std::vector<Label> labels = labels_of(island.network);
  std::stable_sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) {
    return std::pair(a.span.file, a.span.begin) < std::pair(b.span.file, b.span.begin);
  });
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const Label& label : labels)
    if (std::string name = element_of(label); seen.insert(name).second) names.push_back(std::move(name));
  return names;
}

PortTable::PortTable(const engine::ExactModel& model) : model_(model) {
  for (std::size_t i = 0; i < model.islands.size(); ++i) add_island(model.islands[i], i);
  number_entries();
}

void PortTable::add_island(const engine::IslandModel& model, std::size_t index) {
  const model::Network& network = model.island.network;
  IslandPorts& island = islands_.emplace_back();
  std::size_t port = 0;
  const auto add = [&](const Label& label, bool is_switch, std::size_t number) {
    entries_.push_back({element_of(label), spelled(label), index, number, is_switch});
  };
  for (const auto& diode : network.diodes) add(diode.label, false, port++);
  for (const auto& complementarity : network.complementarities) add(complementarity.label, false, port++);
  island.switches = groups_of(network.switches);
  for (std::size_t group = 0; group < island.switches.size(); ++group)
    add(network.switches[static_cast<std::size_t>(island.switches[group].contacts.front())].label, true, group);
  island.names.resize(port + network.switches.size());
}

/// Names that several entries share get a number, and every port its name.
void PortTable::number_entries() {
  std::map<std::string, int> count, next;
  for (const Entry& entry : entries_) ++count[without_case(entry.name)];
  for (Entry& entry : entries_) {
    const std::string key = without_case(entry.name);
    if (count[key] > 1) entry.name += fmt::format("#{}", ++next[key]);
    IslandPorts& island = islands_[entry.island];
    if (!entry.is_switch) {
      island.names[entry.index] = entry.name;
      continue;
    }
    SwitchGroup& group = island.switches[entry.index];
    group.name = entry.name;
    const auto first_contact = island.names.size() - model_.islands[entry.island].island.network.switches.size();
    for (const int contact : group.contacts) island.names[first_contact + static_cast<std::size_t>(contact)] = entry.name;
  }
}

/// The port of that name, or all those of the element.
std::vector<const PortTable::Entry*> PortTable::find(const std::string& name) const {
  std::vector<const Entry*> found;
  for (const Entry& entry : entries_)
    if (same_name(entry.name, name)) return {&entry};
  for (const Entry& entry : entries_)
    if (same_name(entry.element, name)) found.push_back(&entry);
  return found;
}

std::string PortTable::complaint(const std::string& name) const {
  if (holds(model_.left_out, name) && !holds(model_.islands, name))
    return fmt::format("`--mode`: {} is left out, because no saved signal depends on it; try `.save` of a signal in its part", name);
  if (holds(model_.islands, name)) return fmt::format("`--mode`: {} has no modes; try a diode or a switch", name);
  std::vector<std::string> names;
  for (const Entry& entry : entries_) names.push_back(entry.name);
  if (names.empty()) return fmt::format("`--mode`: unknown element '{}': nothing here has modes; try it without `--mode`", name);
  const std::string near = nearest_name(name, names);
  if (!near.empty()) return fmt::format("`--mode`: unknown element '{}'; try '{}'", name, near);
  const bool many = names.size() > most_names;
  names.resize(std::min(names.size(), most_names));
  return fmt::format("`--mode`: unknown element '{}'; try one of {}{}", name, fmt::join(names, ", "), many ? ", …" : "");
}

std::optional<ModeChoice> PortTable::choose(const ModeRequest& request, Diagnostics& diagnostics) const {
  ModeChoice choice;
  for (const IslandPorts& island : islands_) {
    const std::size_t contacts = model_.islands[choice.islands.size()].island.network.switches.size();
    choice.islands.push_back({std::vector<char>(island.names.size() - contacts, 0), std::vector<char>(island.switches.size(), 0)});
  }
  const std::size_t errors_before = diagnostics.error_count();
  std::set<const Entry*> set;
  for (const auto& [name, on] : request) {
    const std::vector<const Entry*> found = find(name);
    if (found.empty()) diagnostics.error("E-mode", {}, complaint(name));
    for (const Entry* entry : found) {
      if (!set.insert(entry).second) diagnostics.error("E-mode", {}, fmt::format("`--mode` sets {} twice; try it once", entry->name));
      ModeChoice::OfIsland& island = choice.islands[entry->island];
      (entry->is_switch ? island.switches : island.ports)[entry->index] = on ? 1 : 0;
    }
  }
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return choice;
}

}  // namespace pwlsim::analysis
