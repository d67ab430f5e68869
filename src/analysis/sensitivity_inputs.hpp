#pragma once
/// `.sens`: the parameters of a deck as inputs in a network.

#include "circuit/analyses.hpp"
#include "model/network.hpp"
#include "steady/parameter_inputs.hpp"

namespace pwlsim::analysis {

/// The parameters as inputs in a network of the deck's sources; new signals follow the existing ones.
[[nodiscard]] steady::SensitivityInputs add_inputs(const circuit::SensitivityAnalysis& card, const model::Network& original,
                                                   model::Network& network);

}  // namespace pwlsim::analysis
