#pragma once
/// A run kept in memory: the signals at given times, and the instants of events.

#include <span>
#include <vector>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

struct SampledRun {
  engine::Answer answer;
  std::vector<double> times;                 ///< of the rows that the run reached
  std::vector<std::vector<double>> columns;  ///< one per signal, in the order of the network
};

/// `times` ascend within [0, Tstop]. With `control.events` the rows before and after every event are among the rows, both at its time.
[[nodiscard]] SampledRun sample(const circuit::Analyses& analyses, std::size_t signals, const Simulate& simulate,
                                std::span<const double> times, const RunControl& control = {});

/// The same on the deck's own grid.
[[nodiscard]] SampledRun sample_grid(const circuit::Analyses& analyses, std::size_t signals, const Simulate& simulate,
                                     const RunControl& control = {});

/// The instants with two rows, each once.
[[nodiscard]] std::vector<double> repeated_times(const SampledRun& run);

}  // namespace pwlsim::analysis
