#pragma once
/// A mistake in a subcircuit that nothing calls, as in libraries, is not an error of the deck.

#include "circuit/definitions.hpp"

namespace pwlsim::circuit {

/// Errors in such subcircuits become warnings (W-unused-subckt). Returns how many.
std::size_t soften_unused_subcircuits(const Definitions& definitions, Reporter& reporter);

}  // namespace pwlsim::circuit
