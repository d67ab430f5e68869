#pragma once
/// Steps outside loops: two-valued functions, decided by a switch.

#include "model/builder.hpp"

namespace pwlsim::elements {

/// Puts a switch in place of every Step of the builder's whose value no loop leads back to its argument (model::steps_in_loops), and leaves the
/// others, which are set-valued at 0. The last thing done to a network: the numbers of its complementarities change.
void decide_steps(model::Builder& builder);

}  // namespace pwlsim::elements
