#include "netlist/schematic/sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/names.hpp"
#include "netlist/schematic/words.hpp"

namespace pwlsim::netlist {

namespace {

std::optional<GridPoint> take_point(std::string_view& rest) {
  const auto x = read_coordinate(take_word(rest));
  const auto y = read_coordinate(take_word(rest));
  if (!x || !y) return std::nullopt;
  return GridPoint{*x, *y};
}

std::optional<Orientation> read_orientation(std::string_view word) {
  constexpr std::array<std::string_view, 4> turns{"0", "90", "180", "270"};
  if (word.empty() || (word.front() != 'R' && word.front() != 'M')) return std::nullopt;
  const auto turn = std::find(turns.begin(), turns.end(), word.substr(1));
  if (turn == turns.end()) return std::nullopt;
  return Orientation{word.front() == 'M', static_cast<int>(turn - turns.begin())};
}

/// A backslash is written twice; between folders it becomes a slash.
std::string symbol_name(std::string_view written) {
  std::string name;
  for (const char c : written) {
    const char here = c == '\\' ? '/' : c;
    if (here != '/' || !name.ends_with('/')) name.push_back(here);
  }
  return name;
}

std::string without_double_backslashes(std::string_view written) {
  std::string text;
  for (std::size_t at = 0; at < written.size(); ++at) {
    text.push_back(written[at]);
    if (written.substr(at, 2) == "\\\\") ++at;
  }
  return text;
}

/// What is drawn only, or of no meaning to a netlist.
bool is_decoration(std::string_view keyword) {
  constexpr std::array<std::string_view, 9> all{"SHEET", "WINDOW", "LINE", "RECTANGLE", "CIRCLE", "ARC", "DATAFLAG", "IOPIN", "BUSTAP"};
  return std::any_of(all.begin(), all.end(), [&](std::string_view known) { return same_name(known, keyword); });
}

class SheetReader {
 public:
  SheetReader(FileIndex file, const SourceStore& sources, Diagnostics& diagnostics) : text_(sources.text(file)), diagnostics_(diagnostics) {
    sheet_.file = file;
  }

  Sheet read() {
    std::string_view rest = text_;
    std::string_view first = trimmed(take_line(rest));
    if (!same_name(take_word(first), "Version")) {
      const std::string_view line = trimmed(text_.substr(0, text_.find('\n')));
      diagnostics_.error(
          "E-schematic", span(line.empty() ? text_.substr(0, 0) : line),
          "this is not an LTspice schematic: its first line is not 'Version 4'; try another file ending than .asc for a netlist");
      return std::move(sheet_);
    }
    while (!rest.empty()) read_line(trimmed(take_line(rest)));
    return std::move(sheet_);
  }

 private:
  [[nodiscard]] SourceSpan span(std::string_view part) const {
    const auto begin = static_cast<std::uint32_t>(part.data() - text_.data());
    return {sheet_.file, begin, begin + static_cast<std::uint32_t>(part.size())};
  }

  void read_line(std::string_view line) {
    if (line.empty()) return;
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    bool is_read = true;
    if (same_name(keyword, "WIRE")) {
      is_read = read_wire(rest);
    } else if (same_name(keyword, "FLAG")) {
      is_read = read_flag(rest);
    } else if (same_name(keyword, "SYMBOL")) {
      is_read = read_instance(rest);
    } else if (same_name(keyword, "SYMATTR")) {
      is_read = read_attribute(rest);
    } else if (same_name(keyword, "TEXT")) {
      is_read = read_text(rest);
    } else if (!is_decoration(keyword)) {
      diagnostics_.warning("W-schematic-line", span(keyword),
                           fmt::format("lines '{}' of a schematic are unknown and ignored; try drawing it differently", keyword));
    }
    if (!is_read)
      diagnostics_.error("E-schematic-line", span(line),
                         fmt::format("this line of the schematic is not a valid {}; try saving the schematic again in LTspice", keyword));
  }

  bool read_wire(std::string_view rest) {
    const auto from = take_point(rest);
    const auto to = take_point(rest);
    if (!from || !to) return false;
    sheet_.wires.push_back({*from, *to});
    return true;
  }

  bool read_flag(std::string_view rest) {
    const auto at = take_point(rest);
    rest = trimmed(rest);
    if (!at || rest.empty()) return false;
    sheet_.flags.push_back({*at, std::string(rest)});
    return true;
  }

  bool read_instance(std::string_view rest) {
    const auto orientation = read_orientation(take_last_word(rest));
    const auto y = read_coordinate(take_last_word(rest));
    const auto x = read_coordinate(take_last_word(rest));
    if (!orientation || !x || !y || rest.empty()) return false;
    sheet_.instances.push_back({symbol_name(rest), {*x, *y}, *orientation, {}, span(rest)});
    return true;
  }

  bool read_attribute(std::string_view rest) {
    const std::string_view name = take_word(rest);
    if (name.empty() || sheet_.instances.empty()) return false;
    sheet_.instances.back().attributes.set(name, without_double_backslashes(trimmed(rest)));
    return true;
  }

  /// `TEXT x y alignment size !directive`, or `;comment`. Older files leave the size out.
  bool read_text(std::string_view rest) {
    const auto at = take_point(rest);
    if (!at) return false;
    const std::size_t mark = rest.find_first_of("!;");
    if (mark == std::string_view::npos) return false;
    if (rest[mark] == '!') add_directive(rest.substr(mark + 1), *at);
    return true;
  }

  /// Its lines are parted by `\n`, and a backslash is written twice. LTspice writes `M§Q1` for the MQ1 of element_name.
  void add_directive(std::string_view written, GridPoint place) {
    int line = 0;
    const auto start = [&](std::size_t at) { sheet_.directives.push_back({{}, span(written.substr(at)).begin, place, line++}); };
    start(0);
    for (std::size_t at = 0; at < written.size(); ++at) {
      const std::string_view pair = written.substr(at, 2);
      if (pair == "\\n") {
        start(at += 2);
        --at;
        continue;
      }
      if (pair == "\xC2\xA7") {
        ++at;
        continue;
      }
      sheet_.directives.back().text.push_back(written[at]);
      if (pair == "\\\\") ++at;
    }
  }

  std::string_view text_;
  Diagnostics& diagnostics_;
  Sheet sheet_;
};

}  // namespace

GridPoint on_sheet(GridPoint of_symbol, GridPoint origin, Orientation orientation) {
  GridPoint point = of_symbol;
  for (int quarter = 0; quarter < orientation.quarters; ++quarter) point = {-point.y, point.x};
  if (orientation.is_mirrored) point.x = -point.x;
  return {origin.x + point.x, origin.y + point.y};
}

Sheet read_sheet(FileIndex file, const SourceStore& sources, Diagnostics& diagnostics) {
  return SheetReader(file, sources, diagnostics).read();
}

}  // namespace pwlsim::netlist
