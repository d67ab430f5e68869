#pragma once
/// One symbol of a sheet as a line of a netlist.

#include <string>
#include <vector>

#include "netlist/schematic/nets.hpp"

namespace pwlsim::netlist {

/// A symbol on the sheet.
struct Placed {
  const Instance* instance = nullptr;
  const Symbol* symbol = nullptr;
  std::string block;  ///< the subcircuit's name where it has a schematic of its own

  [[nodiscard]] char letter() const;  ///< of its elements, lower case
  /// The pins on the sheet.
  [[nodiscard]] std::vector<GridPoint> pins() const;
  /// Of the element, else of the symbol; empty where neither says anything.
  [[nodiscard]] std::string attribute(std::string_view name) const;
};

/// A link between two pins that is no element.
[[nodiscard]] bool is_jumper(const Placed& placed);

/// In the netlist: `Q1` on a symbol with the prefix M is MQ1.
[[nodiscard]] std::string element_name(const Placed& placed);

/// `R1 in out 10k`. What follows the nodes: SpiceModel, Value, Value2, SpiceLine, SpiceLine2.
[[nodiscard]] std::string element_line(const Placed& placed, const Nets& nets);

/// The file of models that the symbol asks for; empty where it asks for none.
[[nodiscard]] std::string library_of(const Placed& placed);

}  // namespace pwlsim::netlist
