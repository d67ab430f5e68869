#pragma once
/// Converts one symbol of a sheet to a line of a netlist.

#include <string>
#include <vector>

#include "netlist/schematic/nets.hpp"

namespace pwlsim::netlist {

/// A symbol on the sheet.
struct Placed {
  const Instance* instance = nullptr;
  const Symbol* symbol = nullptr;
  std::string block;  ///< the subcircuit's name if it represents a schematic

  [[nodiscard]] char letter() const;  ///< of its elements, lower case
  /// The pins on the sheet.
  [[nodiscard]] std::vector<GridPoint> pins() const;
  /// The attribute of the element, else of the symbol; empty if neither has it.
  [[nodiscard]] std::string attribute(std::string_view name) const;
};

/// Whether it links two pins without being an element.
[[nodiscard]] bool is_jumper(const Placed& placed);

/// The name in the netlist: `Q1` on a symbol with the prefix M is MQ1.
[[nodiscard]] std::string element_name(const Placed& placed);

/// `R1 in out 10k`. After the nodes: SpiceModel, Value, Value2, SpiceLine, SpiceLine2.
[[nodiscard]] std::string element_line(const Placed& placed, const Nets& nets);

/// The file of models that the symbol names; empty if it names none.
[[nodiscard]] std::string library_of(const Placed& placed);

}  // namespace pwlsim::netlist
