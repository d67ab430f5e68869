#pragma once
/// What the periods of sources mean for a transient: whether its rows show them, and windows of whole periods.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"
#include "model/network.hpp"

namespace pwlsim::circuit {

/// `W-coarse-rows` where the period of a source takes in fewer than two rows (Nyquist): the rows of a sine may all be zero.
/// Names the source with the shortest period.
void check_row_step(const model::Network& network, const Transient& transient, Reporter& reporter);

/// The period of a source that repeats; infinite where it does not.
[[nodiscard]] double period_of(const model::SourceFunction& function);

/// Windows `LAST=n PERIODS OF V1` become times, which move with the period where a parameter of `.sens` moves it: that parameter then has a number.
void resolve_last_periods(const model::Network& network, Analyses& analyses, Measurements& measurements, Reporter& reporter);

}  // namespace pwlsim::circuit
