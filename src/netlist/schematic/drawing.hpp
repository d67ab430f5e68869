#pragma once
/// The data for a picture of a schematic: its wires, symbols and labels, and their nets.

#include <string>
#include <vector>

#include "netlist/schematic/element.hpp"

namespace pwlsim::netlist {

/// Numbers of nets count from 0 within a sheet.
struct DrawnSheet {
  struct Line {
    Wire wire;
    int net = 0;
  };
  struct Label {
    Flag flag;
    int net = 0;
  };
  struct Terminal {
    GridPoint at;
    std::string name;  ///< shown beside it; often empty
    int net = -1;      ///< -1: an open pin of one of LTspice's own devices
  };
  struct DrawnPart {
    std::string symbol;   ///< without its folder, in lower case
    std::string element;  ///< in the netlist: "MQ1" of the symbol Q1
    std::string name, value;
    std::string block;  ///< the sheet that it represents, or empty
    GridPoint origin;
    Orientation orientation;
    std::vector<Terminal> terminals;  ///< in the order of the netlist
    std::vector<Stroke> strokes;      ///< of its file, in its own coordinates
  };
  struct Text {
    GridPoint at;
    std::string text;
  };

  std::string block;               ///< its name; empty at the top
  std::vector<std::string> ports;  ///< of a block: names of its nets, in the order of the terminals of the part that calls it
  std::vector<std::string> nets;   ///< names, `0` is ground
  std::vector<Line> wires;
  std::vector<Label> labels;
  std::vector<GridPoint> dots;  ///< where three or more ends meet
  std::vector<DrawnPart> parts;
  std::vector<Text> couplings;       ///< K cards, one line each
  std::vector<std::string> globals;  ///< of `.global`: nets that have their name everywhere, without case
};

/// The schematic itself comes first.
using Drawing = std::vector<DrawnSheet>;

[[nodiscard]] DrawnSheet draw_sheet(const Sheet& sheet, const std::vector<Placed>& placed, const Nets& nets);

/// A sheet at one place of the hierarchy, with the names of the flat circuit: `X1.N001`, `X1.R1`.
struct DrawnPlace {
  std::string path;                   ///< "X1.X2"; empty at the top
  std::size_t sheet = 0;              ///< of the drawing
  std::vector<std::string> nodes;     ///< of its nets; empty where a port is connected to nothing
  std::vector<std::string> elements;  ///< of its parts
};
inline constexpr std::size_t most_drawn_places = 100;

/// The top first, then what it calls, in order; at most `most_drawn_places`.
[[nodiscard]] std::vector<DrawnPlace> places_of(const Drawing& drawing);

}  // namespace pwlsim::netlist
