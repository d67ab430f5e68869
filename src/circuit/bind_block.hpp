#pragma once
/// A cards: ports of XSPICE, `in`, `[in1 in2]`, `%v a`, `%vd(p,n)`, `%i a`, `%id(p,n)`, `%vnam V1`, and a model.

#include "circuit/binding.hpp"
#include "circuit/card_cursor.hpp"

namespace pwlsim::circuit {

/// Reads inputs, output and model; false after an error.
bool bind_block(Binding& binding, Place& place, CardCursor& cursor, const netlist::Card& card, elements::Instance& instance);

}  // namespace pwlsim::circuit
