#pragma once
/// Network -> linear complementarity system. Every diode and switch is terminated in a wave port of resistance R0
/// (a = v − R0·i, b = v + R0·i), energy stores are written in energy coordinates, and index reduction removes what
/// capacitor–source loops and inductor cutsets fix:
///
///     x' = S_x z,   0 = F x + G z + H_a a + H_w ζ.
///
/// Guarantees: for a passive network any diode-only loop or cutset, series and parallel diodes, diode ∥ C and diode–L
/// give proper (A, B, C, D) with D + Dᵀ ⪰ 0. Fails, with a diagnostic, where a source loop, a cutset or a floating part
/// leaves the equations singular, and where an active network is improper in its ports.

#include <optional>

#include "base/diagnostic.hpp"
#include "model/equations.hpp"
#include "model/islands.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

struct Extraction {
  System system;
  Equations equations;
};

[[nodiscard]] std::optional<Extraction> extract(const Island& island, Diagnostics& diagnostics);

/// All energy coordinates (store_state's rows) of the network's initial voltages and currents.
[[nodiscard]] Vector initial_state(const Island& island);

}  // namespace pwlsim::model
