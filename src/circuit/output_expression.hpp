#pragma once
/// HSPICE's par('v(a)-2*v(b)') on output cards: a piecewise-linear expression of signals becomes a column, the voltage of a source B of its own.

#include <optional>

#include "circuit/circuit.hpp"
#include "circuit/definitions.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// Of par('…') and name=par('…'), whose source is added to the deck. Empty for other items, and for expressions that have no such source (products of
/// signals, functions of the deck).
[[nodiscard]] std::optional<SaveRequest> output_expression(const netlist::Item& item, Definitions& definitions, const Reporter& reporter,
                                                           FlatCircuit& circuit);

}  // namespace pwlsim::circuit
