#include "engine/sparse/descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "base/log_mean.hpp"
#include "model/forms.hpp"

namespace pwlsim::engine::sparse {

namespace {

using model::ground;
using model::NodeIndex;
using model::Term;

/// Resistors below this fraction of R0 carry their own current.
constexpr double low_resistance = 1e-6;
constexpr double tie_share = 1e-3;  ///< of what is around
/// Start values of a loop of capacitors agree to this part of the largest voltage in it.
constexpr double loop_tolerance = 1e-13;

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
    for (const Term& term : form)
      if (term.kind == Term::Kind::capacitor_current) read[static_cast<std::size_t>(term.index)] = 1;
  };
  model::for_each_equation(network, note);
  for (const auto& s : network.switches) note(s.control);
  for (const auto& s : network.signals) note(s.form);
  return read;
}

}  // namespace

Descriptor::Descriptor(const model::Network& network) : network_(network), sets_(network), windings_(network) {
  choose_scale();
  number_unknowns();
  constant_.assign(static_cast<std::size_t>(size_), 0.0);
  add_resistors();
  add_stores();
  add_branches_and_injections();
  add_ports();
  note_conductances();
  compress();
}

/// The mean of sqrt(L/C), else of the resistances. Those across diodes and switches say how well they block, not what flows elsewhere: they count where
/// there are no others.
void Descriptor::choose_scale() {
  LogMean capacitance, inductance, resistance, blocking;
  for (const auto& c : network_.capacitors) capacitance.add(std::abs(c.capacitance));
  for (const auto& l : network_.inductors) inductance.add(std::abs(l.inductance));
  std::set<std::pair<NodeIndex, NodeIndex>> across;
  for (const auto& d : network_.diodes) across.insert(std::minmax(d.p, d.n));
  for (const auto& s : network_.switches) across.insert(std::minmax(s.p, s.n));
  for (const auto& r : network_.resistors) (across.contains(std::minmax(r.p, r.n)) ? blocking : resistance).add(std::abs(r.resistance));
  const bool rings = !capacitance.empty() && !inductance.empty();
  r0_ = rings ? std::sqrt(inductance.value() / capacitance.value()) : (resistance.empty() ? blocking : resistance).value();
}

void Descriptor::number_unknowns() {
  int next = static_cast<int>(network_.nodes.size());
  for (const auto& r : network_.resistors) low_resistor_.push_back(std::abs(r.resistance) < low_resistance * r0_ ? next++ : -1);
  for (const char read : capacitors_read(network_)) capacitor_current_.push_back(read != 0 ? next++ : -1);
  first_inductor_ = next;
  first_branch_ = first_inductor_ + static_cast<int>(network_.inductors.size());
  first_port_ = first_branch_ + static_cast<int>(network_.branches.size());
  first_switch_ = static_cast<int>(network_.diodes.size() + network_.complementarities.size());
  size_ = first_port_ + first_switch_ + static_cast<int>(network_.switches.size());
  input_scale_.assign(network_.complementarities.size(), 1.0);
  slack_scale_.assign(network_.complementarities.size(), 1.0);
  scale_complementarities();
}

/// Largest coefficients become one: of an input where it is a voltage or a current, else in the slacks that hold it; of a slack in its row.
void Descriptor::scale_complementarities() {
  std::vector<double> in_circuit(input_scale_.size(), 0.0), in_slacks(input_scale_.size(), 0.0);
  const auto weigh = [](std::vector<double>& largest, const model::LinearForm& form, double factor) {
    for (const Term& term : form)
      if (term.kind == Term::Kind::slack_input) {
        double& l = largest[static_cast<std::size_t>(term.index)];
        l = std::max(l, std::abs(factor * term.coefficient));
      }
  };
  for (const auto& b : network_.branches) weigh(in_circuit, b.voltage, 1.0);
  for (const auto& i : network_.injections) weigh(in_circuit, i.current, r0_);
  for (std::size_t i = 0; i < slack_scale_.size(); ++i) {
    const model::LinearForm& terms = network_.complementarities[i].slack;
    double largest = 0.0;
    for (const auto& part : form(terms).z)
      if (part.index < first_port_ + static_cast<int>(network_.diodes.size()) || part.index >= first_port_ + first_switch_)
        largest = std::max(largest, std::abs(part.coefficient));
    if (largest > 0.0) slack_scale_[i] = 1.0 / largest;
    weigh(in_slacks, terms, slack_scale_[i]);
  }
  for (std::size_t i = 0; i < input_scale_.size(); ++i) {
    const double largest = in_circuit[i] > 0.0 ? in_circuit[i] : in_slacks[i];
    if (largest > 0.0) input_scale_[i] = 1.0 / largest;
  }
}

void Descriptor::entry(int row, int column, double e, double g) { places_.push_back({row, column, e, g, 0.0, 0.0}); }

void Descriptor::entry_of_port(int row, int column, double slack, double input) {
  places_.push_back({row, column, 0.0, 0.0, slack, input});
}

void Descriptor::add_kcl(NodeIndex p, NodeIndex n, int column, double g, double e) {
  for (const FloatingSets::Cut& cut : sets_.cuts(p, n)) entry(cut.row, column, cut.sign * e, cut.sign * g);
}

void Descriptor::add_voltage(int row, NodeIndex p, NodeIndex n, double sign) {
  if (p != ground) entry(row, p, 0.0, sign);
  if (n != ground) entry(row, n, 0.0, -sign);
}

void Descriptor::add_form(int row, const model::LinearForm& terms, double factor) {
  const Form f = form(terms);
  for (const auto& part : f.z) entry(row, part.index, 0.0, factor * part.coefficient);
  for (const auto& part : f.w) sources_.push_back({row, part.index, factor * part.coefficient});
  constant_[static_cast<std::size_t>(row)] += factor * f.constant;
}

void Descriptor::add_resistors() {
  for (std::size_t i = 0; i < network_.resistors.size(); ++i) {
    const auto& r = network_.resistors[i];
    const int low = low_resistor_[i];
    if (low >= 0) {
      add_kcl(r.p, r.n, low, 1.0);
      add_voltage(low, r.p, r.n, 1.0);
      entry(low, low, 0.0, -r.resistance / r0_);
      continue;
    }
    const double conductance = r0_ / r.resistance;
    if (r.p != ground) add_kcl(r.p, r.n, r.p, conductance);
    if (r.n != ground) add_kcl(r.p, r.n, r.n, -conductance);
  }
}

void Descriptor::add_stores() {
  for (std::size_t i = 0; i < network_.capacitors.size(); ++i) {
    const auto& c = network_.capacitors[i];
    const double e = r0_ * c.capacitance;
    largest_capacitance_ = std::max(largest_capacitance_, std::abs(e));
    const int own = capacitor_current_[i];
    states_.push_back({c.p, c.n, false, c.capacitance});
    if (own >= 0) {
      add_kcl(c.p, c.n, own, 1.0);
      entry(own, own, 0.0, -1.0);
    }
    for (const auto& [node, sign] : {std::pair{c.p, 1.0}, std::pair{c.n, -1.0}}) {
      if (node == ground) continue;
      if (own >= 0)
        entry(own, node, sign * e, 0.0);
      else
        add_kcl(c.p, c.n, node, 0.0, sign * e);
    }
  }
  add_inductors();
}

void Descriptor::add_inductors() {
  for (int i = 0; i < static_cast<int>(network_.inductors.size()); ++i) {
    const int own = first_inductor_ + i;
    states_.push_back({own, -1, true, network_.inductors[static_cast<std::size_t>(i)].inductance});
    const Windings::Sum& current = windings_.current(i);
    if (current.size() > 1 || windings_.coordinate(i).size() > 1)
      for (const auto& share : current) states_.back().current.push_back({first_inductor_ + share.index, share.weight});
    for (const auto& share : windings_.voltages(i)) {
      const auto& l = network_.inductors[static_cast<std::size_t>(share.index)];
      add_kcl(l.p, l.n, own, share.weight);
      add_voltage(own, l.p, l.n, -share.weight);
    }
    entry(own, own, windings_.inductance(i) / r0_, 0.0);
  }
  measure_fluxes();
}

void Descriptor::measure_fluxes() {
  for (const auto& k : network_.couplings) {
    if (std::abs(k.coefficient) <= perfect_coupling) continue;
    for (const int i : {k.inductor_a, k.inductor_b}) {
      auto& flux = states_[network_.capacitors.size() + static_cast<std::size_t>(i)].flux;
      if (!flux.empty()) continue;
      for (const auto& share : windings_.flux(i)) flux.push_back({first_inductor_ + share.index, share.weight});
    }
  }
}

bool Descriptor::passive() const {
  const auto by_sources = [](const model::LinearForm& form) { return model::is_independent(form); };
  const auto all = [](const auto& list, const auto& test) { return std::all_of(list.begin(), list.end(), test); };
  int branch = 0;
  const auto is_source = [&](const model::Branch& b) {  // with a resistance of its own
    const int own = branch++;
    return std::all_of(b.voltage.begin(), b.voltage.end(), [&](const Term& t) {
      return model::is_independent(t) || (t.kind == Term::Kind::branch_current && t.index == own && t.coefficient >= 0.0);
    });
  };
  return network_.complementarities.empty() && all(network_.branches, is_source) &&
         all(network_.injections, [&](const auto& i) { return by_sources(i.current); }) &&
         all(network_.resistors, [](const auto& r) { return r.resistance >= 0.0; }) &&
         all(network_.capacitors, [](const auto& c) { return c.capacitance >= 0.0; }) &&
         all(network_.inductors, [](const auto& l) { return l.inductance >= 0.0; }) &&
         all(network_.diodes, [](const auto& d) { return d.resistance >= 0.0; }) &&
         all(network_.switches, [](const auto& s) { return s.resistance >= 0.0; });
}

void Descriptor::add_branches_and_injections() {
  for (std::size_t i = 0; i < network_.branches.size(); ++i) {
    const auto& b = network_.branches[i];
    const int own = first_branch_ + static_cast<int>(i);
    add_kcl(b.p, b.n, own, 1.0);
    add_voltage(own, b.p, b.n, 1.0);
    add_form(own, b.voltage, -1.0);
  }
  for (const auto& i : network_.injections)
    for (const FloatingSets::Cut& cut : sets_.cuts(i.p, i.n)) add_form(cut.row, i.current, cut.sign * r0_);
}

void Descriptor::add_port(std::string name, int row, const model::LinearForm* slack, double slack_scale, NodeIndex p, NodeIndex n,
                          double resistance, double drop) {
  Port port{std::move(name), row, {}, false, {}, p, n};
  if (slack) {
    port.slack = form(*slack);
    for (auto& part : port.slack.z) part.coefficient *= slack_scale;
    for (auto& part : port.slack.w) part.coefficient *= slack_scale;
    port.slack.constant *= slack_scale;
  } else {
    add_kcl(p, n, row, 1.0);
    if (p != ground) port.slack.z.push_back({p, -1.0});
    if (n != ground) port.slack.z.push_back({n, 1.0});
    if (resistance != 0.0) port.slack.z.push_back({row, resistance / r0_});
    port.slack.constant = drop;
  }
  for (const auto& part : port.slack.z) entry_of_port(row, part.index, part.coefficient, 0.0);
  entry_of_port(row, row, 0.0, 1.0);
  ports_.push_back(std::move(port));
}

void Descriptor::add_ports() {
  int row = first_port_;
  for (const auto& d : network_.diodes) {
    add_port(d.label.name, row++, nullptr, 1.0, d.p, d.n, d.resistance, d.drop);
    for (const int s : d.enabled_by) ports_.back().enabled_by.push_back(first_switch_ + s);
    if (!d.enabled_by.empty()) valves_.push_back(static_cast<int>(ports_.size()) - 1);
  }
  for (std::size_t i = 0; i < network_.complementarities.size(); ++i)
    add_port(network_.complementarities[i].label.name, row++, &network_.complementarities[i].slack, slack_scale_[i], ground, ground, 0.0,
             0.0);
  for (const auto& s : network_.switches) {
    add_port(s.label.name, row++, nullptr, 1.0, s.p, s.n, s.resistance, s.drop);
    ports_.back().is_switch = true;
  }
}

void Descriptor::note_conductances() {
  std::vector<double> sum(network_.nodes.size(), 0.0);
  for (std::size_t i = 0; i < network_.resistors.size(); ++i)
    for (const NodeIndex node : {network_.resistors[i].p, network_.resistors[i].n})
      if (node != ground && low_resistor_[i] < 0) sum[static_cast<std::size_t>(node)] += r0_ / std::abs(network_.resistors[i].resistance);
  conductance_at_port_ = at_ports(sum);
}

void Descriptor::compress() {
  linalg::PatternBuilder builder(size_);
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
    if (pattern_.row[k] >= first_port_) {
      port_entries_.push_back(static_cast<int>(k));
      port_of_entry_.push_back(pattern_.row[k] - first_port_);
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
  const double unit = mean_admittance(shift);
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
    (on[i] != 0 ? closing.of_input : closing.of_slack)[i] = on[i] != 0 ? tie_share / admittance : tie_share * admittance;
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
  for (int i = 0; i < size_; ++i) k[i] = -k[i];
}

void Descriptor::add_constants(double factor, double* k) const {
  for (int i = 0; i < size_; ++i) k[i] -= factor * constant_[static_cast<std::size_t>(i)];
}

std::vector<char> Descriptor::differential_rows() const {
  std::vector<char> result(static_cast<std::size_t>(size_), 0);
  for (const int row : memory_.pattern.row) result[static_cast<std::size_t>(row)] = 1;
  return result;
}

std::vector<double> Descriptor::memory_diagonal() const {
  std::vector<double> result(static_cast<std::size_t>(size_), 0.0);
  for (std::size_t j = 0; j < result.size(); ++j)
    for (int e = memory_.pattern.start[j]; e < memory_.pattern.start[j + 1]; ++e)
      if (memory_.pattern.row[static_cast<std::size_t>(e)] == static_cast<int>(j)) result[j] += memory_.values[static_cast<std::size_t>(e)];
  return result;
}

void Descriptor::add_sources(const double* w, double* k) const {
  for (const SourceEntry& entry : sources_) k[entry.row] -= entry.coefficient * w[entry.source];
}

void Descriptor::rate_sizes(const double* z, const double* w, double* sizes) const {
  linalg::multiply_absolute(conduction_.pattern, conduction_.values, z, sizes);
  for (int i = 0; i < size_; ++i) sizes[i] += std::abs(constant_[static_cast<std::size_t>(i)]);
  for (const SourceEntry& entry : sources_) sizes[entry.row] += std::abs(entry.coefficient * w[entry.source]);
}

bool Descriptor::unknowns_of_states(const std::vector<double>& values, const std::vector<double>& w, const Position& on,
                                    std::vector<double>& z, std::vector<double>& y) const {
  z.assign(static_cast<std::size_t>(size_), 0.0);
  y.assign(static_cast<std::size_t>(size_), 0.0);
  const std::size_t capacitors = network_.capacitors.size();
  for (int i = 0; i < static_cast<int>(network_.inductors.size()); ++i)
    for (const auto& share : windings_.coordinate(i))
      z[static_cast<std::size_t>(first_inductor_ + i)] += share.weight * values[capacitors + static_cast<std::size_t>(share.index)];
  Potentials potentials(network_.nodes.size());
  for (std::size_t i = 0; i < capacitors; ++i) potentials.join(states_[i].plus, states_[i].minus, values[i]);
  for (const auto& branch : network_.branches)
    if (model::is_independent(branch.voltage)) potentials.join(branch.p, branch.n, form(branch.voltage).value(nullptr, w.data()));
  for (std::size_t i = static_cast<std::size_t>(first_switch_); i < ports_.size(); ++i)
    if (on[i] != 0) potentials.join(ports_[i].p, ports_[i].n, 0.0);
  for (int node = 0; node < nodes(); ++node) z[static_cast<std::size_t>(node)] = potentials.at(node);
  bool remains = false;
  for (std::size_t i = 0; i < capacitors; ++i) {
    const auto at = [&](int node) { return node >= 0 ? z[static_cast<std::size_t>(node)] : 0.0; };
    const double missing = values[i] - states_[i].value(z.data());
    if (std::abs(missing) <=
        loop_tolerance * std::max({std::abs(values[i]), std::abs(at(states_[i].plus)), std::abs(at(states_[i].minus))}))
      continue;
    remains = true;
    const double charge = r0_ * states_[i].storage * missing;
    const int own = capacitor_current_[i];
    if (own >= 0)
      y[static_cast<std::size_t>(own)] += charge;
    else
      for (const FloatingSets::Cut& cut : sets_.cuts(states_[i].plus, states_[i].minus))
        y[static_cast<std::size_t>(cut.row)] += cut.sign * charge;
  }
  return remains;
}

Form Descriptor::form(const model::LinearForm& terms) const {
  Form f;
  const auto add = [&](int column, double coefficient) {
    if (column >= 0) f.z.push_back({column, coefficient});
  };
  for (const Term& term : terms) {
    const double c = term.coefficient;
    const auto i = static_cast<std::size_t>(term.index);
    switch (term.kind) {
      case Term::Kind::one:
        f.constant += c;
        break;
      case Term::Kind::source:
        f.w.push_back({term.index, c});
        break;
      case Term::Kind::node_voltage:
        add(term.index, c);
        break;
      case Term::Kind::resistor_current: {
        const auto& r = network_.resistors[i];
        if (low_resistor_[i] >= 0) {
          add(low_resistor_[i], c / r0_);
        } else {
          add(r.p, c / r.resistance);
          add(r.n, -c / r.resistance);
        }
        break;
      }
      case Term::Kind::capacitor_current:
        add(capacitor_current_[i], c / r0_);
        break;
      case Term::Kind::inductor_current:
        for (const auto& share : windings_.current(term.index)) add(first_inductor_ + share.index, share.weight * c / r0_);
        break;
      case Term::Kind::branch_current:
        add(first_branch_ + term.index, c / r0_);
        break;
      case Term::Kind::diode_current:
        add(first_port_ + term.index, c / r0_);
        break;
      case Term::Kind::switch_current:
        add(first_port_ + first_switch_ + term.index, c / r0_);
        break;
      case Term::Kind::slack_input:
        add(first_port_ + static_cast<int>(network_.diodes.size()) + term.index, c * input_scale_[i]);
        break;
    }
  }
  return f;
}

std::string Descriptor::unknown_name(int index) const {
  const auto i = static_cast<std::size_t>(index);
  if (i < network_.nodes.size()) return "node " + network_.nodes[i].name;
  for (std::size_t r = 0; r < low_resistor_.size(); ++r)
    if (low_resistor_[r] == index) return network_.resistors[r].label.name;
  for (std::size_t c = 0; c < capacitor_current_.size(); ++c)
    if (capacitor_current_[c] == index) return network_.capacitors[c].label.name;
  if (index < first_branch_) return network_.inductors[i - static_cast<std::size_t>(first_inductor_)].label.name;
  if (index < first_port_) return network_.branches[i - static_cast<std::size_t>(first_branch_)].label.name;
  return ports_[i - static_cast<std::size_t>(first_port_)].name;
}

}  // namespace pwlsim::engine::sparse
