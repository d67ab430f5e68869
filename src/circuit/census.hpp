#pragma once
/// Counts the size of a deck before anything is expanded.

#include "circuit/definitions.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

struct ExpansionLimits {
  double elements = 1e7;  ///< calls of subcircuits count as elements
  double depth = 100;     ///< nesting of subcircuits
};

/// Whether it is an X card, or one that was made to be a call.
[[nodiscard]] bool is_call(const netlist::Card& card);
/// The subcircuit an X card calls: its last word.
[[nodiscard]] const netlist::Item* called_subcircuit(const netlist::Card& card);

/// False, with an error, if subcircuits call themselves, nest too deep or give too many elements.
/// Takes time in proportion to the deck, not to its expansion. Calls of unknown subcircuits count as nothing.
[[nodiscard]] bool check_expansion(const Definitions& definitions, const ExpansionLimits& limits, Reporter& reporter);

}  // namespace pwlsim::circuit
