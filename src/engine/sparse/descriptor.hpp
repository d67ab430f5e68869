#pragma once
/// A network as equations without any reduction:  E z' + G z + H w + g = 0,  w the values of its sources.
///
/// z: the unknowns of model/tableau.hpp, with the currents of those capacitors whose current some form reads; all of it in volts. E is symmetric positive semidefinite (capacitances in rows
/// of Kirchhoff's current law, inductances in those of inductors), so that ½ zᵀE z / R0 is the stored energy where no capacitor has a
/// current of its own and no part hangs on capacitors alone (below).
///
/// Coupled inductors have their own coordinates (windings.hpp) instead of currents: these are not coupled, and a perfect coupling is a ratio of voltages.
///
/// Nodes that capacitors join to one another and not to ground form a floating set. In short steps C/h is so large that the leaks of such a set are lost in
/// the rounding of its equations, which are then dependent. So one row of the set holds Kirchhoff's current law of the whole set instead of that of a node: the capacitors
/// cancel in it by construction, and only the leaks remain. So do sets that far smaller capacitors join to others and to ground (floating_sets.hpp).
///
/// Every port p has an input u = z[row] and a slack s = row·z + …:  0 ≤ u ⊥ s ≥ 0, for a diode i and drop + R i − v. Its closing row is
///    on:  s = 0      off:  u = 0
/// with a small part of the other added if the position leaves something open (factors.hpp). Both entries are kept in the pattern in either
/// position.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/sparse/floating_sets.hpp"
#include "engine/sparse/windings.hpp"
#include "linalg/sparse.hpp"
#include "model/tableau.hpp"

namespace pwlsim::engine::sparse {

/// Which ports are on. Switches too: on is closed.
using Position = std::vector<char>;

/// value = Σ z-terms + Σ w-terms + constant.
struct Form {
  struct IndexedTerm {
    int index;
    double coefficient;
  };
  std::vector<IndexedTerm> z, w;
  double constant = 0.0;

  [[nodiscard]] static double sum(const std::vector<IndexedTerm>& parts, const double* x, double start = 0.0) {
    for (const IndexedTerm& part : parts) start += part.coefficient * x[part.index];
    return start;
  }
  [[nodiscard]] static double size_of(const std::vector<IndexedTerm>& parts, const double* x) {
    double size = 0.0;
    for (const IndexedTerm& part : parts) size += std::abs(part.coefficient * x[part.index]);
    return size;
  }
  [[nodiscard]] double value(const double* unknowns, const double* sources) const { return sum(w, sources, sum(z, unknowns, constant)); }
  /// Sum of the magnitudes of its terms.
  [[nodiscard]] double size(const double* unknowns, const double* sources) const {
    return std::abs(constant) + size_of(z, unknowns) + size_of(w, sources);
  }
};

struct DescriptorPort {
  std::string name;
  int row = 0;  ///< its closing row, and the column of its input
  Form slack;   ///< volts
  bool is_switch = false;
  std::vector<int> enabled_by{};  ///< of a diode: ports of switches of which one must be closed, else it blocks whatever its slack is
  model::NodeIndex p = model::ground, n = model::ground;  ///< of a diode or switch

  /// The free quantity in a position: u if on, s if off. A diode requires that it is not negative.
  [[nodiscard]] double free_variable(bool on, const double* z, const double* w) const { return on ? z[row] : slack.value(z, w); }
  [[nodiscard]] bool blocks(const Position& on) const {
    return !enabled_by.empty() &&
           std::none_of(enabled_by.begin(), enabled_by.end(), [&](int s) { return on[static_cast<std::size_t>(s)] != 0; });
  }
  /// Sum of the magnitudes that the slack is a sum of.
  [[nodiscard]] double slack_size(const double* z, const double* w) const { return slack.size(z, w); }
  /// The part of it that is linear in z.
  [[nodiscard]] double response(bool on, const double* z) const { return on ? z[row] : Form::sum(slack.z, z); }
};

/// A state: the voltage of a capacitor or the current of an inductor times R0, z[plus] − z[minus] (−1: nothing), or of coupled inductors a sum.
struct State {
  int plus = -1, minus = -1;
  bool is_current = false;
  double storage = 0.0;                      ///< capacitance, or inductance without its couplings
  std::vector<Form::IndexedTerm> current{};  ///< of a coupled inductor
  std::vector<Form::IndexedTerm> flux{};     ///< of a perfectly coupled inductor: its flux over its inductance
  /// What errors are measured in: the value, but the flux of a perfectly coupled inductor, whose current is no state of its own.
  [[nodiscard]] double measure(const double* z) const { return flux.empty() ? value(z) : Form::sum(flux, z); }
  [[nodiscard]] double value(const double* z) const {
    if (!current.empty()) return Form::sum(current, z);
    return (plus >= 0 ? z[plus] : 0.0) - (minus >= 0 ? z[minus] : 0.0);
  }
  /// Sum of the magnitudes that the value is a sum of.
  [[nodiscard]] double size(const double* z) const {
    if (!current.empty()) return Form::size_of(current, z);
    return (plus >= 0 ? std::abs(z[plus]) : 0.0) + (minus >= 0 ? std::abs(z[minus]) : 0.0);
  }
};

class Descriptor {
 public:
  /// Steps that follow motions, or those to an operating point, in which capacitors are nearly open.
  enum class Steps { short_ones, to_rest };
  explicit Descriptor(const model::Network& network, Steps steps = Steps::short_ones);

  [[nodiscard]] const model::Network& network() const { return network_; }
  [[nodiscard]] const model::Unknowns& unknowns() const { return unknowns_; }
  [[nodiscard]] int size() const { return unknowns_.size(); }
  /// The first unknowns are node voltages.
  [[nodiscard]] int nodes() const { return static_cast<int>(network_.nodes.size()); }
  [[nodiscard]] double r0() const { return r0_; }
  /// Times R0: s.
  [[nodiscard]] double largest_capacitance() const { return largest_capacitance_; }
  [[nodiscard]] const linalg::SparsePattern& pattern() const { return pattern_; }
  [[nodiscard]] const std::vector<DescriptorPort>& ports() const { return ports_; }
  /// Diodes that no switch enables go off.
  void hold_blocked(Position& on) const {
    for (const int i : valves_)
      if (ports_[static_cast<std::size_t>(i)].blocks(on)) on[static_cast<std::size_t>(i)] = 0;
  }
  /// Diodes and complementarities come first.
  [[nodiscard]] int first_switch() const { return unknowns_.first_switch(); }
  /// Whether only its sources can feed energy into the network: then its solution is unique, and jumps are of first order.
  [[nodiscard]] bool passive() const;
  /// Capacitors, then inductors, as in the network.
  [[nodiscard]] const std::vector<State>& states() const { return states_; }

  /// Coefficients of closing rows  of_slack·s + of_input·u,  one pair a port.
  struct Closing {
    std::vector<double> of_slack, of_input;
  };
  /// Those of a position, with an ε: zero, or what it needs to be regular.
  [[nodiscard]] Closing closing(double shift, const Position& on, double epsilon) const;
  /// Makes those of some ports  s + a u  or  u + b s,  a and b far below the impedances and admittances around. Returns the largest admittance that meets in
  /// a node.
  double tie(double shift, const Position& on, const std::vector<int>& ports, Closing& closing) const;
  /// Entries of shift·E + G with closing rows, for currents in a unit of their own: what is no node voltage is `unit` times the unknown of these
  /// entries.
  void matrix(double shift, const Closing& closing, double unit, std::vector<double>& values) const;
  /// Of the resistors whose currents are differences of node voltages at a port's nodes, times R0.
  [[nodiscard]] double conductance_at(std::size_t port) const { return conductance_at_port_[port]; }
  /// Of the resistors, times R0, that a port that is on meets in an equation where nothing else does: no store, source or other current. Infinite: there is no such equation.
  [[nodiscard]] double leaks_at(std::size_t port, const Position& on) const;
  /// Geometric mean over the nodes of the diagonal of shift·E + G (times R0: 1 is 1/R0).
  [[nodiscard]] double mean_admittance(double shift) const;
  /// k = −(G z + H w + g): what E z' is; zero in closing rows.
  void rates(const double* z, const double* w, double* k) const;
  /// The same in two parts:  k = −(G z + g),  then  k −= H w.
  void rates_without_sources(const double* z, double* k) const;
  void add_sources(const double* w, double* k) const;
  /// Their linear parts:  k = −G z,  and  k −= factor·g.
  void conduct(const double* z, double* k) const;
  void add_constants(double factor, double* k) const;
  /// |G| |z|
  void conduct_sizes(const double* z, double* sizes) const { linalg::multiply_absolute(conduction_.pattern, conduction_.values, z, sizes); }
  /// G
  [[nodiscard]] const linalg::SparseMatrix& conduction() const { return conduction_; }
  /// E
  [[nodiscard]] const linalg::SparseMatrix& memory() const { return memory_; }
  /// |E| |z|
  void memory_sizes(const double* z, double* sizes) const { linalg::multiply_absolute(memory_.pattern, memory_.values, z, sizes); }
  /// Rows of E that hold anything.
  [[nodiscard]] std::vector<char> differential_rows() const;
  /// The diagonal of E; where a row gives a capacitor's current, its capacitance.
  [[nodiscard]] std::vector<double> memory_diagonal() const;
  /// |G| |z| + |H| |w| + |g|.
  void rate_sizes(const double* z, const double* w, double* sizes) const;
  /// The value of every state from z.
  void measure_states(const double* z, std::vector<double>& states) const;
  /// Leaves of z the voltages of nodes and the currents of inductors.
  void forget_currents(std::vector<double>& z) const {
    std::fill(z.begin() + nodes(), z.begin() + unknowns_.inductor(0), 0.0);
    std::fill(z.begin() + unknowns_.branch(0), z.end(), 0.0);
  }
  /// y = E z.
  void memory(const double* z, double* y) const { linalg::multiply(memory_.pattern, memory_.values, z, y); }
  /// Node potentials and currents, in z, near the solution with states given one by one: those of capacitors, where these leave it open of sources and
  /// closed switches. What loops of capacitors contradict remains as charges y, so that E z + y are all charges and fluxes. False: nothing remains.
  [[nodiscard]] bool unknowns_of_states(const std::vector<double>& values, const std::vector<double>& w, const Position& on,
                                        std::vector<double>& z, std::vector<double>& y) const;
  /// Whether couplings do not contradict one another.
  [[nodiscard]] bool coupling_is_possible() const { return windings_.possible(); }
  /// A linear form in SI units.
  [[nodiscard]] Form form(const model::LinearForm& terms) const;
  /// "node out", "the current of V1"
  [[nodiscard]] std::string unknown_name(int index) const;
  /// aᵀ y with y in rows of this descriptor, as if no row were that of a floating set and no capacitor's current an unknown.
  [[nodiscard]] double product(const std::vector<double>& a, const std::vector<double>& y) const;
  /// What it is at most, y being sizes.
  [[nodiscard]] double largest_product(const std::vector<double>& a, const std::vector<double>& y) const;

 private:
  [[nodiscard]] double weight(const std::vector<double>& a, std::size_t row) const;
  [[nodiscard]] std::vector<double> node_admittances(double shift) const;
  [[nodiscard]] std::vector<double> at_ports(const std::vector<double>& of_nodes) const;
  void number_unknowns();
  void scale_complementarities();
  void add_stores();
  void add_inductors();
  void measure_fluxes();
  void note_conductances();
  void note_leaks();
  void note_valves();
  void compress();

  class Stamps;
  struct Place {
    int row, column;
    double e, g, slack, input;
  };
  struct SourceEntry {
    int row, source;
    double coefficient;
  };
  std::vector<int> valves_;  ///< ports that switches enable
  const model::Network& network_;
  double r0_, largest_capacitance_ = 0.0;
  model::Unknowns unknowns_;
  FloatingSets sets_;
  Windings windings_;
  model::ComplementarityScales<double> scales_;
  std::vector<Place> places_;
  linalg::SparsePattern pattern_;
  std::vector<double> e_, g_, slack_, input_;      ///< one an entry; slack_ and input_ only in closing rows
  linalg::SparseMatrix memory_, conduction_;       ///< E and G, for products
  std::vector<int> node_diagonal_;                 ///< entries on the diagonal of nodes
  std::size_t first_current_ = 0;                  ///< entries of currents begin here
  std::vector<int> port_entries_, port_of_entry_;  ///< entries of closing rows, and whose they are
  std::vector<SourceEntry> sources_;
  std::vector<double> constant_;
  std::vector<DescriptorPort> ports_;
  std::vector<double> conductance_at_port_;
  struct LeakyNode {
    double conductance;
    std::vector<int> ports;  ///< all that meet there
  };
  std::vector<std::vector<LeakyNode>> leaky_nodes_;  ///< of each port
  std::vector<State> states_;
  std::vector<int> capacitor_of_row_;  ///< whose current the row gives; −1: none
};

}  // namespace pwlsim::engine::sparse
