#pragma once
/// An LTspice schematic (NAME.asc) as it is drawn: wires, labels, symbols and the text of directives.

#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/source.hpp"
#include "netlist/schematic/symbol.hpp"

namespace pwlsim::netlist {

/// `R90`, `M180`, …: turned clockwise by quarters, then mirrored left to right where it begins with M.
struct Orientation {
  bool is_mirrored = false;
  int quarters = 0;
};
/// The place of a symbol's point on the sheet.
[[nodiscard]] GridPoint on_sheet(GridPoint of_symbol, GridPoint origin, Orientation orientation);

struct Wire {
  GridPoint from, to;
};

/// The name of a net; `0` is ground.
struct Flag {
  GridPoint at;
  std::string name;
};

struct Instance {
  std::string symbol;  ///< with its folder, separated by slashes
  GridPoint origin;
  Orientation orientation;
  Attributes attributes;
  SourceSpan span;  ///< of the symbol's name
};

/// One line of a directive.
struct Directive {
  std::string text;
  std::uint32_t offset = 0;  ///< where it begins in the schematic
  GridPoint at;              ///< of the text that contains the line
  int line = 0;              ///< number of the line in that text
};

struct Sheet {
  FileIndex file = no_file;
  std::vector<Wire> wires;
  std::vector<Flag> flags;
  std::vector<Instance> instances;
  std::vector<Directive> directives;
};

/// Reads a text of the store. Reports `E-schematic` if it is not a schematic, `E-schematic-line` for a line that cannot be read and
/// `W-schematic-line` for one of an unknown kind.
[[nodiscard]] Sheet read_sheet(FileIndex file, const SourceStore& sources, Diagnostics& diagnostics);

}  // namespace pwlsim::netlist
