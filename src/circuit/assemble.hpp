#pragma once
/// Flat circuit -> network of the model: names are resolved, every element emits itself, the saved signals become forms.

#include <optional>

#include "base/diagnostic.hpp"
#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

/// Fills in the indices of the references of `circuit`. Errors: names that are unknown or not allowed there, elements that are not
/// complete, nodes without a path to ground. Empty if `diagnostics` has an error on return.
/// The nodes of the circuit come first in the network, in their order; signals are those of circuit.saves, or by default every node
/// voltage in order of appearance and then every current of L, V, E, H, D, S.
[[nodiscard]] std::optional<model::Network> assemble(FlatCircuit& circuit, Diagnostics& diagnostics);
[[nodiscard]] std::optional<model::Network> assemble(FlatCircuit& circuit, Reporter& reporter);

}  // namespace pwlsim::circuit
