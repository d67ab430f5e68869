#pragma once
/// Whether the rows of a transient show what its sources do.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

/// `W-coarse-rows` where the period of a source takes in fewer than two rows (Nyquist): the rows of a sine may all be zero.
/// Names the source with the shortest period.
void check_row_step(const model::Network& network, const Transient& transient, Reporter& reporter);

}  // namespace pwlsim::circuit
