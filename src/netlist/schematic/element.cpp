#include "netlist/schematic/element.hpp"

#include <algorithm>
#include <array>

#include "base/names.hpp"

namespace pwlsim::netlist {

namespace {

bool is_file_name(std::string_view text) {
  constexpr std::array<std::string_view, 6> endings{".lib", ".sub", ".mod", ".txt", ".cir", ".inc"};
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) {
    return text.size() > ending.size() && same_name(text.substr(text.size() - ending.size()), ending);
  });
}

/// Pins without a wire: LTspice's own devices tie them to their common.
std::string open_node(const Placed& placed, const Nets& nets) {
  constexpr std::size_t common = 8;
  const auto& pins = placed.symbol->pins;
  if (pins.size() < common || !pins[common - 1]) return "0";
  const GridPoint at = on_sheet(pins[common - 1]->at, placed.instance->origin, placed.instance->orientation);
  return nets.is_open(at) ? "0" : nets.name_at(at);
}

std::vector<std::string> nodes(const Placed& placed, const Nets& nets) {
  const bool is_device = placed.letter() == 'a';
  const std::string open = is_device ? open_node(placed, nets) : "";
  std::vector<std::string> names;
  for (const auto& pin : placed.symbol->pins) {
    const GridPoint at = pin ? on_sheet(pin->at, placed.instance->origin, placed.instance->orientation) : GridPoint{};
    names.push_back(!pin || (is_device && nets.is_open(at)) ? open : nets.name_at(at));
  }
  const bool has_polarity = placed.symbol->prefix.size() == 2 && names.size() == 3;
  if (has_polarity && placed.letter() == 'm') names.push_back(names.back());
  if (has_polarity && placed.letter() == 'q') names.emplace_back("0");
  return names;
}

void append(std::string& line, const std::string& word) {
  if (!word.empty()) line += ' ' + word;
}

/// The model's or subcircuit's name and what stands before the parameters.
void append_value(std::string& line, const Placed& placed) {
  const std::string model = placed.attribute("SpiceModel"), value = placed.attribute("Value"), value2 = placed.attribute("Value2");
  const bool is_call = placed.letter() == 'x';
  const bool names_file = is_call && is_file_name(model);
  const std::string name = names_file ? "" : model;
  append(line, name);
  const bool says_it_again = (names_file && !value2.empty()) || (is_call && !name.empty());
  if (!says_it_again) append(line, value);
  append(line, value2);
}

}  // namespace

char Placed::letter() const { return block.empty() && !symbol->prefix.empty() ? lower_letter(symbol->prefix.front()) : 'x'; }

std::vector<GridPoint> Placed::pins() const {
  std::vector<GridPoint> points;
  for (const auto& pin : symbol->pins)
    if (pin) points.push_back(on_sheet(pin->at, instance->origin, instance->orientation));
  return points;
}

std::string Placed::attribute(std::string_view name) const {
  const std::string* text = instance->attributes.find(name);
  if (text == nullptr) text = symbol->attributes.find(name);
  return text == nullptr ? "" : *text;
}

bool is_jumper(const Placed& placed) { return same_name(placed.symbol->name, "jumper") && placed.pins().size() == 2; }

std::string element_name(const Placed& placed) {
  std::string name = node_name(placed.attribute("InstName"));
  const char letter = placed.letter();
  if (!name.empty() && lower_letter(name.front()) == letter) return name;
  return static_cast<char>(letter - 'a' + 'A') + name;
}

std::string element_line(const Placed& placed, const Nets& nets) {
  std::string line = element_name(placed);
  for (const std::string& node : nodes(placed, nets)) append(line, node);
  if (placed.block.empty()) {
    append_value(line, placed);
  } else {
    append(line, placed.block);
  }
  for (const char* name : {"SpiceLine", "SpiceLine2"}) append(line, placed.attribute(name));
  return line;
}

std::string library_of(const Placed& placed) {
  std::string file = placed.attribute("ModelFile");
  if (file.empty() && placed.letter() == 'x' && is_file_name(placed.attribute("SpiceModel"))) file = placed.attribute("SpiceModel");
  return file;
}

}  // namespace pwlsim::netlist
