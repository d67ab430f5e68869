#pragma once

#include <vector>

#include "model/network.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

/// The unknowns z of a network and the rows that give them, kept for certificates and for the operating point.
struct Equations {
  Matrix g, f, ha, hw;      ///< original rows, before index reduction (m × m, m × stores, m × ports, m × n_ζ)
  Matrix sx;                ///< stores × m
  Matrix z_state, z_input;  ///< z = z_state·(ξ, ζ) + z_input·u
  Matrix store_state;       ///< x_full = store_state·(ξ, ζ): all energy coordinates from the reduced ones
  Matrix reduce;            ///< ξ = reduce·x_full of values that satisfy the constraints of stores
  /// ξ = start·x_full + start_sources·ζ of any values: the charge- and flux-conserving projection, which is orthogonal in a reciprocal network.
  Matrix start, start_sources;
  bool reads_source_rates = false;  ///< a law of sources was differentiated: their rates of change drive states or unknowns
  double r0 = 1.0, tau0 = 1.0;
  /// Terminals and current unknown of each capacitor and inductor: with them, power into the stores is Σ v·i.
  struct StorePort {
    NodeIndex p = ground, n = ground;
    int current = 0;
  };
  std::vector<StorePort> store_ports;
  Vector store_sign;  ///< −1 where a negative C or L makes the energy coordinate count negative
};

}  // namespace pwlsim::model
