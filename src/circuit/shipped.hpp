#pragma once
/// The library shipped with the program: subcircuits that a deck calls without naming a file. They are text until a deck calls them.

#include <span>
#include <string_view>
#include <vector>

#include "circuit/definitions.hpp"
#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

struct ShippedSubcircuit {
  std::string_view name;
  std::string_view text;
};
/// In order of their names.
[[nodiscard]] std::span<const ShippedSubcircuit> shipped_subcircuits();
/// Whether the name of a source is that of a shipped subcircuit, as messages show it.
[[nodiscard]] bool is_shipped(std::string_view file);

/// Adds the shipped subcircuits that `definitions` call but do not have, as if they were at the end of the deck. Notes about their text
/// are dropped. The result holds their cards and must outlive `definitions`.
[[nodiscard]] std::vector<netlist::Deck> add_shipped_subcircuits(Definitions& definitions, SourceStore& sources, Reporter& reporter);

}  // namespace pwlsim::circuit
