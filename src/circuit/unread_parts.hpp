#pragma once
/// Parts of a circuit for display only: a source of V(a)*I(b) with a resistor and a capacitor at its output, which no other element, card or measurement reads.

#include <string>
#include <vector>

#include "circuit/circuit.hpp"

namespace pwlsim::circuit {

/// The parts left out with one source.
struct UnreadPart {
  int source = -1;                    ///< within FlatCircuit::instances
  std::vector<std::string> nodes;     ///< by full name
  std::vector<std::string> elements;  ///< the others
};

/// Finds sources without a piecewise-linear form that only such parts read: they become 0, and no row shows the nodes.
[[nodiscard]] std::vector<UnreadPart> leave_out_unread(FlatCircuit& circuit, const std::vector<int>& sources);

}  // namespace pwlsim::circuit
