#pragma once
/// Switches whose control is an expression: `S1 a b model CONTROL={V(c)-I(L1)}` (Xyce Reference Guide, "Generic Switch").

#include "circuit/definitions.hpp"

namespace pwlsim::circuit {

/// Replaces each such card by a source B of the expression and a switch that it controls.
void replace_control_switches(Definitions& definitions);

}  // namespace pwlsim::circuit
