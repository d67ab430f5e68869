#pragma once
/// XSPICE's digital blocks that switch: adc_bridge, dac_bridge, d_buffer, d_inverter, d_and, d_nand, d_or, d_nor, d_xor, d_xnor, d_dff, d_tff, d_jkff, d_srlatch, d_dlatch, and the analog
/// switch aswitch (ngspice's manual, "Digital Models", "Hybrid Models"). Bits are voltages of 0 and 1 V against ground.

#include "circuit/definitions.hpp"
#include "circuit/reporter.hpp"

namespace pwlsim::circuit {

/// Replaces A devices with such a model by calls of the subcircuits for LTspice's gates; the models are removed.
void replace_xspice_logic(Definitions& definitions, Reporter& reporter);

}  // namespace pwlsim::circuit
