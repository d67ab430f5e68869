#pragma once
/// Expressions with corners that set the voltage of capacitors.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// Puts a small resistance in series with each source whose expression has corners and whose voltage only capacitors and other voltages
/// close to a loop: its current would follow the derivative of a quantity that is known by a complementarity. One note each. Sources that
/// read their own voltage stay as they are, because the resistance would decide what follows.
void resist_capacitors(FlatCircuit& circuit, Reporter& reporter);

}  // namespace pwlsim::circuit
