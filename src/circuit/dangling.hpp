#pragma once
/// Nodes of a single element whose name is similar to that of another node: most often a spelling mistake.

#include <string_view>

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// A warning for each R, C, L, D, S of the deck itself at such a node: it carries no current. Nodes that something reads or saves are intended.
void warn_of_dangling(const FlatCircuit& circuit, Reporter& reporter);

/// Whether one element touches the node and nothing reads or saves it.
[[nodiscard]] bool hangs_alone(const FlatCircuit& circuit, std::string_view node);

}  // namespace pwlsim::circuit
