#pragma once
/// What `.ac` adds to the network: its inputs, and the signals that a loop gain is made of.

#include <complex>
#include <string>
#include <vector>

#include "circuit/analyses.hpp"
#include "circuit/compile.hpp"
#include "model/network.hpp"

namespace pwlsim::analysis {

struct SmallSignalInputs {
  std::string id, message;         ///< of an error: E-ac-no-input, …
  std::vector<std::string> names;  ///< of the inputs in the network
  std::vector<std::complex<double>> amplitudes;
  int positive = -1, negative = -1;                               ///< signals: n+ and n− of the source of a loop gain
  int current = -1;                                               ///< signal: its current, if a current source is the second input
  double injected_at_positive = 0.0, injected_at_negative = 0.0;  ///< A that this source injects there
};
/// Adds inputs to `network`, and signals after its own.
[[nodiscard]] SmallSignalInputs add_small_signal_inputs(const circuit::SmallSignalAnalysis& card, model::Network& network);
/// Why there is no response for any orbit; empty if there may be one. `id` is that of the error.
[[nodiscard]] std::string small_signal_problem_of_orbit(const circuit::Compiled& compiled, std::string& id);

/// Numbers of the sources of an element.
[[nodiscard]] std::vector<int> sources_named(const model::Network& network, const std::string& name);

}  // namespace pwlsim::analysis
