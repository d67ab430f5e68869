#pragma once
/// Syntax tree -> flat circuit: parameters evaluated, subcircuits expanded, every card given its meaning.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// `ground`: a node that stands for it, in a circuit that has none.
/// `run`: which of those that .step asks for. After errors the circuit holds what could be understood: every element at least with its name, so that the names others refer to can
/// still be checked. It must not be emitted then.
struct Flattened {
  Circuit circuit;
  bool expanded = false;  ///< false where it would have become too large or endless: then it holds no element
};
/// Shipped subcircuits that the deck calls are added to `sources`.
[[nodiscard]] Flattened flatten(const netlist::Deck& deck, SourceStore& sources, Reporter& reporter, bool analysis_required,
                                std::size_t run = 0, const std::string& ground = "");

}  // namespace pwlsim::circuit
