#include "cli/schematic_json.hpp"

#include <fmt/format.h>

#include <array>

#include "analysis/json.hpp"

namespace pwlsim::cli {
namespace {

using analysis::json_line;
using analysis::json_string;
using netlist::DrawnSheet;
using netlist::GridPoint;

template <class List, class Write>
std::string list_text(const List& list, const Write& write) {
  std::vector<std::string> members;
  for (const auto& item : list) members.push_back(write(item));
  return json_line(members);
}

std::string point_text(GridPoint point) { return fmt::format("[{}, {}]", point.x, point.y); }

std::string stroke_text(const netlist::Stroke& stroke) {
  constexpr std::array<const char*, 4> names{"line", "rectangle", "circle", "arc"};
  return json_line(
      {{"kind", json_string(names.at(static_cast<std::size_t>(stroke.kind)))}, {"points", list_text(stroke.points, point_text)}});
}

std::string terminal_text(const DrawnSheet::Terminal& terminal) {
  return fmt::format("[{}, {}, {}, {}]", terminal.at.x, terminal.at.y, terminal.net, json_string(terminal.name));
}

std::string part_text(const DrawnSheet::DrawnPart& part) {
  return json_line({{"symbol", json_string(part.symbol)},
                    {"element", json_string(part.element)},
                    {"name", json_string(part.name)},
                    {"value", json_string(part.value)},
                    {"block", json_string(part.block)},
                    {"at", point_text(part.origin)},
                    {"mirrored", analysis::json_truth(part.orientation.is_mirrored)},
                    {"quarters", std::to_string(part.orientation.quarters)},
                    {"terminals", list_text(part.terminals, terminal_text)},
                    {"strokes", list_text(part.strokes, stroke_text)}});
}

std::string sheet_text(const DrawnSheet& sheet) {
  const auto wire = [](const DrawnSheet::Line& line) {
    const auto& [from, to] = line.wire;
    return fmt::format("[{}, {}, {}, {}, {}]", from.x, from.y, to.x, to.y, line.net);
  };
  const auto label = [](const DrawnSheet::Label& drawn) {
    return fmt::format("[{}, {}, {}, {}]", drawn.flag.at.x, drawn.flag.at.y, drawn.net, json_string(drawn.flag.name));
  };
  const auto text = [](const DrawnSheet::Text& drawn) {
    return fmt::format("[{}, {}, {}]", drawn.at.x, drawn.at.y, json_string(drawn.text));
  };
  return json_line({{"nets", list_text(sheet.nets, json_string)},
                    {"wires", list_text(sheet.wires, wire)},
                    {"labels", list_text(sheet.labels, label)},
                    {"dots", list_text(sheet.dots, point_text)},
                    {"parts", list_text(sheet.parts, part_text)},
                    {"couplings", list_text(sheet.couplings, text)}});
}

std::string place_text(const netlist::DrawnPlace& place) {
  return json_line({{"path", json_string(place.path)},
                    {"sheet", std::to_string(place.sheet)},
                    {"nodes", list_text(place.nodes, json_string)},
                    {"elements", list_text(place.elements, json_string)}});
}

}  // namespace

std::string schematic_json(const netlist::Drawing& drawing, const std::vector<netlist::DrawnPlace>& places) {
  if (drawing.empty()) return "";
  return json_line({{"sheets", list_text(drawing, sheet_text)}, {"places", list_text(places, place_text)}});
}

}  // namespace pwlsim::cli
