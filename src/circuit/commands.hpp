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
};

/// Writes what concerns the run into `analyses`; the rest is the answer.
[[nodiscard]] Options read_options(const Definitions& definitions, Scope& scope, Reporter& reporter, Analyses& analyses);

/// .tran, .op, .save into `circuit`. An error where the deck asks for no analysis and `required`.
void read_analyses(const Definitions& definitions, Scope& scope, Reporter& reporter, bool required, Circuit& circuit);

void read_saves(const Definitions& definitions, Reporter& reporter, Circuit& circuit);

/// .meas and .four into `circuit`.
void read_measurements(const Definitions& definitions, Scope& scope, Reporter& reporter, Circuit& circuit);

}  // namespace pwlsim::circuit
