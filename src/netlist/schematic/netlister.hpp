#pragma once
/// A schematic as the netlist that LTspice makes of it.

#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/source.hpp"
#include "netlist/schematic/drawing.hpp"

namespace pwlsim::netlist {

struct SchematicNetlist {
  std::string text;                   ///< with a title
  std::vector<SourceOrigin> origins;  ///< of its lines; those that LTspice adds have none
  std::vector<std::string> files;     ///< read besides the schematic
};

/// The schematic is a text of the store; symbols and blocks are looked up in `folder`. Elements come in their order on the sheet, then the blocks as
/// subcircuits, LTspice's own models and libraries for the kinds of elements that are there, and the directives. A symbol that is not found is
/// `E-schematic-symbol`, one without a name `E-schematic-name`; the others are written anyway. `drawing` receives
/// the data for a picture; null: not wanted.
[[nodiscard]] SchematicNetlist netlist_of(FileIndex schematic, const std::filesystem::path& folder, SourceStore& sources,
                                          Diagnostics& diagnostics, Drawing* drawing = nullptr);

}  // namespace pwlsim::netlist
