#pragma once
/// The equations of a network for the dense model (assembly.hpp) and the sparse engine: the unknowns, the terms of linear forms,
/// and the entries of each element. Each of the two adds them up in its own storage and precision.
///
/// Rows: Kirchhoff's current law of each node, then one equation for each further unknown. Everything is in volts: an unknown current is R0 times the current.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "model/network.hpp"

namespace pwlsim::model {

/// Numbers of the unknowns, in this order: node voltages; currents of low resistors, of capacitors, of inductors; rates of inductors; currents of branches; of
/// ports, which are diodes, then complementarities with their inputs, then switches.
class Unknowns {
 public:
  struct Carried {
    double low_resistance = 0.0;             ///< below it a resistor carries its current as an unknown
    std::vector<char> capacitor_currents{};  ///< which capacitors carry theirs
    int rates = 0;
  };
  Unknowns() = default;
  /// Refers to the network.
  Unknowns(const Network& network, const Carried& choice);

  /// −1: its current is not an unknown.
  [[nodiscard]] int low_resistor(std::size_t i) const { return low_resistor_[i]; }
  [[nodiscard]] int capacitor(std::size_t i) const { return capacitor_[i]; }
  [[nodiscard]] int inductor(int i) const { return first_inductor_ + i; }
  [[nodiscard]] int rate(int j) const { return first_rate_ + j; }
  [[nodiscard]] int branch(int i) const { return first_branch_ + i; }
  [[nodiscard]] int port(int i) const { return first_port_ + i; }
  [[nodiscard]] int first_complementarity() const { return first_complementarity_; }
  [[nodiscard]] int first_switch() const { return first_switch_; }
  [[nodiscard]] int ports() const { return size_ - first_port_; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool is_input(int column) const { return column >= port(first_complementarity_) && column < port(first_switch_); }
  [[nodiscard]] const Label& port_label(int port) const;
  [[nodiscard]] bool is_branch(int column) const { return column >= first_branch_ && column < first_port_; }
  [[nodiscard]] bool is_resistor(int column) const {
    return std::find(low_resistor_.begin(), low_resistor_.end(), column) != low_resistor_.end();
  }
  /// Of the element whose current is an unknown; null for node voltages and rates.
  [[nodiscard]] const Label* owner(int column) const;

 private:
  const Network* network_ = nullptr;
  std::vector<int> low_resistor_, capacitor_;
  int first_inductor_ = 0, first_rate_ = 0, first_branch_ = 0, first_port_ = 0, first_complementarity_ = 0, first_switch_ = 0, size_ = 0;
};

/// Of each complementarity: the SI value of its input a volt, and one over the largest coefficient of its slack.
template <class Scalar>
struct ComplementarityScales {
  explicit ComplementarityScales(std::size_t count = 0) : input(count, Scalar(1)), slack(count, Scalar(1)) {}
  std::vector<Scalar> input, slack;
};

/// value = Σ of a linear form in SI units. `sum` takes its terms: constant(c), source(i, c), unknown(column, c), and inductor_current(i, c), c in SI units, of
/// inductors, as some have other coordinates.
template <class Scalar, class Sum>
void write_form(const Network& network, const Unknowns& unknowns, double r0, const std::vector<Scalar>& input_scale, const LinearForm& form,
                Sum&& sum) {
  using Kind = Term::Kind;
  const auto unknown = [&](int column, Scalar c) {
    if (column >= 0) sum.unknown(column, c);
  };
  for (const Term& term : form) {
    const Scalar c = term.coefficient;
    const auto i = static_cast<std::size_t>(term.index);
    switch (term.kind) {
      case Kind::one:
        sum.constant(c);
        break;
      case Kind::source:
        sum.source(term.index, c);
        break;
      case Kind::node_voltage:
        unknown(term.index, c);
        break;
      case Kind::capacitor_current:
        unknown(unknowns.capacitor(i), c / r0);
        break;
      case Kind::inductor_current:
        sum.inductor_current(term.index, c);
        break;
      case Kind::branch_current:
        unknown(unknowns.branch(term.index), c / r0);
        break;
      case Kind::diode_current:
        unknown(unknowns.port(term.index), c / r0);
        break;
      case Kind::switch_current:
        unknown(unknowns.port(unknowns.first_switch() + term.index), c / r0);
        break;
      case Kind::slack_input:
        unknown(unknowns.port(unknowns.first_complementarity() + term.index), c * input_scale[i]);
        break;
      case Kind::resistor_current: {
        const Resistor& r = network.resistors[i];
        if (unknowns.low_resistor(i) >= 0) {
          unknown(unknowns.low_resistor(i), c / r0);
        } else {
          unknown(r.p, c / r.resistance);
          unknown(r.n, -c / r.resistance);
        }
        break;
      }
    }
  }
}

/// The entries of an element in the rows:
///   kcl(p, n, column, c)          the current c·z[column] flows from p to n
///   voltage(row, p, n, sign)      sign·(v(p) − v(n))
///   resistance(column, c)         −c·z[column] in the row of that current
///   conductance(p, n, c)          the current c·(v(p) − v(n)) flows from p to n
///   form(row, form, factor)       factor·form
///   injection(p, n, form)         the current `form` flows from p to n
///   contact(port, p, n, resistance, drop), complementarity(port, index)
template <class Scalar, class Rows>
void stamp_resistors(const Network& network, const Unknowns& unknowns, double r0, Rows& rows) {
  for (std::size_t i = 0; i < network.resistors.size(); ++i) {
    const Resistor& r = network.resistors[i];
    const int low = unknowns.low_resistor(i);
    if (low >= 0) {
      rows.kcl(r.p, r.n, low, 1.0);
      rows.voltage(low, r.p, r.n, 1.0);
      rows.resistance(low, static_cast<Scalar>(r.resistance) / r0);
    } else {
      rows.conductance(r.p, r.n, static_cast<Scalar>(r0) / r.resistance);
    }
  }
}

template <class Rows>
void stamp_branches_and_injections(const Network& network, const Unknowns& unknowns, Rows& rows) {
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const Branch& b = network.branches[i];
    const int column = unknowns.branch(static_cast<int>(i));
    rows.kcl(b.p, b.n, column, 1.0);
    rows.voltage(column, b.p, b.n, 1.0);
    rows.form(column, b.voltage, -1.0);
  }
  for (const Injection& injection : network.injections) rows.injection(injection.p, injection.n, injection.current);
}

template <class Rows>
void stamp_ports(const Network& network, Rows& rows) {
  int port = 0;
  for (const Diode& d : network.diodes) rows.contact(port++, d.p, d.n, d.resistance, d.drop);
  for (int i = 0; i < static_cast<int>(network.complementarities.size()); ++i) rows.complementarity(port++, i);
  for (const Switch& s : network.switches) rows.contact(port++, s.p, s.n, s.resistance, s.drop);
}

/// Largest coefficients become one: of a slack in its row; of an input where it is a voltage or a current, else in the slacks that hold it.
/// `largest_of(slack)`: of its coefficients, inputs of complementarities left out.
template <class Scalar, class LargestOf>
ComplementarityScales<Scalar> scale_complementarities(const Network& network, double r0, const LargestOf& largest_of) {
  const std::size_t count = network.complementarities.size();
  std::vector<Scalar> in_circuit(count, Scalar(0)), in_slacks(count, Scalar(0));
  const auto weigh = [](std::vector<Scalar>& largest, const LinearForm& form, Scalar factor) {
    for (const Term& term : form)
      if (term.kind == Term::Kind::slack_input) {
        Scalar& l = largest[static_cast<std::size_t>(term.index)];
        l = std::max(l, std::abs(factor * term.coefficient));
      }
  };
  for (const Branch& b : network.branches) weigh(in_circuit, b.voltage, Scalar(1));
  for (const Injection& i : network.injections) weigh(in_circuit, i.current, static_cast<Scalar>(r0));
  ComplementarityScales<Scalar> scales(count);
  for (std::size_t i = 0; i < count; ++i) {
    const LinearForm& slack = network.complementarities[i].slack;
    const Scalar largest = largest_of(slack);
    if (largest > Scalar(0)) scales.slack[i] = Scalar(1) / largest;
    weigh(in_slacks, slack, scales.slack[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Scalar largest = in_circuit[i] > Scalar(0) ? in_circuit[i] : in_slacks[i];
    if (largest > Scalar(0)) scales.input[i] = Scalar(1) / largest;
  }
  return scales;
}

}  // namespace pwlsim::model
