#pragma once
/// Conditional parts of a deck: `.if (condition)`, `.elseif (condition)`, `.else`, `.endif` (HSPICE, ngspice, PSpice).

#include <cstddef>
#include <optional>

#include "circuit/reporter.hpp"
#include "netlist/ast.hpp"

namespace pwlsim::circuit {

/// The deck with only those sections whose conditions hold in this run of `.step`; none if the deck has no `.if`. A condition of the deck itself may use
/// the parameters outside of sections, and those of the sections chosen before it. Within a subcircuit sections contain elements, parameters and models: each gets its
/// conditions (Card::guards), which every call decides with its own parameters (guarded_cards.hpp).
[[nodiscard]] std::optional<netlist::Deck> with_chosen_sections(const netlist::Deck& deck, std::size_t run, Reporter& reporter);

}  // namespace pwlsim::circuit
