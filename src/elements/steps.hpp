#pragma once
/// Steps outside loops: two-valued functions, decided by a switch.

#include "model/builder.hpp"

namespace pwlsim::elements {

/// Replaces every Step of the builder without a loop from its value back to its argument (model::steps_in_loops) by a switch, and keeps the
/// others, which are set-valued at 0. Call it last: the numbers of the network's complementarities change.
void decide_steps(model::NetworkBuilder& builder);

}  // namespace pwlsim::elements
