#pragma once
/// Symbols of LTspice's schematics: the places of their pins, and their default attributes.

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pwlsim::netlist {

/// A place on a sheet, or within a symbol; y grows downwards.
struct GridPoint {
  std::int32_t x = 0, y = 0;
  friend auto operator<=>(const GridPoint&, const GridPoint&) = default;
};

/// `SYMATTR` lines, the last of a name first.
class Attributes {
 public:
  void set(std::string_view name, std::string_view value);
  /// Null if there is none of that name.
  [[nodiscard]] const std::string* find(std::string_view name) const;

 private:
  std::vector<std::pair<std::string, std::string>> list_;
};

struct Pin {
  GridPoint at;
  std::string name;
  bool shows_name = false;  ///< the name is shown beside the pin
};

/// A line, rectangle, circle (in its box) or arc (of the circle in its box, counterclockwise from the ray to the third point to that to the fourth).
struct Stroke {
  enum class Kind { line, rectangle, circle, arc };
  Kind kind = Kind::line;
  std::vector<GridPoint> points;  ///< two, or four of an arc
};

struct Symbol {
  std::string name;                      ///< without folder
  std::string prefix;                    ///< begins with the letter of its elements; empty: a block that represents a schematic
  std::vector<std::optional<Pin>> pins;  ///< in the order of the netlist; empty for a place without a pin (LTspice's own devices)
  Attributes attributes;
  std::vector<Stroke> strokes;  ///< the drawing of its file; empty for LTspice's own symbols
};

/// The symbol of LTspice's library with that name, which may include its folder; null if there is none. Not case-sensitive.
[[nodiscard]] const Symbol* find_standard_symbol(std::string_view name);

/// For a symbol of LTspice's folders of amplifiers and comparators that is not in the table: five pins, as most single amplifiers have, and its name as the model. Empty for
/// other folders.
[[nodiscard]] std::optional<Symbol> guess_amplifier(std::string_view name);

/// All names of lib/ltspice.symbols.
[[nodiscard]] std::vector<std::string> standard_symbol_names();

/// A symbol from the text of its file, NAME.asy.
[[nodiscard]] Symbol read_symbol(std::string name, std::string_view text);

/// lib/ltspice.symbols.
[[nodiscard]] std::string_view standard_symbols();

/// The part after the last slash or backslash.
[[nodiscard]] std::string_view without_folder(std::string_view name);

}  // namespace pwlsim::netlist
