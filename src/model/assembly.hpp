#pragma once
/// Rows of a network before any reduction:  x' = S_x z,  0 = F x + G z + H_a a + H_w ζ.
/// z holds, in this order: node voltages; then currents times R0 of low resistors, capacitors, inductors; inductor rates
/// (τ0·x̂', scaled); currents times R0 of branches and diodes, scaled inputs of complementarities, currents times R0 of switches.
/// All of it in volts. A complementarity is a port with u for its current and minus its slack for its voltage.

#include <cmath>
#include <vector>

#include "model/descriptor.hpp"

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
  [[nodiscard]] std::vector<Descriptor::StorePort> store_ports() const;
  /// Λ of the inductance matrix L = Λ Λᵀ, in √H (inductors × rank).
  [[nodiscard]] Matrix inductance_root() const { return inductor_factor.cast<double>() * std::sqrt(r0 * tau0); }
  /// √J per volt of the system's states.
  [[nodiscard]] double energy_unit() const { return std::sqrt(tau0 / r0); }
  [[nodiscard]] Vector store_sign() const;
  /// Name of the element whose current is unknown `index` of z ("" for the rest).
  [[nodiscard]] std::string current_owner(int index) const;
  /// Whether a resistor of the network carries its current as an unknown.
  [[nodiscard]] bool has_current(const Resistor& resistor) const { return is_low(resistor.resistance); }
  [[nodiscard]] int first_complementarity() const { return static_cast<int>(network.diodes.size()); }
  [[nodiscard]] int first_switch() const { return first_complementarity() + static_cast<int>(network.complementarities.size()); }
  [[nodiscard]] const Label& port_label(int port) const;
  /// SI value of a port's current, and of its blocking voltage, per volt in the system; of a complementarity its u and its slack.
  [[nodiscard]] double current_unit(int port) const;
  [[nodiscard]] double voltage_unit(int port) const;
  [[nodiscard]] int port_column(int port) const { return first_port_ + port; }
  [[nodiscard]] int stores() const { return static_cast<int>(network.capacitors.size()) + inductor_factor.cols(); }
  [[nodiscard]] int ports() const { return first_switch() + static_cast<int>(network.switches.size()); }
  [[nodiscard]] int unknowns() const { return unknowns_; }

  const Network& network;
  std::shared_ptr<const Exosystem> exosystem;
  double r0 = 1.0, tau0 = 1.0;
  WideMatrix inductor_factor;     ///< Λ/√(R0·τ0), inductors × rank
  bool coupling_possible = true;  ///< false where the inductance matrix is indefinite
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
  void add_kcl(NodeIndex p, NodeIndex n, int column, Wide value);
  void add_to(int row, int column, Wide term);
  void add_data(int row, const WideVector& terms);
  void add_voltage(int row, NodeIndex p, NodeIndex n);
  void add_resistors();
  void add_stores();
  void add_branches_and_injections();
  void add_ports();
  void scale_inputs(Wide input_factor);
  void add_complementarity(int port, int index);
  void add_port(int port, NodeIndex p, NodeIndex n, double resistance, double drop);
  [[nodiscard]] bool is_low(double resistance) const;

  std::vector<Wide> slack_scale_;  ///< of each complementarity: one over the largest coefficient of its slack
  std::vector<Wide> input_scale_;  ///< u per volt of its unknown
  std::vector<int> low_resistor_;  ///< resistor -> its unknown, −1: a conductance
  int first_low_ = 0, first_capacitor_ = 0, first_inductor_ = 0, first_rate_ = 0, first_branch_ = 0, first_port_ = 0, unknowns_ = 0;
};

}  // namespace pwlsim::model
