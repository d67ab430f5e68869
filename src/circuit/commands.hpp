#pragma once
/// The cards of the deck that ask for something: .options, .tran, .op, .save, .meas and their like.

#include "circuit/census.hpp"
#include "circuit/circuit.hpp"
#include "circuit/definitions.hpp"
#include "circuit/scope.hpp"
#include "elements/kind.hpp"

namespace pwlsim::circuit {

struct Options {
  elements::Settings settings;
  ExpansionLimits limits;
  std::uint64_t seed = 0;  ///< of random numbers
};

/// `.options seed=` where it is a plain number: .step and the other options may draw random numbers before options can be evaluated. 0 without.
[[nodiscard]] std::uint64_t written_seed(const Definitions& definitions);

/// Writes what concerns the run into `analyses`; the rest is the answer.
[[nodiscard]] Options read_options(const Definitions& definitions, Scope& scope, Reporter& reporter, Analyses& analyses);

/// .tran, .op, .save into `circuit`. An error where the deck requests no analysis and `required`.
void read_analyses(const Definitions& definitions, SourceSpan title, Scope& scope, Reporter& reporter, bool required, Circuit& circuit);

/// .pss and .pop into `circuit`.
void read_steady_state(const Definitions& definitions, Scope& scope, Reporter& reporter, Circuit& circuit);

/// .ac into `circuit`.
void read_small_signal(const Definitions& definitions, Scope& scope, Reporter& reporter, Circuit& circuit);

/// .sens into `circuit`: its names, of which those of parameters are varied from here on.
void read_sensitivities(const Definitions& definitions, Scope& scope, Reporter& reporter, Circuit& circuit);
/// Behind all measurements: whether there are those that it names.
void check_sensitivities(Reporter& reporter, const Circuit& circuit);
/// Behind all elements: the switch or diode of on= and off= of .pss, by its full name.
void check_trigger(Reporter& reporter, Circuit& circuit);
/// Behind all elements: the values of its parameters, and numbers that depend on them where nobody follows that.
void take_parameter_values(Scope& scope, Circuit& circuit);

void read_saves(Definitions& definitions, Reporter& reporter, Circuit& circuit);

/// .step; what its numbers need must not depend on what is stepped.
void read_sweeps(const Definitions& definitions, Scope& scope, Reporter& reporter, Sweeps& sweeps);
/// The values of one run: of parameters before anything else is evaluated, of sources behind all elements.
void give_stepped_parameters(const Sweeps& sweeps, std::size_t run, Scope& scope);
void set_stepped_elements(const Sweeps& sweeps, std::size_t run, Reporter& reporter, Circuit& circuit);

/// .meas and .four into `circuit`.
void read_measurements(const Definitions& definitions, Scope& scope, Reporter& reporter, Circuit& circuit);

}  // namespace pwlsim::circuit
