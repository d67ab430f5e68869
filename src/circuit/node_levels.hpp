#pragma once
/// Voltages with one or two values: of sources, comparisons and gates. A product with such a voltage is a switched form.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// Replaces products of signals in the formulas of the circuit by switched forms; an error if neither factor takes two values.
void resolve_products(FlatCircuit& circuit, Reporter& reporter);

}  // namespace pwlsim::circuit
