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
#include "model/islands.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

/// The unknowns z of a network and the rows that give them, kept for certificates and for the operating point.
struct Descriptor {
  Matrix g, f, ha, hw;      ///< original rows, before index reduction (m × m, m × stores, m × ports, m × n_ζ)
  Matrix sx;                ///< stores × m
  Matrix z_state, z_input;  ///< z = z_state·(ξ, ζ) + z_input·u
  Matrix store_state;       ///< x_full = store_state·(ξ, ζ): all energy coordinates from the reduced ones
  Matrix reduce;            ///< ξ = reduce·x_full (orthogonal: the charge- and flux-conserving projection)
  double r0 = 1.0, tau0 = 1.0;
  /// Terminals and current unknown of each capacitor and inductor: with them, power into the stores is Σ v·i.
  struct StorePort {
    NodeIndex p = ground, n = ground;
    int current = 0;
  };
  std::vector<StorePort> store_ports;
  Vector store_sign;  ///< −1 where a negative C or L makes the energy coordinate count negative
};

struct Extraction {
  System system;
  Descriptor descriptor;
};

[[nodiscard]] std::optional<Extraction> extract(const Island& island, Diagnostics& diagnostics);

/// All energy coordinates (store_state's rows) of the network's initial voltages and currents.
[[nodiscard]] Vector initial_state(const Island& island);

}  // namespace pwlsim::model
