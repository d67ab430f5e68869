#pragma once
/// Voltages that take one value or two: of sources, comparisons and gates. What multiplies such a voltage is a switched form.

#include "circuit/circuit.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// Gives the formulas of the circuit switched forms in place of products of signals; an error where neither factor takes two values.
void resolve_products(Circuit& circuit, Reporter& reporter);

}  // namespace pwlsim::circuit
