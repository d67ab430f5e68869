#pragma once
/// Circuits of ideal diodes, switches and linear elements, built and run in C++. See docs/api.md.
///
///     pwlsim::Circuit circuit("divider");
///     circuit.voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", 1e3).resistor("R2", "out", "0", "4k");
///     const pwlsim::Result result = circuit.run({.stop = 1e-3});
///     result.signal("v(out)").back();  // 8 V

#include <pwlsim/circuit.hpp>
#include <pwlsim/error.hpp>
#include <pwlsim/gradient.hpp>
#include <pwlsim/result.hpp>
#include <pwlsim/steady_state.hpp>
#include <pwlsim/sweep.hpp>
#include <pwlsim/value.hpp>

namespace pwlsim {

/// "0.1.0"
[[nodiscard]] const char* version();

}  // namespace pwlsim
