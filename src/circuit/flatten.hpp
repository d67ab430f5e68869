#pragma once
/// Syntax tree -> flat circuit: parameters evaluated, subcircuits expanded, every card given its meaning.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// `ground`: the node used as ground, in a circuit without ground.
/// `run`: number of the run of .step. After errors the circuit contains the parts that were understood: every element at least with its name, so that references can
/// still be checked. Do not emit it then.
struct Flattened {
  FlatCircuit circuit;
  bool expanded = false;  ///< false if it would have become too large or endless: then it has no elements
};
/// Shipped subcircuits that the deck calls are added to `sources`.
[[nodiscard]] Flattened flatten(const netlist::Deck& deck, SourceStore& sources, Reporter& reporter, bool analysis_required,
                                std::size_t run = 0, const std::string& ground = "");

}  // namespace pwlsim::circuit
