#pragma once
/// The periods of sources in a transient: whether its rows show them, and windows of whole periods.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

/// `W-coarse-rows` if the period of a source contains two rows or fewer (Nyquist): the rows of a sine may all be zero.
/// Names the source with the shortest period.
void check_row_step(const model::Network& network, const TransientAnalysis& transient, Reporter& reporter);

/// The period of a source; infinite if it does not repeat.
[[nodiscard]] double period_of(const model::SourceFunction& function);

/// Windows `LAST=n PERIODS OF V1` become times, with their derivatives if a parameter of `.sens` changes the period.
void resolve_last_periods(const model::Network& network, Analyses& analyses, Measurements& measurements, Reporter& reporter);

}  // namespace pwlsim::circuit
