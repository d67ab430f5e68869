#pragma once
/// Finds MOSFETs and JFETs whose gates are not driven against their sources.

#include "circuit/circuit.hpp"

namespace pwlsim::circuit {

/// Sets `drive_is_apart` if voltage sources do not tie the source to ground, unless these and resistors tie the gate to the source and
/// not to ground: then the drain current changes v(gate, source). With a driver between gate and source a transistor remains a switch.
void mark_gate_drives(FlatCircuit& circuit);

}  // namespace pwlsim::circuit
