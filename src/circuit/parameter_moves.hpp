#pragma once
/// What the parameters of `.sens` move in the network: element by element, from the numbers of the cards that depend on them.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

/// Fills in Analyses::sensitivities of an assembled circuit. Names that are none are errors.
void follow_parameters(Circuit& circuit, const model::Network& network, Reporter& reporter);

}  // namespace pwlsim::circuit
