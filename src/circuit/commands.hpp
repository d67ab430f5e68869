#pragma once
/// The cards of the deck with requests: .options, .tran, .op, .save, .meas and others.

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

/// `.options seed=` if it is a plain number: .step and the other options may draw random numbers before options can be evaluated. 0 if there is none.
[[nodiscard]] std::uint64_t written_seed(const Definitions& definitions);

/// Writes the options of the run into `analyses` and returns the others.
[[nodiscard]] Options read_options(const Definitions& definitions, Scope& scope, Reporter& reporter, Analyses& analyses);

/// .tran, .op, .save into `circuit`. An error if `required` and the deck requests no analysis.
void read_analyses(const Definitions& definitions, SourceSpan title, Scope& scope, Reporter& reporter, bool required, FlatCircuit& circuit);

/// .pss and .pop into `circuit`.
void read_steady_state(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit);

/// .ac into `circuit`.
void read_small_signal(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit);

/// The names of .sens into `circuit`; parameters among them are varied from now on.
void read_sensitivities(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit);
/// Call after all measurements: checks that those it names exist.
void check_sensitivities(Reporter& reporter, const FlatCircuit& circuit);
/// Call after all elements: checks the switch or diode of on= and off= of .pss, by its full name.
void check_trigger(Reporter& reporter, FlatCircuit& circuit);
/// Call after all elements: the values of its parameters, and the numbers that depend on them but are not followed.
void take_parameter_values(Scope& scope, FlatCircuit& circuit);

void read_saves(Definitions& definitions, Reporter& reporter, FlatCircuit& circuit);

/// .step; its numbers must not depend on stepped values.
void read_sweeps(const Definitions& definitions, Scope& scope, Reporter& reporter, Sweeps& sweeps);
/// The values of one run: set those of parameters before anything else is evaluated, those of sources after all elements.
void give_stepped_parameters(const Sweeps& sweeps, std::size_t run, Scope& scope);
void set_stepped_elements(const Sweeps& sweeps, std::size_t run, Reporter& reporter, FlatCircuit& circuit);

/// .meas and .four into `circuit`.
void read_measurements(const Definitions& definitions, Scope& scope, Reporter& reporter, FlatCircuit& circuit);

}  // namespace pwlsim::circuit
