#pragma once
/// The tableau of a converter: node voltages, branch currents (times `unit_resistance`) and capacitor voltages are unknowns, each branch has its equation
/// and each node its sum of currents. Conductances are never added, so a floating part held by Roff alone keeps its potential.
/// In a mode (which valves and contacts conduct) it reads E x' + G x = b(t); E has rows for inductors and capacitors only.

#include <map>
#include <string>
#include <vector>

#include "converters/netlist.hpp"
#include "converters/sparse_lu.hpp"

namespace pwlsim::test::converters {

using Vector = std::vector<Real>;
/// A letter for each valve (diode, thyristor) and then for each gate: '1' conducts.
using Mode = std::string;

class Equations {
 public:
  explicit Equations(const Converter& converter);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t valves() const { return valves_.size(); }
  [[nodiscard]] const Branch& valve(std::size_t k) const { return converter_.branches[valves_[k]]; }
  [[nodiscard]] std::size_t states() const { return states_.size(); }
  [[nodiscard]] bool is_voltage(std::size_t state) const { return voltage_state_[state] != 0; }
  [[nodiscard]] Real initial(std::size_t state) const { return initial_[state]; }

  /// The matrix of value·E + step·G with its rows scaled.
  template <class Scalar>
  [[nodiscard]] SparseMatrix<Scalar> matrix(const Mode& mode, const Scalar& value, Real step) const;
  /// b(time) - G x, its rows scaled likewise, x = these states and else zero; `inside`: Wave::value.
  [[nodiscard]] Vector right_side(const Mode& mode, const Vector& states, Real time, Real inside) const;
  /// Volt or ampere of state k in a solution.
  [[nodiscard]] Real state(const Vector& solution, std::size_t k) const;
  void add_state(Vector& solution, std::size_t k, Real value) const;
  /// What must not be negative: off: drop - v; on: i - drop/off.
  [[nodiscard]] Real slack(const Vector& solution, const Mode& mode, std::size_t valve) const;
  /// The slack is a voltage.
  [[nodiscard]] static bool slack_is_voltage(const Mode& mode, std::size_t valve) { return mode[valve] == '0'; }
  /// Least slack of a current that decides anything: that of blocked parts.
  [[nodiscard]] Real leak() const { return 1 / largest_off_; }
  [[nodiscard]] const Converter& converter() const { return converter_; }

 private:
  static constexpr Real unit_resistance = 1000;
  /// In place of Ron = 0 and Roff = inf: every step has one solution then, whose states differ by less than 1e-9.
  static constexpr Real least_on = 1e-11L, largest_off_allowed = 1e17L;

  [[nodiscard]] std::size_t node(const std::string& name);
  template <class Scalar>
  void add(std::vector<Entry<Scalar>>& row, std::size_t plus, std::size_t minus, const Scalar& factor) const;
  [[nodiscard]] Real resistance(const Branch& branch, bool conducts) const;
  [[nodiscard]] bool conducts(std::size_t branch, const Mode& mode) const;

  Converter converter_;
  std::map<std::string, std::size_t> nodes_;
  std::vector<std::size_t> plus_, minus_;  ///< of each branch; ground is `none`
  std::vector<std::size_t> states_;        ///< unknowns
  std::vector<char> voltage_state_;
  std::vector<Real> initial_;
  std::vector<std::size_t> valves_, place_in_mode_;    ///< branches; of each branch
  std::vector<std::size_t> capacitor_unknown_;         ///< of each branch
  std::vector<std::vector<Entry<Real>>> inductances_;  ///< of each branch: other branch, henry
  std::vector<std::vector<Entry<Real>>> ratios_;       ///< of each branch: perfectly coupled to that other one, voltage by voltage
  std::size_t current_ = 0, sums_ = 0, capacitor_rows_ = 0, size_ = 0;  ///< first unknown or row of its kind
  Real largest_off_ = 1;
};

}  // namespace pwlsim::test::converters
