#pragma once
/// A slip in a subcircuit that nothing calls, as libraries have them, is no error of the deck.

#include "circuit/definitions.hpp"

namespace pwlsim::circuit {

/// Errors that stand in such subcircuits become warnings (W-unused-subckt). Returns how many.
std::size_t soften_unused_subcircuits(const Definitions& definitions, Reporter& reporter);

}  // namespace pwlsim::circuit
