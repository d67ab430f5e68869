#include "engine/sparse/descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/sparse/tolerances.hpp"
#include "model/certificate.hpp"
#include "model/forms.hpp"

namespace pwlsim::engine::sparse {

namespace {

using model::ground;
using model::NodeIndex;

/// Nodes between which voltages are known, the rest at zero. What contradicts what is known is left out.
class Potentials {
 public:
  explicit Potentials(std::size_t nodes) : parent_(nodes + 1), above_(nodes + 1, 0.0) { std::iota(parent_.begin(), parent_.end(), 0U); }
  void join(NodeIndex p, NodeIndex n, double voltage) {
    const auto [root_p, above_p] = find(p);
    const auto [root_n, above_n] = find(n);
    if (root_p == root_n) return;
    // ground stays the root of its part
    const bool first = root_p == parent_.size() - 1;
    parent_[first ? root_n : root_p] = first ? root_p : root_n;
    above_[first ? root_n : root_p] = first ? above_p - voltage - above_n : above_n + voltage - above_p;
  }
  [[nodiscard]] double at(NodeIndex node) { return find(node).second; }

 private:
  /// Its root, and by how much it lies above that.
  std::pair<std::size_t, double> find(NodeIndex node) {
    const std::size_t start = node == ground ? parent_.size() - 1 : static_cast<std::size_t>(node);
    std::size_t root = start;
    double above = 0.0;
    while (parent_[root] != root) {
      above += above_[root];
      root = parent_[root];
    }
    parent_[start] = root;
    above_[start] = start == root ? 0.0 : above;
    return {root, above};
  }
  std::vector<std::size_t> parent_;
  std::vector<double> above_;
};

std::vector<char> capacitors_read(const model::Network& network) {
  std::vector<char> read(network.capacitors.size(), 0);
  const auto note = [&](const model::LinearForm& form) {
    for (const model::Term& term : form)
      if (term.kind == model::Term::Kind::capacitor_current) read[static_cast<std::size_t>(term.index)] = 1;
  };
  model::for_each_equation(network, note);
  for (const auto& s : network.switches) note(s.control);
  for (const auto& s : network.signals) note(s.form);
  return read;
}

/// The mean of sqrt(L/C), else of the resistances. Those across diodes and switches say how well they block, not what flows elsewhere: they count where
/// there are no others.
double scale_of(const model::Network& network) {
  LogMean capacitance, inductance, resistance, blocking;
  for (const auto& c : network.capacitors) capacitance.add(std::abs(c.capacitance));
  for (const auto& l : network.inductors) inductance.add(std::abs(l.inductance));
  std::set<std::pair<NodeIndex, NodeIndex>> across;
  for (const auto& d : network.diodes) across.insert(std::minmax(d.p, d.n));
  for (const auto& s : network.switches) across.insert(std::minmax(s.p, s.n));
  for (const auto& r : network.resistors) (across.contains(std::minmax(r.p, r.n)) ? blocking : resistance).add(std::abs(r.resistance));
  const bool rings = !capacitance.empty() && !inductance.empty();
  return rings ? std::sqrt(inductance.value() / capacitance.value()) : (resistance.empty() ? blocking : resistance).value();
}

}  // namespace

/// Writes what elements put into E, G, H, g and closing rows.
class Descriptor::Stamps {
 public:
  explicit Stamps(Descriptor& descriptor) : d_(descriptor) {}

  void entry(int row, int column, double e, double g) { d_.places_.push_back({row, column, e, g, 0.0, 0.0}); }
  void kcl(NodeIndex p, NodeIndex n, int column, double g, double e = 0.0) {
    for (const FloatingSets::Cut& cut : d_.sets_.cuts(p, n)) entry(cut.row, column, cut.sign * e, cut.sign * g);
  }
  void voltage(int row, NodeIndex p, NodeIndex n, double sign) {
    if (p != ground) entry(row, p, 0.0, sign);
    if (n != ground) entry(row, n, 0.0, -sign);
  }
  void resistance(int column, double ratio) { entry(column, column, 0.0, -ratio); }
  void conductance(NodeIndex p, NodeIndex n, double conductance) {
    if (p != ground) kcl(p, n, p, conductance);
    if (n != ground) kcl(p, n, n, -conductance);
  }
  void form(int row, const model::LinearForm& terms, double factor) {
    const Form f = d_.form(terms);
    for (const auto& part : f.z) entry(row, part.index, 0.0, factor * part.coefficient);
    for (const auto& part : f.w) d_.sources_.push_back({row, part.index, factor * part.coefficient});
    d_.constant_[static_cast<std::size_t>(row)] += factor * f.constant;
  }
  void injection(NodeIndex p, NodeIndex n, const model::LinearForm& current) {
    for (const FloatingSets::Cut& cut : d_.sets_.cuts(p, n)) form(cut.row, current, cut.sign * d_.r0_);
  }
  void contact(int port, NodeIndex p, NodeIndex n, double resistance, double drop) {
    const int row = d_.unknowns_.port(port);
    kcl(p, n, row, 1.0);
    Form slack;
    if (p != ground) slack.z.push_back({p, -1.0});
    if (n != ground) slack.z.push_back({n, 1.0});
    if (resistance != 0.0) slack.z.push_back({row, resistance / d_.r0_});
    slack.constant = drop;
    close(port, std::move(slack), p, n);
  }
  void complementarity(int port, int index) {
    const auto i = static_cast<std::size_t>(index);
    Form slack = d_.form(d_.network_.complementarities[i].slack);
    for (auto* parts : {&slack.z, &slack.w})
      for (auto& part : *parts) part.coefficient *= d_.scales_.slack[i];
    slack.constant *= d_.scales_.slack[i];
    close(port, std::move(slack), ground, ground);
  }

 private:
  void close(int number, Form slack, NodeIndex p, NodeIndex n) {
    const int row = d_.unknowns_.port(number);
    for (const auto& part : slack.z) d_.places_.push_back({row, part.index, 0.0, 0.0, part.coefficient, 0.0});
    d_.places_.push_back({row, row, 0.0, 0.0, 0.0, 1.0});
    d_.ports_.push_back({d_.unknowns_.port_label(number).name, row, std::move(slack), number >= d_.first_switch(), {}, p, n});
  }

  Descriptor& d_;
};

Descriptor::Descriptor(const model::Network& network, Steps steps)
    : network_(network), r0_(scale_of(network)), sets_(network, r0_, steps == Steps::to_rest), windings_(network) {
  number_unknowns();
  constant_.assign(static_cast<std::size_t>(size()), 0.0);
  Stamps stamps(*this);
  model::stamp_resistors<double>(network_, unknowns_, r0_, stamps);
  add_stores();
  model::stamp_branches_and_injections(network_, unknowns_, stamps);
  model::stamp_ports(network_, stamps);
  note_valves();
  note_conductances();
  compress();
  note_leaks();
}

void Descriptor::number_unknowns() {
  unknowns_ =
      model::Unknowns(network_, {.low_resistance = tolerance::low_resistance * r0_, .capacitor_currents = capacitors_read(network_)});
  scale_complementarities();
}

void Descriptor::scale_complementarities() {
  scales_ = model::ComplementarityScales<double>(network_.complementarities.size());
  scales_ = model::scale_complementarities<double>(network_, r0_, [&](const model::LinearForm& slack) {
    double largest = 0.0;
    for (const auto& part : form(slack).z)
      if (!unknowns_.is_input(part.index)) largest = std::max(largest, std::abs(part.coefficient));
    return largest;
  });
}

void Descriptor::add_stores() {
  Stamps stamps(*this);
  capacitor_of_row_.assign(static_cast<std::size_t>(size()), -1);
  for (std::size_t i = 0; i < network_.capacitors.size(); ++i) {
    const auto& c = network_.capacitors[i];
    const double e = r0_ * c.capacitance;
    largest_capacitance_ = std::max(largest_capacitance_, std::abs(e));
    const int own = unknowns_.capacitor(i);
    states_.push_back({c.p, c.n, false, c.capacitance});
    if (own >= 0) {
      capacitor_of_row_[static_cast<std::size_t>(own)] = static_cast<int>(i);
      stamps.kcl(c.p, c.n, own, 1.0);
      stamps.entry(own, own, 0.0, -1.0);
    }
    for (const auto& [node, sign] : {std::pair{c.p, 1.0}, std::pair{c.n, -1.0}}) {
      if (node == ground) continue;
      if (own >= 0)
        stamps.entry(own, node, sign * e, 0.0);
      else
        stamps.kcl(c.p, c.n, node, 0.0, sign * e);
    }
  }
  add_inductors();
}

void Descriptor::add_inductors() {
  Stamps stamps(*this);
  for (int i = 0; i < static_cast<int>(network_.inductors.size()); ++i) {
    const int own = unknowns_.inductor(i);
    states_.push_back({own, -1, true, network_.inductors[static_cast<std::size_t>(i)].inductance});
    const Windings::Sum& current = windings_.current(i);
    if (current.size() > 1 || windings_.coordinate(i).size() > 1)
      for (const auto& share : current) states_.back().current.push_back({unknowns_.inductor(share.index), share.weight});
    for (const auto& share : windings_.voltages(i)) {
      const auto& l = network_.inductors[static_cast<std::size_t>(share.index)];
      stamps.kcl(l.p, l.n, own, share.weight);
      stamps.voltage(own, l.p, l.n, -share.weight);
    }
    stamps.entry(own, own, windings_.inductance(i) / r0_, 0.0);
  }
  measure_fluxes();
}

void Descriptor::measure_fluxes() {
  for (const auto& k : network_.couplings) {
    if (std::abs(k.coefficient) <= tolerance::perfect_coupling) continue;
    for (const int i : {k.inductor_a, k.inductor_b}) {
      auto& flux = states_[network_.capacitors.size() + static_cast<std::size_t>(i)].flux;
      if (!flux.empty()) continue;
      for (const auto& share : windings_.flux(i)) flux.push_back({unknowns_.inductor(share.index), share.weight});
    }
  }
}

bool Descriptor::passive() const {
  return model::has_passive_parts_only(network_) &&
         std::all_of(network_.capacitors.begin(), network_.capacitors.end(), [](const auto& c) { return c.capacitance >= 0.0; }) &&
         std::all_of(network_.inductors.begin(), network_.inductors.end(), [](const auto& l) { return l.inductance >= 0.0; });
}

void Descriptor::note_valves() {
  for (std::size_t i = 0; i < network_.diodes.size(); ++i)
    if (const std::vector<int>& switches = network_.diodes[i].enabled_by; !switches.empty()) {
      for (const int s : switches) ports_[i].enabled_by.push_back(first_switch() + s);
      valves_.push_back(static_cast<int>(i));
    }
}

void Descriptor::note_conductances() {
  std::vector<double> sum(network_.nodes.size(), 0.0);
  for (std::size_t i = 0; i < network_.resistors.size(); ++i)
    for (const NodeIndex node : {network_.resistors[i].p, network_.resistors[i].n})
      if (node != ground && unknowns_.low_resistor(i) < 0)
        sum[static_cast<std::size_t>(node)] += r0_ / std::abs(network_.resistors[i].resistance);
  conductance_at_port_ = at_ports(sum);
}

void Descriptor::compress() {
  linalg::PatternBuilder builder(size());
  for (const Place& place : places_) builder.add(place.row, place.column);
  std::vector<int> entry_of_place;
  pattern_ = builder.take(entry_of_place);
  for (auto* values : {&e_, &g_, &slack_, &input_}) values->assign(pattern_.entries(), 0.0);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const auto k = static_cast<std::size_t>(entry_of_place[i]);
    e_[k] += places_[i].e;
    g_[k] += places_[i].g;
    slack_[k] += places_[i].slack;
    input_[k] += places_[i].input;
  }
  for (std::size_t k = 0; k < pattern_.entries(); ++k)
    if (pattern_.row[k] >= unknowns_.port(0)) {
      port_entries_.push_back(static_cast<int>(k));
      port_of_entry_.push_back(pattern_.row[k] - unknowns_.port(0));
    }
  places_ = {};
  memory_ = linalg::without_zeros(pattern_, e_);
  conduction_ = linalg::without_zeros(pattern_, g_);
  first_current_ = static_cast<std::size_t>(pattern_.start[static_cast<std::size_t>(nodes())]);
  for (int j = 0; j < nodes(); ++j)
    for (int k = pattern_.start[static_cast<std::size_t>(j)]; k < pattern_.start[static_cast<std::size_t>(j) + 1]; ++k)
      if (pattern_.row[static_cast<std::size_t>(k)] == j) node_diagonal_.push_back(k);
}

/// Of all that meets at a node, times R0.
std::vector<double> Descriptor::node_admittances(double shift) const {
  std::vector<double> sum(network_.nodes.size(), 0.0);
  const auto add = [&](NodeIndex p, NodeIndex n, double admittance) {
    for (const NodeIndex node : {p, n})
      if (node != ground) sum[static_cast<std::size_t>(node)] += std::abs(admittance);
  };
  for (const auto& r : network_.resistors) add(r.p, r.n, r0_ / r.resistance);
  for (const auto& c : network_.capacitors) add(c.p, c.n, shift * r0_ * c.capacitance);
  for (const auto& l : network_.inductors) add(l.p, l.n, r0_ / (shift * l.inductance));
  return sum;
}

Descriptor::Closing Descriptor::closing(double shift, const Position& on, double epsilon) const {
  Closing closing{std::vector<double>(on.size()), std::vector<double>(on.size())};
  const double unit = epsilon != 0.0 ? mean_admittance(shift) : 1.0;
  for (std::size_t i = 0; i < on.size(); ++i) {
    closing.of_slack[i] = on[i] != 0 ? 1.0 : epsilon;
    closing.of_input[i] = on[i] != 0 ? epsilon / unit : 1.0;
  }
  return closing;
}

/// Of every port the larger value of its nodes.
std::vector<double> Descriptor::at_ports(const std::vector<double>& of_nodes) const {
  std::vector<double> result(ports_.size(), 0.0);
  for (std::size_t i = 0; i < ports_.size(); ++i)
    for (const NodeIndex node : {ports_[i].p, ports_[i].n})
      if (node != ground) result[i] = std::max(result[i], of_nodes[static_cast<std::size_t>(node)]);
  return result;
}

double Descriptor::tie(double shift, const Position& on, const std::vector<int>& ports, Closing& closing) const {
  const std::vector<double> admittances = node_admittances(shift);
  const std::vector<double> around = at_ports(admittances);
  const double mean = mean_admittance(shift);
  for (const int port : ports) {
    const auto i = static_cast<std::size_t>(port);
    const double admittance = around[i] > 0.0 ? around[i] : mean;
    (on[i] != 0 ? closing.of_input : closing.of_slack)[i] =
        on[i] != 0 ? tolerance::tie_share / admittance : tolerance::tie_share * admittance;
  }
  return admittances.empty() ? 0.0 : *std::max_element(admittances.begin(), admittances.end());
}

void Descriptor::matrix(double shift, const Closing& closing, double unit, std::vector<double>& values) const {
  values.resize(pattern_.entries());
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = shift * e_[k] + g_[k];
  for (std::size_t i = 0; i < port_entries_.size(); ++i) {
    const auto k = static_cast<std::size_t>(port_entries_[i]);
    const auto port = static_cast<std::size_t>(port_of_entry_[i]);
    values[k] = closing.of_slack[port] * slack_[k] + closing.of_input[port] * input_[k];
  }
  if (unit == 1.0) return;
  for (std::size_t k = first_current_; k < values.size(); ++k) values[k] *= unit;
}

double Descriptor::mean_admittance(double shift) const {
  LogMean mean;
  for (const int k : node_diagonal_) mean.add(std::abs(shift * e_[static_cast<std::size_t>(k)] + g_[static_cast<std::size_t>(k)]));
  return mean.value();
}

void Descriptor::measure_states(const double* z, std::vector<double>& states) const {
  states.clear();
  for (const State& state : states_) states.push_back(state.measure(z));
}

void Descriptor::rates(const double* z, const double* w, double* k) const {
  rates_without_sources(z, k);
  add_sources(w, k);
}

void Descriptor::rates_without_sources(const double* z, double* k) const {
  conduct(z, k);
  add_constants(1.0, k);
}

void Descriptor::conduct(const double* z, double* k) const {
  linalg::multiply(conduction_.pattern, conduction_.values, z, k);
  for (int i = 0; i < size(); ++i) k[i] = -k[i];
}

void Descriptor::add_constants(double factor, double* k) const {
  for (int i = 0; i < size(); ++i) k[i] -= factor * constant_[static_cast<std::size_t>(i)];
}

std::vector<char> Descriptor::differential_rows() const {
  std::vector<char> result(static_cast<std::size_t>(size()), 0);
  for (const int row : memory_.pattern.row) result[static_cast<std::size_t>(row)] = 1;
  return result;
}

std::vector<double> Descriptor::memory_diagonal() const {
  std::vector<double> result(static_cast<std::size_t>(size()), 0.0);
  for (std::size_t j = 0; j < result.size(); ++j)
    for (int e = memory_.pattern.start[j]; e < memory_.pattern.start[j + 1]; ++e)
      if (memory_.pattern.row[static_cast<std::size_t>(e)] == static_cast<int>(j)) result[j] += memory_.values[static_cast<std::size_t>(e)];
  for (std::size_t row = 0; row < result.size(); ++row)
    if (const int i = capacitor_of_row_[row]; i >= 0) result[row] = r0_ * network_.capacitors[static_cast<std::size_t>(i)].capacitance;
  return result;
}

/// The error of a capacitor's current is one of the charge that flows from node to node: it counts with the voltage between them.
double Descriptor::weight(const std::vector<double>& a, std::size_t row) const {
  const int i = capacitor_of_row_[row];
  return i >= 0 ? states_[static_cast<std::size_t>(i)].value(a.data()) : sets_.weight(a, row);
}

double Descriptor::product(const std::vector<double>& a, const std::vector<double>& y) const {
  double sum = 0.0;
  for (std::size_t row = 0; row < y.size(); ++row) sum += weight(a, row) * y[row];
  return sum;
}

double Descriptor::largest_product(const std::vector<double>& a, const std::vector<double>& y) const {
  double sum = 0.0;
  for (std::size_t row = 0; row < y.size(); ++row) sum += std::abs(weight(a, row) * y[row]);
  return sum;
}

void Descriptor::add_sources(const double* w, double* k) const {
  for (const SourceEntry& entry : sources_) k[entry.row] -= entry.coefficient * w[entry.source];
}

void Descriptor::rate_sizes(const double* z, const double* w, double* sizes) const {
  linalg::multiply_absolute(conduction_.pattern, conduction_.values, z, sizes);
  for (int i = 0; i < size(); ++i) sizes[i] += std::abs(constant_[static_cast<std::size_t>(i)]);
  for (const SourceEntry& entry : sources_) sizes[entry.row] += std::abs(entry.coefficient * w[entry.source]);
}

bool Descriptor::unknowns_of_states(const std::vector<double>& values, const std::vector<double>& w, const Position& on,
                                    std::vector<double>& z, std::vector<double>& y) const {
  z.assign(static_cast<std::size_t>(size()), 0.0);
  y.assign(static_cast<std::size_t>(size()), 0.0);
  const std::size_t capacitors = network_.capacitors.size();
  for (int i = 0; i < static_cast<int>(network_.inductors.size()); ++i)
    for (const auto& share : windings_.coordinate(i))
      z[static_cast<std::size_t>(unknowns_.inductor(i))] += share.weight * values[capacitors + static_cast<std::size_t>(share.index)];
  Potentials potentials(network_.nodes.size());
  for (std::size_t i = 0; i < capacitors; ++i) potentials.join(states_[i].plus, states_[i].minus, values[i]);
  for (const auto& branch : network_.branches)
    if (model::is_independent(branch.voltage)) potentials.join(branch.p, branch.n, form(branch.voltage).value(nullptr, w.data()));
  for (std::size_t i = static_cast<std::size_t>(first_switch()); i < ports_.size(); ++i)
    if (on[i] != 0) potentials.join(ports_[i].p, ports_[i].n, 0.0);
  for (int node = 0; node < nodes(); ++node) z[static_cast<std::size_t>(node)] = potentials.at(node);
  bool remains = false;
  for (std::size_t i = 0; i < capacitors; ++i) {
    const auto at = [&](int node) { return node >= 0 ? z[static_cast<std::size_t>(node)] : 0.0; };
    const double missing = values[i] - states_[i].value(z.data());
    if (std::abs(missing) <=
        tolerance::capacitor_loop * std::max({std::abs(values[i]), std::abs(at(states_[i].plus)), std::abs(at(states_[i].minus))}))
      continue;
    remains = true;
    const double charge = r0_ * states_[i].storage * missing;
    const int own = unknowns_.capacitor(i);
    if (own >= 0)
      y[static_cast<std::size_t>(own)] += charge;
    else
      for (const FloatingSets::Cut& cut : sets_.cuts(states_[i].plus, states_[i].minus))
        y[static_cast<std::size_t>(cut.row)] += cut.sign * charge;
  }
  return remains;
}

Form Descriptor::form(const model::LinearForm& terms) const {
  struct Sum {
    const Descriptor& descriptor;
    Form form;

    void constant(double c) { form.constant += c; }
    void source(int i, double c) { form.w.push_back({i, c}); }
    void unknown(int column, double c) { form.z.push_back({column, c}); }
    void inductor_current(int i, double c) {
      for (const auto& share : descriptor.windings_.current(i))
        unknown(descriptor.unknowns_.inductor(share.index), share.weight * c / descriptor.r0_);
    }
  };
  Sum sum{*this, {}};
  model::write_form(network_, unknowns_, r0_, scales_.input, terms, sum);
  return std::move(sum.form);
}

std::string Descriptor::unknown_name(int index) const {
  if (index < nodes()) return "node " + network_.nodes[static_cast<std::size_t>(index)].name;
  return unknowns_.owner(index)->name;
}

}  // namespace pwlsim::engine::sparse
