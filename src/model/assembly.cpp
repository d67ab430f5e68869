#include "model/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/arithmetic.hpp"
#include "linalg/doubled.hpp"
#include "model/leaks.hpp"
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

constexpr double share_of_widest = 0.5;  ///< of a gap, in decades: it is nearly as wide

/// The smallest and the largest of what is neither zero nor infinite.
class Range {
 public:
  void take(double value) {
    const double size = std::abs(value);
    if (size != 0.0 && !std::isinf(size)) sizes_.push_back(size);
  }
  /// As many decades from the least as from the most.
  [[nodiscard]] double middle() const {
    if (sizes_.empty()) return 1.0;
    const auto [least, most] = std::minmax_element(sizes_.begin(), sizes_.end());
    return std::sqrt(*least) * std::sqrt(*most);
  }
  /// The same of two neighbours, the lower of which is at most `firm`: of those that are nearly as far apart as any the ones that are nearest to the middle of all.
  [[nodiscard]] double middle_of_gap(double firm) {
    std::sort(sizes_.begin(), sizes_.end());
    const auto width = [&](std::size_t i) { return std::log(sizes_[i] / sizes_[i - 1]); };
    const double whole = middle();
    double widest = 0.0, nearest = INFINITY, chosen = whole;
    for (std::size_t i = 1; i < sizes_.size() && sizes_[i - 1] <= firm; ++i) widest = std::max(widest, width(i));
    for (std::size_t i = 1; i < sizes_.size() && sizes_[i - 1] <= firm; ++i) {
      const double between = std::sqrt(sizes_[i - 1]) * std::sqrt(sizes_[i]), away = std::abs(std::log(between / whole));
      if (!(width(i) > share_of_widest * widest) || !(away < nearest)) continue;
      nearest = away;
      chosen = between;
    }
    return chosen;
  }

 private:
  std::vector<double> sizes_;
};

/// Writes what elements put into G, F, Hₐ, H_w and S_x.
class Stamps {
 public:
  Stamps(Assembly& assembly, const ComplementarityScales<Wide>& scales) : a_(assembly), scales_(scales) {}

  void kcl(NodeIndex p, NodeIndex n, int column, Wide value) {
    if (p != ground) add_to(p, column, value);
    if (n != ground) add_to(n, column, -value);
  }
  void voltage(int row, NodeIndex p, NodeIndex n, Wide sign) {
    if (p != ground) a_.g(row, p) += sign;
    if (n != ground) a_.g(row, n) -= sign;
  }
  void resistance(int column, Wide ratio) {
    a_.g(column, column) -= ratio;
    a_.g_data(column, column) += std::abs(a_.g(column, column));
  }
  void conductance(NodeIndex p, NodeIndex n, Wide conductance) {
    for (const NodeIndex column : {p, n}) {
      if (column == ground) continue;
      kcl(p, n, column, column == p ? conductance : -conductance);
      if (conductance > 0.0) continue;
      if (p != ground) a_.g_data(p, column) -= conductance;
      if (n != ground) a_.g_data(n, column) -= conductance;
    }
  }
  void form(int row, const LinearForm& terms, Wide factor) { add(row, a_.row_of(terms), factor); }
  void injection(NodeIndex p, NodeIndex n, const LinearForm& current) {
    const Assembly::FormRow row = a_.row_of(current);
    if (p != ground) add(p, row, static_cast<Wide>(a_.r0));
    if (n != ground) add(n, row, -static_cast<Wide>(a_.r0));
  }
  void contact(int port, NodeIndex p, NodeIndex n, double resistance, double drop);
  /// −slack − u − a = 0 in the place of a diode's v − R0·i − a = 0.
  void complementarity(int port, int index) {
    const int column = a_.unknowns.port(port);
    const auto i = static_cast<std::size_t>(index);
    form(column, a_.network.complementarities[i].slack, -scales_.slack[i]);
    add_to(column, column, -1.0L);
    a_.ha(column, port) = -1.0;
  }
  void stores();

 private:
  void add_to(int row, int column, Wide term) {
    linalg::Doubled sum{a_.g(row, column), a_.g_rest(row, column)};
    sum.add(term);
    a_.g(row, column) = sum.value;
    a_.g_rest(row, column) = sum.rest;
  }
  /// Coefficients of the netlist into a row of G, and of H_w.
  void add(int row, const Assembly::FormRow& terms, Wide factor) {
    for (int column = 0; column < a_.unknowns.size(); ++column) {
      const Wide term = factor * terms.z_part[column];
      if (term == 0.0) continue;
      add_to(row, column, term);
      a_.g_data(row, column) += std::abs(term);
    }
    a_.hw.row(row) += factor * terms.zeta_part.transpose();
  }
  void capacitor(int i);
  void inductor_rate(int j);

  Assembly& a_;
  const ComplementarityScales<Wide>& scales_;
};

void Stamps::contact(int port, NodeIndex p, NodeIndex n, double resistance, double drop) {
  const int column = a_.unknowns.port(port);
  kcl(p, n, column, 1.0);
  voltage(column, p, n, 1.0);
  const Wide ratio = static_cast<Wide>(resistance) / a_.r0;
  add_to(column, column, -1.0L);
  add_to(column, column, -ratio);
  a_.g_data(column, column) += std::abs(ratio);
  a_.ha(column, port) = -1.0;
  if (drop != 0.0) a_.hw(column, a_.exosystem->constant()) -= drop;
}

void Stamps::capacitor(int i) {
  const Capacitor& c = a_.network.capacitors[static_cast<std::size_t>(i)];
  const int column = a_.unknowns.capacitor(static_cast<std::size_t>(i));
  const Wide s = std::sqrt(static_cast<Wide>(std::abs(c.capacitance)) * a_.r0 / a_.tau0);
  kcl(c.p, c.n, column, 1.0);
  voltage(column, c.p, c.n, 1.0);
  a_.f(column, i) = -1.0L / s;
  a_.sx(i, column) = std::copysign(1.0L / (s * a_.tau0), static_cast<Wide>(c.capacitance));
}

void Stamps::inductor_rate(int j) {
  const auto store = static_cast<int>(a_.network.capacitors.size()) + j;
  const Wide scale = a_.inductor_factor.col(j).cwiseAbs().maxCoeff();
  const int row = a_.unknowns.rate(j);
  for (int i = 0; i < static_cast<int>(a_.network.inductors.size()); ++i) {
    const int column = a_.unknowns.inductor(i);
    const Wide sign = a_.network.inductors[static_cast<std::size_t>(i)].inductance < 0.0 ? -1.0L : 1.0L;
    a_.g(column, row) -= sign * a_.inductor_factor(i, j) / scale;
    a_.g(row, column) += a_.inductor_factor(i, j) / scale;
    a_.g_data(column, row) = a_.g_data(row, column) = std::abs(a_.inductor_factor(i, j) / scale);
  }
  a_.f(row, store) = -1.0L / scale;
  a_.sx(store, row) = 1.0L / (scale * a_.tau0);
}

void Stamps::stores() {
  for (int i = 0; i < static_cast<int>(a_.network.capacitors.size()); ++i) capacitor(i);
  for (int j = 0; j < static_cast<int>(a_.inductor_factor.cols()); ++j) inductor_rate(j);
  for (int i = 0; i < static_cast<int>(a_.network.inductors.size()); ++i) {
    const Inductor& l = a_.network.inductors[static_cast<std::size_t>(i)];
    kcl(l.p, l.n, a_.unknowns.inductor(i), 1.0);
    voltage(a_.unknowns.inductor(i), l.p, l.n, 1.0);
  }
}

}  // namespace

Assembly::Assembly(const Network& net, bool constant_wanted, Wide input_factor) : network(net) {
  exosystem = std::make_shared<Exosystem>(source_functions(network), constant_wanted || needs_constant(network));
  choose_scales();
  factor_inductances();
  number_unknowns();
  scale_inputs(input_factor);
  const int m = unknowns.size();
  g = WideMatrix::Zero(m, m);
  g_rest = WideMatrix::Zero(m, m);
  g_data = WideMatrix::Zero(m, m);
  f = WideMatrix::Zero(m, stores());
  ha = WideMatrix::Zero(m, unknowns.ports());
  hw = WideMatrix::Zero(m, exosystem->size());
  sx = WideMatrix::Zero(stores(), m);
  Stamps stamps(*this, scales_);
  stamp_resistors<Wide>(network, unknowns, r0, stamps);
  stamps.stores();
  stamp_branches_and_injections(network, unknowns, stamps);
  stamp_ports(network, stamps);
}

double Assembly::low_resistance() const { return tolerance::low_resistance * r0; }

void Assembly::choose_scales() {
  LogMean capacitance, inductance, time;
  for (const auto& c : network.capacitors) capacitance.add(std::abs(c.capacitance));
  for (const auto& l : network.inductors) inductance.add(std::abs(l.inductance));
  // In the middle every resistor is clearly a wire or clearly a leak to the wave ports, and both come out of them as small entries that nothing
  // cancels with. Beside leaks (leaks.hpp) a diode's Roff may be there.
  Range resistance;
  for (const auto& r : network.resistors) resistance.take(r.resistance);
  for (const auto& d : network.diodes) resistance.take(d.resistance);
  for (const auto& s : network.switches)
    if (s.p != s.n) resistance.take(s.resistance);
  const double impedance = std::sqrt(inductance.value() / capacitance.value());
  if (!capacitance.empty() && !inductance.empty()) resistance.take(impedance);
  const bool has_leaks = std::any_of(network.diodes.begin(), network.diodes.end(), [](const auto& d) { return d.is_of_leak; });
  r0 = has_leaks ? resistance.middle_of_gap(least_leak * impedance) : resistance.middle();
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
  unknowns = Unknowns(network, {.low_resistance = low_resistance(),
                                .capacitor_currents = std::vector<char>(network.capacitors.size(), 1),
                                .rates = static_cast<int>(inductor_factor.cols())});
}

void Assembly::scale_inputs(Wide input_factor) {
  scales_ = ComplementarityScales<Wide>(network.complementarities.size());
  scales_ = scale_complementarities<Wide>(network, r0, [&](const LinearForm& slack) {
    const WideVector row = row_of(slack).z_part;
    Wide largest = 0.0;
    for (int j = 0; j < unknowns.size(); ++j)
      if (!unknowns.is_input(j)) largest = std::max(largest, std::abs(row[j]));
    return largest;
  });
  for (Wide& scale : scales_.input) scale /= input_factor;
}

Assembly::FormRow Assembly::row_of(const LinearForm& form) const {
  struct Sum {
    const Assembly& assembly;
    FormRow row;

    void constant(Wide c) {
      if (c != 0.0) row.zeta_part[assembly.exosystem->constant()] += c;
    }
    void source(int i, Wide c) { row.zeta_part += c * assembly.exosystem->rows().row(i).transpose().cast<Wide>(); }
    void unknown(int column, Wide c) { row.z_part[column] += c; }
    void inductor_current(int i, Wide c) { row.z_part[assembly.unknowns.inductor(i)] += c / assembly.r0; }
  };
  Sum sum{*this, {WideVector::Zero(unknowns.size()), WideVector::Zero(exosystem->size())}};
  write_form(network, unknowns, r0, scales_.input, form, sum);
  return std::move(sum.row);
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

std::vector<Equations::StorePort> Assembly::store_ports() const {
  std::vector<Equations::StorePort> ports;
  for (std::size_t i = 0; i < network.capacitors.size(); ++i)
    ports.push_back({network.capacitors[i].p, network.capacitors[i].n, unknowns.capacitor(i)});
  for (std::size_t i = 0; i < network.inductors.size(); ++i)
    ports.push_back({network.inductors[i].p, network.inductors[i].n, unknowns.inductor(static_cast<int>(i))});
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

double Assembly::current_unit(int port) const {
  if (!unknowns.is_input(unknowns.port(port))) return 1.0 / r0;
  return static_cast<double>(scales_.input[static_cast<std::size_t>(port - unknowns.first_complementarity())]);
}

double Assembly::voltage_unit(int port) const {
  if (!unknowns.is_input(unknowns.port(port))) return 1.0;
  return static_cast<double>(1.0L / scales_.slack[static_cast<std::size_t>(port - unknowns.first_complementarity())]);
}

}  // namespace pwlsim::model
