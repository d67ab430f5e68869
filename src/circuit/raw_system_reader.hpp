#pragma once
/// `.lcs name "file"`: the rows of the file as a raw system.

#include <vector>

#include "circuit/circuit.hpp"
#include "circuit/scope.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// Adds an instance for every card. Matrices that do not fit one another are errors at the line where the matrix begins.
void read_raw_systems(const std::vector<const netlist::Card*>& cards, Scope& scope, Reporter& reporter, FlatCircuit& circuit);

}  // namespace pwlsim::circuit
