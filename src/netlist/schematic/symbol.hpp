#pragma once
/// Symbols of LTspice's schematics: where their pins lie, and what they give to elements that say nothing else.

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
  /// Null where there is none of that name.
  [[nodiscard]] const std::string* find(std::string_view name) const;

 private:
  std::vector<std::pair<std::string, std::string>> list_;
};

struct Pin {
  GridPoint at;
  std::string name;
  bool shows_name = false;  ///< beside the pin
};

/// A line, rectangle, circle (in its box) or arc (of the circle in its box, counterclockwise from the ray to the third point to that to the fourth).
struct Stroke {
  enum class Kind { line, rectangle, circle, arc };
  Kind kind = Kind::line;
  std::vector<GridPoint> points;  ///< two, or four of an arc
};

struct Symbol {
  std::string name;                      ///< without folder
  std::string prefix;                    ///< first the letter of its elements; empty: a block with a schematic of its own
  std::vector<std::optional<Pin>> pins;  ///< in the order of the netlist; none where a place has no pin (of LTspice's own devices)
  Attributes attributes;
  std::vector<Stroke> strokes;  ///< how its file draws it; none of LTspice's own
};

/// The symbol of LTspice's library with that name, which may have its folder before it; null where there is none. Letter case does not count.
[[nodiscard]] const Symbol* find_standard_symbol(std::string_view name);

/// A symbol of LTspice's folder of amplifiers that is not in the table, as most single ones are: five pins, and its name is that of its model. None for
/// other folders.
[[nodiscard]] std::optional<Symbol> guess_amplifier(std::string_view name);

/// All names of lib/ltspice.symbols.
[[nodiscard]] std::vector<std::string> standard_symbol_names();

/// A symbol from the text of its file, NAME.asy.
[[nodiscard]] Symbol read_symbol(std::string name, std::string_view text);

/// lib/ltspice.symbols.
[[nodiscard]] std::string_view standard_symbols();

/// What stands behind the last slash or backslash.
[[nodiscard]] std::string_view without_folder(std::string_view name);

}  // namespace pwlsim::netlist
