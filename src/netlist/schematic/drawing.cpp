#include "netlist/schematic/drawing.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/names.hpp"
#include "netlist/schematic/words.hpp"

namespace pwlsim::netlist {

namespace {

/// How many ends meet at each place: a wire that goes on counts twice.
std::map<GridPoint, int> ends_at_places(const Sheet& sheet, const std::vector<Placed>& placed) {
  std::map<GridPoint, int> ends;
  for (const Wire& wire : sheet.wires) {
    ends[wire.from] += 1;
    ends[wire.to] += 1;
  }
  for (const Placed& element : placed)
    for (const GridPoint pin : element.pins()) ends[pin] += 1;
  for (auto& [point, count] : ends)
    for (const Wire& wire : sheet.wires)
      if (point != wire.from && point != wire.to && lies_on(point, wire)) count += 2;
  return ends;
}

/// What stands beside the symbol: its value, or the name of its model.
std::string shown_value(const Placed& placed) {
  if (!placed.block.empty()) return placed.block;
  for (const char* name : {"Value", "SpiceModel"})
    if (const std::string* own = placed.instance->attributes.find(name); own != nullptr && !own->empty()) return *own;
  return placed.letter() == 'a' ? "" : placed.attribute("Value");
}

class SheetDrawer {
 public:
  SheetDrawer(const Sheet& sheet, const std::vector<Placed>& placed, const Nets& nets) : sheet_(sheet), placed_(placed), nets_(nets) {}

  DrawnSheet draw() {
    for (const Wire& wire : sheet_.wires) drawn_.wires.push_back({wire, net_at(wire.from)});
    for (const Flag& flag : sheet_.flags) drawn_.labels.push_back({flag, net_at(flag.at)});
    for (const auto& [point, ends] : ends_at_places(sheet_, placed_))
      if (ends > 2) drawn_.dots.push_back(point);
    for (const Placed& element : placed_) drawn_.parts.push_back(part(element));
    for (const Directive& directive : sheet_.directives) {
      add_coupling(directive);
      add_globals(directive.text);
    }
    return std::move(drawn_);
  }

 private:
  int net_at(GridPoint point) {
    const std::string& name = nets_.name_at(point);
    const auto [known, is_new] = numbers_.emplace(without_case(name), static_cast<int>(drawn_.nets.size()));
    if (is_new) drawn_.nets.push_back(name);
    return known->second;
  }

  DrawnSheet::DrawnPart part(const Placed& placed) {
    const Instance& instance = *placed.instance;
    DrawnSheet::DrawnPart drawn;
    drawn.symbol = without_case(placed.symbol->name);
    drawn.name = placed.attribute("InstName");
    drawn.element = is_jumper(placed) ? "" : element_name(placed);
    drawn.value = shown_value(placed);
    drawn.block = placed.block;
    drawn.origin = instance.origin;
    drawn.orientation = instance.orientation;
    drawn.strokes = placed.symbol->strokes;
    for (const auto& pin : placed.symbol->pins) {
      if (!pin) continue;
      const GridPoint at = on_sheet(pin->at, instance.origin, instance.orientation);
      drawn.terminals.push_back({at, pin->shows_name ? pin->name : "", placed.letter() == 'a' && nets_.is_open(at) ? -1 : net_at(at)});
    }
    return drawn;
  }

  void add_coupling(const Directive& directive) {
    constexpr int line_height = 24;
    const std::string_view line = trimmed(directive.text);
    if (!line.empty() && lower_letter(line.front()) == 'k')
      drawn_.couplings.push_back({{directive.at.x, directive.at.y + line_height * directive.line}, std::string(line)});
  }

  void add_globals(std::string_view line) {
    if (!same_name(take_word(line), ".global")) return;
    for (std::string_view name = take_word(line); !name.empty(); name = take_word(line)) drawn_.globals.push_back(without_case(name));
  }

  const Sheet& sheet_;
  const std::vector<Placed>& placed_;
  const Nets& nets_;
  DrawnSheet drawn_;
  std::map<std::string, int> numbers_;  ///< of nets
};

class Places {
 public:
  explicit Places(const Drawing& drawing) : drawing_(drawing) {
    for (std::size_t k = 1; k < drawing.size(); ++k) sheets_.emplace(without_case(drawing[k].block), k);
    for (const DrawnSheet& sheet : drawing) globals_.insert(sheet.globals.begin(), sheet.globals.end());
  }

  std::vector<DrawnPlace> find() {
    if (!drawing_.empty()) add("", 0, {});
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const DrawnPlace place = places_[k];
      for (const DrawnSheet::DrawnPart& part : drawing_[place.sheet].parts)
        if (!part.block.empty()) add_call(place, part);
    }
    return std::move(places_);
  }

 private:
  using Ports = std::map<std::string, std::string>;  ///< nodes outside by nets inside

  static std::string inside(const std::string& path, const std::string& name) { return path.empty() ? name : path + '.' + name; }

  [[nodiscard]] bool is_global(const std::string& key) const { return key == "0" || key.starts_with("$g_") || globals_.contains(key); }

  void add(const std::string& path, std::size_t sheet, const Ports& ports) {
    if (places_.size() == most_drawn_places) return;
    DrawnPlace place{path, sheet, {}, {}};
    for (const std::string& net : drawing_[sheet].nets) {
      const auto port = ports.find(without_case(net));
      place.nodes.push_back(is_global(without_case(net)) ? net : port != ports.end() ? port->second : inside(path, net));
    }
    for (const DrawnSheet::DrawnPart& part : drawing_[sheet].parts)
      place.elements.push_back(part.element.empty() ? "" : inside(path, part.element));
    places_.push_back(std::move(place));
  }

  void add_call(const DrawnPlace& caller, const DrawnSheet::DrawnPart& part) {
    const auto called = sheets_.find(without_case(part.block));
    if (called == sheets_.end()) return;
    Ports ports;
    const std::vector<std::string>& names = drawing_[called->second].ports;
    for (std::size_t k = 0; k < std::min(names.size(), part.terminals.size()); ++k) {
      const int net = part.terminals[k].net;
      ports.emplace(without_case(names[k]), net < 0 ? "" : caller.nodes[static_cast<std::size_t>(net)]);
    }
    add(inside(caller.path, part.element), called->second, ports);
  }

  const Drawing& drawing_;
  std::map<std::string, std::size_t> sheets_;
  std::set<std::string> globals_;
  std::vector<DrawnPlace> places_;
};

}  // namespace

DrawnSheet draw_sheet(const Sheet& sheet, const std::vector<Placed>& placed, const Nets& nets) {
  return SheetDrawer(sheet, placed, nets).draw();
}

std::vector<DrawnPlace> places_of(const Drawing& drawing) { return Places(drawing).find(); }

}  // namespace pwlsim::netlist
