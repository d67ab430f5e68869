#pragma once
/// Rows of a network before any reduction:  x' = S_x z,  0 = F x + G z + H_a a + H_w ζ.
/// z holds the unknowns of tableau.hpp, with the currents of all capacitors and rates of inductors (τ0·x̂', scaled). All of it in volts. A complementarity is a port with u for its current and minus its slack for its voltage.

#include <cmath>
#include <vector>

#include "model/equations.hpp"
#include "model/tableau.hpp"

namespace pwlsim::model {

using linalg::Wide;
using linalg::WideMatrix;
using linalg::WideVector;

struct Assembly {
  /// `input_factor`: of the unknowns of complementarities; any positive number describes the same network.
  Assembly(const Network& network, bool needs_constant, Wide input_factor = 1.0L);

  /// value = z_part·z + zeta_part·ζ of a linear form, in SI units.
  struct FormRow {
    WideVector z_part, zeta_part;
  };
  [[nodiscard]] FormRow row_of(const LinearForm& form) const;
  /// Energy coordinates of the `ic=` values.
  [[nodiscard]] Vector initial_state() const;
  [[nodiscard]] std::vector<Equations::StorePort> store_ports() const;
  /// Λ of the inductance matrix L = Λ Λᵀ, in √H (inductors × rank).
  [[nodiscard]] Matrix inductance_root() const { return inductor_factor.cast<double>() * std::sqrt(r0 * tau0); }
  /// √J per volt of the system's states.
  [[nodiscard]] double energy_unit() const { return std::sqrt(tau0 / r0); }
  [[nodiscard]] Vector store_sign() const;
  /// Whether a resistor of the network carries its current as an unknown.
  [[nodiscard]] bool has_current(const Resistor& resistor) const { return std::abs(resistor.resistance) < low_resistance(); }
  /// SI value of a port's current, and of its blocking voltage, per volt in the system; of a complementarity its u and its slack.
  [[nodiscard]] double current_unit(int port) const;
  [[nodiscard]] double voltage_unit(int port) const;
  [[nodiscard]] int stores() const { return static_cast<int>(network.capacitors.size()) + inductor_factor.cols(); }

  const Network& network;
  std::shared_ptr<const Exosystem> exosystem;
  double r0 = 1.0, tau0 = 1.0;
  WideMatrix inductor_factor;     ///< Λ/√(R0·τ0), inductors × rank
  bool coupling_possible = true;  ///< false where the inductance matrix is indefinite
  Unknowns unknowns;
  WideMatrix g, f, ha, hw, sx;
  WideMatrix
      g_rest;  ///< rounding errors of G: next to a large conductance, the rounding of a sum of small ones would act as a leak to ground
  /// Magnitudes of those terms of G that are numbers of the netlist and may cancel: gains, R/R0 and inductances. Incidence numbers are exact, and
  /// conductances of positive resistors enter G as one number at its four places.
  WideMatrix g_data;

 private:
  void choose_scales();
  void factor_inductances();
  void number_unknowns();
  void scale_inputs(Wide input_factor);
  [[nodiscard]] double low_resistance() const;

  ComplementarityScales<Wide> scales_;
};

}  // namespace pwlsim::model
