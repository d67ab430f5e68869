#pragma once
/// The items after the nodes of a V or I card: [DC] value, AC, a waveform, name=value.

#include "circuit/card_cursor.hpp"
#include "circuit/scope.hpp"
#include "elements/kind.hpp"

namespace pwlsim::circuit {

/// Reads to the end of the card. Returns whether it has both a DC value and a waveform, which is then used.
bool bind_source(CardCursor& cursor, Scope& scope, Reporter& reporter, const netlist::Card& card, elements::Instance& instance);

}  // namespace pwlsim::circuit
