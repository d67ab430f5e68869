#pragma once
/// Conditional parts of a deck: `.if (condition)`, `.elseif (condition)`, `.else`, `.endif` (HSPICE, ngspice, PSpice).

#include <cstddef>
#include <optional>

#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The deck with those sections alone whose conditions hold in this run of `.step`; none where the deck has no `.if`. A condition of the deck itself knows
/// the parameters that stand in no section, and those of the sections chosen before it. Within a subcircuit sections hold elements only: each gets its
/// conditions (Card::guards), which every call decides with its own parameters.
[[nodiscard]] std::optional<netlist::Deck> with_chosen_sections(const netlist::Deck& deck, std::size_t run, Reporter& reporter);

}  // namespace pwlsim::circuit
