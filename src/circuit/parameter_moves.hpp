#pragma once
/// The changes of the network with the parameters of `.sens`: element by element, from the numbers on cards that depend on them.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

/// Fills in Analyses::sensitivities of an assembled circuit. Unknown names are errors.
void follow_parameters(FlatCircuit& circuit, const model::Network& network, Reporter& reporter);

}  // namespace pwlsim::circuit
