#include "circuit/devices.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/part_numbers.hpp"
#include "netlist/load.hpp"

namespace pwlsim::circuit {
namespace {

using netlist::Card;
using netlist::Item;

constexpr std::string_view voltage_mark = "{V}";

/// Takes what stands before the next `mark` away from `rest`, without blanks around it.
std::string_view take(std::string_view& rest, char mark) {
  const std::size_t end = std::min(rest.find(mark), rest.size());
  std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  while (part.starts_with(' ')) part.remove_prefix(1);
  while (part.ends_with(' ')) part.remove_suffix(1);
  return part;
}

struct Row {
  std::string_view type, parameters, source;
};
struct Table {
  std::map<std::string, Row> names;
  std::map<std::string, Row> patterns;  ///< by what stands before the voltage
};

void add_row(Table& table, std::string_view line) {
  Row row;
  row.type = take(line, '|');
  if (row.type.empty() || row.type.front() == '#') return;
  std::string_view names = take(line, '|');
  row.parameters = take(line, '|');
  row.source = line;
  while (row.source.starts_with(' ')) row.source.remove_prefix(1);
  while (!names.empty()) {
    std::string_view name = take(names, ' ');
    const bool is_pattern = name.ends_with(voltage_mark);
    if (is_pattern) name.remove_suffix(voltage_mark.size());
    if (!name.empty()) (is_pattern ? table.patterns : table.names).emplace(without_case(name), row);
  }
}

const Table& table() {
  static const Table all = [] {
    Table result;
    for (std::string_view rest = device_table(); !rest.empty();) add_row(result, take(rest, '\n'));
    return result;
  }();
  return all;
}

/// The longest key of `rows` with which `name` begins and for which `fits` takes the rest; null where there is none.
template <class Fits>
const std::pair<const std::string, Row>* longest(const std::map<std::string, Row>& rows, const std::string& name, Fits fits) {
  for (std::size_t size = name.size(); size > 0; --size) {
    const auto found = rows.find(name.substr(0, size));
    if (found != rows.end() && fits(size)) return &*found;
  }
  return nullptr;
}

/// Letters of package, tape and grade behind a part's number. Short names stand for themselves alone.
bool is_suffix(std::string_view rest, std::size_t name_size) {
  constexpr std::size_t shortest_name = 5, longest_suffix = 8;
  return rest.empty() || (name_size >= shortest_name && rest.size() <= longest_suffix && !is_digit(rest.front()));
}

/// `5v1…`, `6.8…`, `12…`, `24v…`: the voltage in the spelling of a Zener diode's name, without what follows; empty where there is none.
std::string zener_voltage(std::string_view rest) {
  std::string text;
  std::size_t at = 0;
  while (at < rest.size() && is_digit(rest[at])) text += rest[at++];
  if (!text.empty() && at + 1 < rest.size() && (rest[at] == 'v' || rest[at] == '.' || rest[at] == '_') && is_digit(rest[at + 1])) {
    text += '.';
    for (++at; at < rest.size() && is_digit(rest[at]);) text += rest[at++];
  }
  constexpr double largest_voltage = 300.0;
  double voltage = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), voltage);
  return voltage > 0.0 && voltage <= largest_voltage ? text : "";
}

std::string with_voltage(std::string_view parameters, const std::string& voltage) {
  std::string text(parameters);
  const std::size_t at = text.find(voltage_mark);
  return at == std::string::npos ? text : text.replace(at, voltage_mark.size(), voltage);
}

std::optional<Device> named_device(const std::string& key) {
  const auto* named = longest(table().names, key, [&](std::size_t size) { return is_suffix(std::string_view(key).substr(size), size); });
  return named == nullptr ? std::nullopt
                          : std::optional(Device{named->second.type, std::string(named->second.parameters), named->second.source});
}

/// Families whose names have a letter of the package before the number of the die: MURB1620 is MUR1620, SPA20N60C3 is SPP20N60C3.
struct Family {
  std::string_view begin, packages;  ///< a blank: none
};
constexpr Family families[] = {{"mur", " bdfhs"}, {"mbr", " bdfgs"}, {"sp", "abdipuw"}, {"st", "bdfipw"}, {"fq", "abdip"}, {"fc", "abhp"}};

/// The same die in another package.
std::optional<Device> device_in_other_package(const std::string& key) {
  for (const Family& family : families) {
    const std::size_t at = family.begin.size();
    if (!key.starts_with(family.begin) || key.size() < at + 3) continue;
    const bool has_letter = !is_digit(key[at]);
    if (has_letter && (family.packages.find(key[at]) == std::string_view::npos || !is_digit(key[at + 1]))) continue;
    for (const char package : family.packages) {
      const std::string letter = package == ' ' ? "" : std::string(1, package);
      if (auto device = named_device(std::string(family.begin) + letter + key.substr(at + (has_letter ? 1 : 0)))) return device;
    }
  }
  return std::nullopt;
}

bool takes_type(char letter, std::string_view type) {
  switch (letter) {
    case 'd':
      return type == "D";
    case 'q':
      return type == "NPN" || type == "PNP";
    case 'j':
      return type == "NJF" || type == "PJF";
    default:
      return letter == 'm' && (type == "VDMOS" || type == "NMOS" || type == "PMOS");
  }
}

/// The part a card of this letter means: PSpice's libraries write the letter before the part, as in D1N4148, Q2N2222 and QBC548B.
std::optional<Device> device_of_card(char letter, std::string_view name) {
  const auto fits = [&](const std::optional<Device>& device) { return device && takes_type(letter, device->type); };
  if (auto device = find_device(name); fits(device)) return device;
  const bool is_prefixed = name.size() > 2 && lower_letter(name[0]) == letter;
  if (!is_prefixed) return std::nullopt;
  auto device = find_device(name.substr(1));
  return fits(device) ? device : std::nullopt;
}

bool is_defined(const Definition& from, const std::string& key) {
  for (const Definition* at = &from; at != nullptr; at = at->parent)
    if (at->models.contains(key)) return true;
  return false;
}

struct Wanted {
  std::string name;
  Device device;
};

/// Behind the nodes of a D, Q, M or J card; none where its model is defined.
std::optional<Wanted> wanted_by(const Definition& from, const Card& card) {
  const char letter = lower_letter(card.name.front());
  if (std::string_view("dqmj").find(letter) == std::string_view::npos) return std::nullopt;
  const std::size_t nodes = letter == 'd' ? 2 : 3;
  for (std::size_t at = nodes; at < card.items.size(); ++at) {
    const Item& item = card.items[at];
    if (item.kind != Item::Kind::word) continue;
    if (is_defined(from, without_case(item.text))) return std::nullopt;
    if (auto device = device_of_card(letter, item.text)) return Wanted{item.text, std::move(*device)};
  }
  return std::nullopt;
}

std::vector<Wanted> wanted_by(const Definitions& definitions) {
  std::vector<Wanted> list;
  std::set<std::string> keys;
  for (const auto& definition : definitions.all) {
    for (const Card* card : definition->elements) {
      std::optional<Wanted> wanted = wanted_by(*definition, *card);
      if (wanted && keys.insert(without_case(wanted->name)).second) list.push_back(std::move(*wanted));
    }
  }
  return list;
}

/// As SPICE has RS behind the breakdown voltage of a diode, too, Ron stands there where the table gives no Rrev.
std::string model_parameters(const Device& device) {
  constexpr std::string_view on = " Ron=";
  const std::string& text = device.parameters;
  const std::size_t at = text.find(on);
  if (device.type != "D" || at == std::string::npos || text.find("Vrev=") == std::string::npos || text.find("Rrev=") != std::string::npos)
    return text;
  const std::size_t begin = at + on.size();
  return text + " Rrev=" + text.substr(begin, text.find(' ', begin) - begin);
}

}  // namespace

std::optional<Device> find_device(std::string_view name) {
  const std::string key = without_case(name);
  if (auto device = named_device(key)) return device;
  const auto* pattern = longest(table().patterns, key, [&](std::size_t size) { return !zener_voltage(key.substr(size)).empty(); });
  if (pattern == nullptr) {
    auto device = device_in_other_package(key);
    return device ? device : read_part_number(key);
  }
  return Device{pattern->second.type, with_voltage(pattern->second.parameters, zener_voltage(key.substr(pattern->first.size()))),
                pattern->second.source};
}

std::vector<std::string> device_names() {
  std::vector<std::string> names;
  for (const auto& [key, row] : table().names) {
    names.push_back(key);
    std::transform(names.back().begin(), names.back().end(), names.back().begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  }
  return names;
}

DeviceModels add_device_models(Definitions& definitions, SourceStore& sources, Reporter& reporter) {
  DeviceModels models;
  const std::vector<Wanted> wanted = wanted_by(definitions);
  if (wanted.empty()) return models;
  std::string text = std::string(device_models_file) + "\n";
  for (const Wanted& one : wanted) text += fmt::format(".model {} {} {}\n", one.name, one.device.type, model_parameters(one.device));
  Diagnostics scratch;
  models.deck = netlist::parse(std::string(device_models_file), text, sources, scratch);
  reporter.forward(scratch);
  reporter.leave_out_notes_of(models.deck.title_span.file);
  Definition& top = *definitions.all.front();
  for (std::size_t at = 0; at < models.deck.cards.size() && at < wanted.size(); ++at) {
    const Card& card = models.deck.cards[at];
    top.models.emplace(without_case(wanted[at].name), &card);
    models.sources.emplace(
        &card, fmt::format("{} {} ({})", wanted[at].device.type, model_parameters(wanted[at].device), wanted[at].device.source));
  }
  return models;
}

}  // namespace pwlsim::circuit
