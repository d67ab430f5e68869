#pragma once
/// Against what the gates of MOSFETs and JFETs are driven.

#include "circuit/circuit.hpp"

namespace pwlsim::circuit {

/// Sets `drive_is_apart` of those whose source is not tied to ground by voltage sources, unless their gate is to the source, by these and by resistors, and
/// not to ground: else the drain's current moves v(gate, source). A driver between gate and source leaves a transistor a switch.
void mark_gate_drives(Circuit& circuit);

}  // namespace pwlsim::circuit
