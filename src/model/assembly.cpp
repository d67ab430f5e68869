#include "model/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/log_mean.hpp"
#include "linalg/doubled.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

bool needs_constant(const Network& network) {
  const auto has_one = [](const LinearForm& form) {
    return std::any_of(form.begin(), form.end(), [](const Term& t) { return t.kind == Term::Kind::one && t.coefficient != 0.0; });
  };
  for (const auto& d : network.diodes)
    if (d.drop != 0.0) return true;
  for (const auto& s : network.switches)
    if (s.drop != 0.0) return true;
  for (const auto& b : network.branches)
    if (has_one(b.voltage)) return true;
  for (const auto& i : network.injections)
    if (has_one(i.current)) return true;
  for (const auto& c : network.complementarities)
    if (has_one(c.slack)) return true;
  for (const auto& s : network.signals)
    if (has_one(s.form)) return true;
  return false;
}

/// The smallest and the largest of what is neither zero nor infinite.
struct Range {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;

  void take(double value) {
    const double size = std::abs(value);
    if (size == 0.0 || std::isinf(size)) return;
    least = std::min(least, size);
    most = std::max(most, size);
  }
  /// As many decades from the one as from the other.
  [[nodiscard]] double middle() const { return most > 0.0 ? std::sqrt(least) * std::sqrt(most) : 1.0; }
};

}  // namespace

Assembly::Assembly(const Network& net, bool constant_wanted, Wide input_factor) : network(net) {
  exosystem = std::make_shared<Exosystem>(source_functions(network), constant_wanted || needs_constant(network));
  choose_scales();
  factor_inductances();
  number_unknowns();
  scale_inputs(input_factor);
  const int m = unknowns_;
  g = WideMatrix::Zero(m, m);
  g_rest = WideMatrix::Zero(m, m);
  g_data = WideMatrix::Zero(m, m);
  f = WideMatrix::Zero(m, stores());
  ha = WideMatrix::Zero(m, ports());
  hw = WideMatrix::Zero(m, exosystem->size());
  sx = WideMatrix::Zero(stores(), m);
  add_resistors();
  add_stores();
  add_branches_and_injections();
  add_ports();
}

bool Assembly::is_low(double resistance) const { return std::abs(resistance) < tolerance::low_resistance * r0; }

void Assembly::choose_scales() {
  LogMean capacitance, inductance, time;
  for (const auto& c : network.capacitors) capacitance.add(std::abs(c.capacitance));
  for (const auto& l : network.inductors) inductance.add(std::abs(l.inductance));
  // In the middle every resistor is clearly a wire or clearly a leak to the wave ports, and both come out of them as small entries that nothing
  // cancels with.
  Range resistance;
  for (const auto& r : network.resistors) resistance.take(r.resistance);
  for (const auto& d : network.diodes) resistance.take(d.resistance);
  for (const auto& s : network.switches)
    if (s.p != s.n) resistance.take(s.resistance);
  if (!capacitance.empty() && !inductance.empty()) resistance.take(std::sqrt(inductance.value() / capacitance.value()));
  r0 = resistance.middle();
  for (const auto& c : network.capacitors) time.add(std::abs(c.capacitance) * r0);
  for (const auto& l : network.inductors) time.add(std::abs(l.inductance) / r0);
  tau0 = time.value();
}

void Assembly::factor_inductances() {
  const auto n = static_cast<int>(network.inductors.size());
  WideVector root(n);
  WideMatrix rest = WideMatrix::Identity(n, n);
  for (int i = 0; i < n; ++i) root[i] = std::sqrt(std::abs(static_cast<Wide>(network.inductors[i].inductance)));
  for (const auto& k : network.couplings) {
    rest(k.inductor_a, k.inductor_b) += k.coefficient;
    rest(k.inductor_b, k.inductor_a) += k.coefficient;
  }
  WideMatrix factor(n, n);
  int rank = 0;
  for (; rank < n; ++rank) {
    Eigen::Index pivot = 0;
    const Wide largest = rest.diagonal().maxCoeff(&pivot);
    if (largest < tolerance::coupling_rank) break;
    factor.col(rank) = rest.col(pivot) / std::sqrt(largest);
    rest.noalias() -= factor.col(rank) * factor.col(rank).transpose();
    rest.row(pivot).setZero();
    rest.col(pivot).setZero();
  }
  if (n > 0 && rest.cwiseAbs().maxCoeff() > 1e3 * tolerance::coupling_rank) coupling_possible = false;
  inductor_factor = root.asDiagonal() * factor.leftCols(rank) / std::sqrt(static_cast<Wide>(r0) * tau0);
}

void Assembly::number_unknowns() {
  int next = static_cast<int>(network.nodes.size());
  first_low_ = next;
  for (const auto& r : network.resistors) low_resistor_.push_back(is_low(r.resistance) ? next++ : -1);
  const auto take = [&next](std::size_t count) {
    const int first = next;
    next += static_cast<int>(count);
    return first;
  };
  first_capacitor_ = take(network.capacitors.size());
  first_inductor_ = take(network.inductors.size());
  first_rate_ = take(static_cast<std::size_t>(inductor_factor.cols()));
  first_branch_ = take(network.branches.size());
  first_port_ = take(static_cast<std::size_t>(ports()));
  unknowns_ = next;
}

void Assembly::add_to(int row, int column, Wide term) {
  linalg::Doubled sum{g(row, column), g_rest(row, column)};
  sum.add(term);
  g(row, column) = sum.value;
  g_rest(row, column) = sum.rest;
}

void Assembly::add_kcl(NodeIndex p, NodeIndex n, int column, Wide value) {
  if (p != ground) add_to(p, column, value);
  if (n != ground) add_to(n, column, -value);
}

/// Coefficients of the netlist into a row of G.
void Assembly::add_data(int row, const WideVector& terms) {
  for (int column = 0; column < unknowns_; ++column) {
    if (terms[column] == 0.0) continue;
    add_to(row, column, terms[column]);
    g_data(row, column) += std::abs(terms[column]);
  }
}

void Assembly::add_voltage(int row, NodeIndex p, NodeIndex n) {
  if (p != ground) g(row, p) += 1.0;
  if (n != ground) g(row, n) -= 1.0;
}

void Assembly::add_resistors() {
  for (std::size_t i = 0; i < network.resistors.size(); ++i) {
    const auto& r = network.resistors[i];
    const int low = low_resistor_[i];
    if (low >= 0) {
      add_kcl(r.p, r.n, low, 1.0);
      add_voltage(low, r.p, r.n);
      g(low, low) -= static_cast<Wide>(r.resistance) / r0;
      g_data(low, low) += std::abs(g(low, low));
      continue;
    }
    const Wide conductance = static_cast<Wide>(r0) / r.resistance;
    for (const NodeIndex column : {r.p, r.n}) {
      if (column == ground) continue;
      add_kcl(r.p, r.n, column, column == r.p ? conductance : -conductance);
      if (conductance > 0.0) continue;
      if (r.p != ground) g_data(r.p, column) -= conductance;
      if (r.n != ground) g_data(r.n, column) -= conductance;
    }
  }
}

void Assembly::add_stores() {
  const auto capacitors = static_cast<int>(network.capacitors.size());
  for (int i = 0; i < capacitors; ++i) {
    const auto& c = network.capacitors[i];
    const int column = first_capacitor_ + i;
    const Wide s = std::sqrt(static_cast<Wide>(std::abs(c.capacitance)) * r0 / tau0);
    add_kcl(c.p, c.n, column, 1.0);
    add_voltage(column, c.p, c.n);
    f(column, i) = -1.0L / s;
    sx(i, column) = std::copysign(1.0L / (s * tau0), static_cast<Wide>(c.capacitance));
  }
  const auto rates = static_cast<int>(inductor_factor.cols());
  for (int j = 0; j < rates; ++j) {
    const Wide scale = inductor_factor.col(j).cwiseAbs().maxCoeff();
    const int row = first_rate_ + j;
    for (int i = 0; i < static_cast<int>(network.inductors.size()); ++i) {
      const Wide sign = network.inductors[i].inductance < 0.0 ? -1.0L : 1.0L;
      g(first_inductor_ + i, row) -= sign * inductor_factor(i, j) / scale;
      g(row, first_inductor_ + i) += inductor_factor(i, j) / scale;
      g_data(first_inductor_ + i, row) = g_data(row, first_inductor_ + i) = std::abs(inductor_factor(i, j) / scale);
    }
    f(row, capacitors + j) = -1.0L / scale;
    sx(capacitors + j, row) = 1.0L / (scale * tau0);
  }
  for (int i = 0; i < static_cast<int>(network.inductors.size()); ++i) {
    const auto& l = network.inductors[i];
    add_kcl(l.p, l.n, first_inductor_ + i, 1.0);
    add_voltage(first_inductor_ + i, l.p, l.n);
  }
}

void Assembly::add_branches_and_injections() {
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const auto& b = network.branches[i];
    const int column = first_branch_ + static_cast<int>(i);
    add_kcl(b.p, b.n, column, 1.0);
    add_voltage(column, b.p, b.n);
    const FormRow row = row_of(b.voltage);
    add_data(column, -row.z_part);
    hw.row(column) -= row.zeta_part.transpose();
  }
  for (const auto& injection : network.injections) {
    const FormRow row = row_of(injection.current);
    for (const auto& [node, sign] : {std::pair{injection.p, static_cast<Wide>(r0)}, std::pair{injection.n, -static_cast<Wide>(r0)}}) {
      if (node == ground) continue;
      add_data(node, sign * row.z_part);
      hw.row(node) += sign * row.zeta_part.transpose();
    }
  }
}

void Assembly::add_port(int port, NodeIndex p, NodeIndex n, double resistance, double drop) {
  const int column = port_column(port);
  add_kcl(p, n, column, 1.0);
  add_voltage(column, p, n);
  const Wide ratio = static_cast<Wide>(resistance) / r0;
  add_to(column, column, -1.0L);
  add_to(column, column, -ratio);
  g_data(column, column) += std::abs(ratio);
  ha(column, port) = -1.0;
  if (drop != 0.0) hw(column, exosystem->constant()) -= drop;
}

/// Largest coefficients become one: of a slack in its row; of an input where it is a voltage or a current, else in the slacks that hold it.
void Assembly::scale_inputs(Wide input_factor) {
  const std::size_t count = network.complementarities.size();
  std::vector<Wide> in_circuit(count, 0.0), in_slacks(count, 0.0);
  const auto weigh = [](std::vector<Wide>& largest, const LinearForm& form, Wide factor) {
    for (const auto& term : form)
      if (term.kind == Term::Kind::slack_input)
        largest[static_cast<std::size_t>(term.index)] =
            std::max(largest[static_cast<std::size_t>(term.index)], std::abs(factor * term.coefficient));
  };
  for (const auto& b : network.branches) weigh(in_circuit, b.voltage, 1.0L);
  for (const auto& i : network.injections) weigh(in_circuit, i.current, static_cast<Wide>(r0));
  input_scale_.assign(count, 1.0L);
  slack_scale_.assign(count, 1.0L);
  for (std::size_t i = 0; i < count; ++i) {
    const LinearForm& slack = network.complementarities[i].slack;
    const FormRow row = row_of(slack);
    Wide largest = 0.0;
    for (int j = 0; j < unknowns_; ++j)
      if (j < port_column(first_complementarity()) || j >= port_column(first_switch()))
        largest = std::max(largest, std::abs(row.z_part[j]));
    if (largest > 0.0) slack_scale_[i] = 1.0L / largest;
    weigh(in_slacks, slack, slack_scale_[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Wide largest = in_circuit[i] > 0.0 ? in_circuit[i] : in_slacks[i];
    input_scale_[i] = (largest > 0.0 ? 1.0L / largest : 1.0L) / input_factor;
  }
}

/// −slack − u − a = 0 in the place of a diode's v − R0·i − a = 0.
void Assembly::add_complementarity(int port, int index) {
  const int column = port_column(port);
  const FormRow row = row_of(network.complementarities[static_cast<std::size_t>(index)].slack);
  const Wide scale = slack_scale_[static_cast<std::size_t>(index)];
  add_data(column, -scale * row.z_part);
  hw.row(column) -= scale * row.zeta_part.transpose();
  add_to(column, column, -1.0L);
  ha(column, port) = -1.0;
}

void Assembly::add_ports() {
  int port = 0;
  for (const auto& d : network.diodes) add_port(port++, d.p, d.n, d.resistance, d.drop);
  for (std::size_t i = 0; i < network.complementarities.size(); ++i) add_complementarity(port++, static_cast<int>(i));
  for (const auto& s : network.switches) add_port(port++, s.p, s.n, s.resistance, s.drop);
}

Assembly::FormRow Assembly::row_of(const LinearForm& form) const {
  FormRow row{WideVector::Zero(unknowns_), WideVector::Zero(exosystem->size())};
  for (const auto& term : form) {
    const Wide c = term.coefficient;
    const int i = term.index;
    switch (term.kind) {
      case Term::Kind::one:
        if (c != 0.0) row.zeta_part[exosystem->constant()] += c;
        break;
      case Term::Kind::source:
        row.zeta_part += c * exosystem->rows().row(i).transpose().cast<Wide>();
        break;
      case Term::Kind::node_voltage:
        if (i != ground) row.z_part[i] += c;
        break;
      case Term::Kind::resistor_current: {
        const auto& r = network.resistors[i];
        if (low_resistor_[i] >= 0) {
          row.z_part[low_resistor_[i]] += c / r0;
          break;
        }
        if (r.p != ground) row.z_part[r.p] += c / r.resistance;
        if (r.n != ground) row.z_part[r.n] -= c / r.resistance;
        break;
      }
      case Term::Kind::capacitor_current:
        row.z_part[first_capacitor_ + i] += c / r0;
        break;
      case Term::Kind::inductor_current:
        row.z_part[first_inductor_ + i] += c / r0;
        break;
      case Term::Kind::branch_current:
        row.z_part[first_branch_ + i] += c / r0;
        break;
      case Term::Kind::diode_current:
        row.z_part[port_column(i)] += c / r0;
        break;
      case Term::Kind::switch_current:
        row.z_part[port_column(first_switch() + i)] += c / r0;
        break;
      case Term::Kind::slack_input:
        row.z_part[port_column(first_complementarity() + i)] += c * input_scale_[static_cast<std::size_t>(i)];
        break;
    }
  }
  return row;
}

Vector Assembly::initial_state() const {
  Vector x = Vector::Zero(stores());
  const auto capacitors = static_cast<int>(network.capacitors.size());
  for (int i = 0; i < capacitors; ++i)
    x[i] = network.capacitors[i].initial_voltage * std::sqrt(std::abs(network.capacitors[i].capacitance) * r0 / tau0);
  Vector current(static_cast<int>(network.inductors.size()));
  for (int i = 0; i < current.size(); ++i) current[i] = network.inductors[i].initial_current * r0;
  x.tail(inductor_factor.cols()) = inductor_factor.transpose().cast<double>() * current;
  return x;
}

std::vector<Descriptor::StorePort> Assembly::store_ports() const {
  std::vector<Descriptor::StorePort> ports;
  for (std::size_t i = 0; i < network.capacitors.size(); ++i)
    ports.push_back({network.capacitors[i].p, network.capacitors[i].n, first_capacitor_ + static_cast<int>(i)});
  for (std::size_t i = 0; i < network.inductors.size(); ++i)
    ports.push_back({network.inductors[i].p, network.inductors[i].n, first_inductor_ + static_cast<int>(i)});
  return ports;
}

Vector Assembly::store_sign() const {
  Vector sign = Vector::Ones(stores());
  const auto capacitors = static_cast<Eigen::Index>(network.capacitors.size());
  for (Eigen::Index i = 0; i < capacitors; ++i)
    if (network.capacitors[static_cast<std::size_t>(i)].capacitance < 0.0) sign[i] = -1.0;
  for (Eigen::Index j = 0; j < inductor_factor.cols(); ++j) {
    Eigen::Index owner = 0;
    inductor_factor.col(j).cwiseAbs().maxCoeff(&owner);
    if (network.inductors[static_cast<std::size_t>(owner)].inductance < 0.0) sign[capacitors + j] = -1.0;
  }
  return sign;
}

std::string Assembly::current_owner(int index) const {
  if (index < first_low_) return {};
  for (std::size_t i = 0; i < low_resistor_.size(); ++i)
    if (low_resistor_[i] == index) return network.resistors[i].label.name;
  if (index < first_capacitor_) return {};
  if (index < first_inductor_) return network.capacitors[index - first_capacitor_].label.name;
  if (index < first_rate_) return network.inductors[index - first_inductor_].label.name;
  if (index < first_branch_) return {};
  if (index < first_port_) return network.branches[index - first_branch_].label.name;
  return port_label(index - first_port_).name;
}

const Label& Assembly::port_label(int port) const {
  if (port < first_complementarity()) return network.diodes[static_cast<std::size_t>(port)].label;
  if (port < first_switch()) return network.complementarities[static_cast<std::size_t>(port - first_complementarity())].label;
  return network.switches[static_cast<std::size_t>(port - first_switch())].label;
}

double Assembly::current_unit(int port) const {
  const bool of_diode_or_switch = port < first_complementarity() || port >= first_switch();
  return of_diode_or_switch ? 1.0 / r0 : static_cast<double>(input_scale_[static_cast<std::size_t>(port - first_complementarity())]);
}

double Assembly::voltage_unit(int port) const {
  const bool of_diode_or_switch = port < first_complementarity() || port >= first_switch();
  return of_diode_or_switch ? 1.0 : static_cast<double>(1.0L / slack_scale_[static_cast<std::size_t>(port - first_complementarity())]);
}

}  // namespace pwlsim::model
