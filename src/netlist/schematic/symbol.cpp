#include "netlist/schematic/symbol.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "base/names.hpp"
#include "netlist/schematic/words.hpp"

namespace pwlsim::netlist {

namespace {

/// Takes what stands before the next `|` away from `rest`.
std::string_view take_field(std::string_view& rest) {
  const std::size_t end = rest.find('|');
  const std::string_view field = trimmed(rest.substr(0, end));
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return field;
}

std::vector<std::optional<Pin>> read_pins(std::string_view field) {
  std::vector<std::optional<Pin>> pins;
  for (std::string_view word = take_word(field); !word.empty(); word = take_word(field)) {
    const std::size_t comma = word.find(',');
    const auto x = read_coordinate(word.substr(0, comma));
    pins.emplace_back();
    if (x && comma != std::string_view::npos) pins.back() = Pin{{*x, read_coordinate(word.substr(comma + 1)).value_or(0)}, {}, false};
  }
  return pins;
}

void set_assigned(Attributes& attributes, std::string_view field) {
  const std::size_t equals = field.find('=');
  if (equals != std::string_view::npos) attributes.set(field.substr(0, equals), field.substr(equals + 1));
}

using Table = std::map<std::string, Symbol, std::less<>>;

void add_line(Table& table, std::string_view line) {
  std::string_view names = take_field(line);
  if (names.empty() || names.front() == '#') return;
  Symbol symbol;
  symbol.prefix = take_field(line);
  symbol.pins = read_pins(take_field(line));
  while (!line.empty()) set_assigned(symbol.attributes, take_field(line));
  for (std::string_view name = take_word(names); !name.empty(); name = take_word(names)) {
    symbol.name = name;
    table.insert_or_assign(without_case(name), symbol);
  }
}

const Table& table() {
  static const Table all = [] {
    Table result;
    for (std::string_view rest = standard_symbols(); !rest.empty();) add_line(result, take_line(rest));
    return result;
  }();
  return all;
}

/// Folders of LTspice's library: in others a name is somebody else's.
bool is_standard_folder(std::string_view folder) {
  constexpr std::array<std::string_view, 7> folders{
      "", "misc", "digital", "opamps", "comparators", "specialfunctions", "special functions"};
  return std::any_of(folders.begin(), folders.end(), [&](std::string_view known) { return same_name(known, folder); });
}

/// A pin of a symbol's file, while its lines are read.
struct NumberedPin {
  Pin pin;
  std::size_t order = 0;  ///< from 1
};

std::vector<std::optional<Pin>> in_order(std::vector<NumberedPin> list, bool has_places) {
  constexpr std::size_t most_places = 8;
  std::stable_sort(list.begin(), list.end(), [](const NumberedPin& a, const NumberedPin& b) { return a.order < b.order; });
  std::vector<std::optional<Pin>> pins;
  for (NumberedPin& numbered : list) {
    while (has_places && numbered.order <= most_places && pins.size() + 1 < numbered.order) pins.emplace_back();
    pins.emplace_back(std::move(numbered.pin));
  }
  return pins;
}

class SymbolReader {
 public:
  explicit SymbolReader(std::string name) { symbol_.name = std::move(name); }

  void read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (same_name(keyword, "PIN")) {
      const auto x = read_coordinate(take_word(line));
      const auto y = read_coordinate(take_word(line));
      const std::string_view side = take_word(line);
      if (x && y) pins_.push_back({{{*x, *y}, {}, !side.empty() && !same_name(side, "NONE")}, pins_.size() + 1});
    } else if (same_name(keyword, "PINATTR") && !pins_.empty()) {
      read_pin_attribute(line);
    } else if (same_name(keyword, "SYMATTR")) {
      const std::string_view name = take_word(line);
      symbol_.attributes.set(name, trimmed(line));
    } else {
      read_stroke(keyword, line);
    }
  }

  Symbol take() {
    if (const std::string* prefix = symbol_.attributes.find("Prefix")) symbol_.prefix = *prefix;
    symbol_.pins = in_order(std::move(pins_), !symbol_.prefix.empty() && lower_letter(symbol_.prefix.front()) == 'a');
    return std::move(symbol_);
  }

 private:
  /// `LINE Normal 16 0 16 28`, perhaps with a style behind the points.
  void read_stroke(std::string_view keyword, std::string_view line) {
    using Kind = Stroke::Kind;
    constexpr std::array<std::pair<std::string_view, Kind>, 4> kinds{
        {{"LINE", Kind::line}, {"RECTANGLE", Kind::rectangle}, {"CIRCLE", Kind::circle}, {"ARC", Kind::arc}}};
    const auto* const found = std::find_if(kinds.begin(), kinds.end(), [&](const auto& kind) { return same_name(kind.first, keyword); });
    if (found == kinds.end()) return;
    (void)take_word(line);  // the width of the pen
    Stroke stroke{found->second, {}};
    const std::size_t count = stroke.kind == Kind::arc ? 4 : 2;
    while (stroke.points.size() < count) {
      const auto x = read_coordinate(take_word(line));
      const auto y = read_coordinate(take_word(line));
      if (!x || !y) return;
      stroke.points.push_back({*x, *y});
    }
    symbol_.strokes.push_back(std::move(stroke));
  }

  void read_pin_attribute(std::string_view line) {
    const std::string_view name = take_word(line);
    if (same_name(name, "PinName")) {
      pins_.back().pin.name = trimmed(line);
    } else if (same_name(name, "SpiceOrder")) {
      const auto order = read_coordinate(trimmed(line));
      if (order && *order > 0) pins_.back().order = static_cast<std::size_t>(*order);
    }
  }

  Symbol symbol_;
  std::vector<NumberedPin> pins_;
};

}  // namespace

void Attributes::set(std::string_view name, std::string_view value) {
  if (value == "\"\"") value = {};  // how LTspice writes an empty value
  for (auto& [known, old] : list_) {
    if (same_name(known, name)) {
      old = value;
      return;
    }
  }
  list_.emplace_back(name, value);
}

const std::string* Attributes::find(std::string_view name) const {
  const auto found = std::find_if(list_.begin(), list_.end(), [&](const auto& attribute) { return same_name(attribute.first, name); });
  return found == list_.end() ? nullptr : &found->second;
}

std::string_view without_folder(std::string_view name) {
  const std::size_t last = name.find_last_of("/\\");
  return last == std::string_view::npos ? name : name.substr(last + 1);
}

const Symbol* find_standard_symbol(std::string_view name) {
  const std::string_view own = without_folder(name);
  std::string_view folder = name.substr(0, name.size() - own.size());
  while (!folder.empty() && (folder.back() == '/' || folder.back() == '\\')) folder.remove_suffix(1);
  const auto found = table().find(without_case(own));
  return found == table().end() || !is_standard_folder(folder) ? nullptr : &found->second;
}

std::optional<Symbol> guess_amplifier(std::string_view name) {
  const std::string_view own = without_folder(name);
  const std::string_view folder = name.substr(0, name.size() - own.size());
  if (!same_name(folder, "opamps/") && !same_name(folder, "comparators/")) return std::nullopt;
  Symbol symbol = *find_standard_symbol("opamp2");
  symbol.name = own;
  symbol.attributes.set("Value", own);
  return symbol;
}

std::vector<std::string> standard_symbol_names() {
  std::vector<std::string> names;
  for (const auto& [key, symbol] : table()) names.push_back(symbol.name);
  return names;
}

Symbol read_symbol(std::string name, std::string_view text) {
  SymbolReader reader(std::move(name));
  while (!text.empty()) reader.read_line(take_line(text));
  return reader.take();
}

}  // namespace pwlsim::netlist
