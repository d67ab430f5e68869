#pragma once
/// A flat circuit as the model sees it, in a closed vocabulary: resistors, energy stores, linear rows, sources,
/// complementarity ports, and switches driven by a guard. Elements emit it through NetworkBuilder; nothing here knows a netlist.
///
/// Signs: a current named after an element enters its first node p and leaves at n; v = v(p) − v(n).

#include <algorithm>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "base/source.hpp"
#include "model/exponential_law.hpp"
#include "model/source_function.hpp"

namespace pwlsim::model {

using NodeIndex = int;
inline constexpr NodeIndex ground = -1;

/// One term coefficient·quantity. `index` counts within the list of that kind in Network (ignored for `one`).
struct Term {
  enum class Kind {
    one,
    node_voltage,
    resistor_current,
    capacitor_current,
    inductor_current,
    branch_current,
    diode_current,
    switch_current,
    slack_input,  ///< u of a Complementarity
    source
  };
  Kind kind = Kind::one;
  int index = 0;
  double coefficient = 0.0;
};
/// Σ coefficient·quantity.
using LinearForm = std::vector<Term>;

/// Of time alone: constants and sources.
[[nodiscard]] inline bool is_independent(const Term& term) { return term.kind == Term::Kind::one || term.kind == Term::Kind::source; }
[[nodiscard]] inline bool is_independent(const LinearForm& form) {
  return std::all_of(form.begin(), form.end(), [](const Term& term) { return is_independent(term); });
}

/// What every element of the network carries: its name as the user knows it ("X1.D3") and where it was written.
struct Label {
  std::string name;
  SourceSpan span;
};

/// v = resistance·i; zero and negative allowed.
struct Resistor {
  Label label;
  NodeIndex p = ground, n = ground;
  double resistance = 0.0;
};
/// i = capacitance·v'. `initial_voltage` counts with uic, where `has_initial`.
struct Capacitor {
  Label label;
  NodeIndex p = ground, n = ground;
  double capacitance = 0.0;
  bool has_initial = false;
  double initial_voltage = 0.0;
  bool starts_there = false;  ///< without uic too, even where that contradicts the network
  std::string state{};        ///< the quantity that its voltage represents: "x(s,1)"
};
/// v = inductance·i' + Σ mutual·i_other'.
struct Inductor {
  Label label;
  NodeIndex p = ground, n = ground;
  double inductance = 0.0;
  bool has_initial = false;
  double initial_current = 0.0;
};
/// Mutual inductance coefficient·√(L_a L_b), −1 ≤ coefficient ≤ 1.
struct Coupling {
  Label label;
  int inductor_a = 0, inductor_b = 0;
  double coefficient = 0.0;
};
/// Voltage branch: carries its own current; v(p) − v(n) = voltage (a form that may hold any quantity, its own current too).
struct Branch {
  Label label;
  NodeIndex p = ground, n = ground;
  LinearForm voltage;
};
/// Current from p through the element to n = current (node voltages, sources, currents of branches/inductors/…).
struct Injection {
  Label label;
  NodeIndex p = ground, n = ground;
  LinearForm current;
};
/// Ideal diode in series with a resistance and a forward drop: with d = v − drop − resistance·i:  0 ≤ −d ⊥ i ≥ 0.
/// With `enabled_by` (switches of the network) only while one of these is closed, else i = 0.
struct Diode {
  Label label;
  NodeIndex p = ground, n = ground;
  double resistance = 0.0;
  double drop = 0.0;
  std::vector<int> enabled_by{};
  bool blocks = false;                  ///< i = 0 for good
  bool is_of_leak = false;              ///< none that the circuit has: it stands beside a leak (leaks.hpp), and blocks
  std::optional<ExponentialLaw> law{};  ///< of which this is a tangent, where its current is to be found
};
/// How the deck writes the control of a switch, for messages: the control in Switch is `sense` times it, and its levels lie `reach` inside of those
/// written.
struct WrittenControl {
  double sense = 1.0;
  double reach = 0.0;
  std::string unit = "V";
};
constexpr double least_channel_resistance = 1e-4;  ///< ohm, of a channel that follows its gate
/// Of a transistor's channel where the gate's voltage is to be found: what the resistance is by the overdrive, the control beyond its level.
struct ChannelLaw {
  double series = 0.0;  ///< ohm
  double gain = 0.0;    ///< A/V²
  [[nodiscard]] double resistance(double overdrive) const { return series + 1.0 / (gain * overdrive); }
};
/// Closed: v = drop + resistance·i. Open: i = 0. It closes when control rises above `on_level` and opens when control falls below `off_level`
/// (off_level ≤ on_level); at equality the first nonzero derivative decides. `inverted` swaps closed and open. With both ends at one node it connects
/// nothing: its position is a state for others (Diode::enabled_by).
struct Switch {
  Label label;
  NodeIndex p = ground, n = ground;
  double resistance = 0.0;
  double drop = 0.0;
  LinearForm control;
  double on_level = 0.0, off_level = 0.0;
  bool initially_on = false;  ///< inside the band at the start
  bool inverted = false;
  std::optional<WrittenControl> written{};  ///< none: no element of the deck by itself, but part of an expression or of a device
  std::optional<ChannelLaw> law{};          ///< whose resistance this is at one overdrive
};
/// 0 ≤ u ⊥ slack ≥ 0, u a number of its own that any form may hold, `slack` too.
/// Of a channel that follows its gate: one of the two positive parts whose difference is its current, that of the source first, that of the drain next.
/// Its input counts `resistance` times the excess over the threshold, divided by the resistance that is found.
struct ChannelHalf {
  ChannelLaw law;
  double resistance = 0.0;  ///< ohm, of which the current is written
  double level = 0.0;       ///< V, of the gate against the terminal
  bool is_p_type = false, is_source = false;
};
struct Complementarity {
  Label label;
  LinearForm slack;
  std::optional<ChannelHalf> half{};
};
struct Source {
  Label label;
  SourceFunction function;
  bool stands_in = false;                  ///< for a value of another part, in a part that is left out
  std::complex<double> alternating = 0.0;  ///< `AC`: amplitude in small-signal analyses
  std::string follows{};                   ///< the element whose comparison with a level it is; "" if it is its own
};
/// A saved signal, named as its CSV column.
struct Signal {
  std::string name;
  LinearForm form;
};
/// `.ic V(node)=value`, forced in the operating point; with uic it sets capacitors.
struct NodeCondition {
  Label label;
  NodeIndex node = ground;
  double voltage = 0.0;
};
/// `.ic I(L)=value`, forced in the operating point; with uic it sets that inductor (Inductor::initial_current is set as well by the emitter).
struct CurrentCondition {
  Label label;
  int inductor = 0;
  double current = 0.0;
};

struct Network {
  std::vector<Label> nodes;
  std::vector<Resistor> resistors;
  std::vector<Capacitor> capacitors;
  std::vector<Inductor> inductors;
  std::vector<Coupling> couplings;
  std::vector<Branch> branches;
  std::vector<Injection> injections;
  std::vector<Diode> diodes;
  std::vector<Complementarity> complementarities;
  std::vector<Switch> switches;
  std::vector<Source> sources;
  std::vector<Signal> signals;
  std::vector<NodeCondition> node_conditions;
  std::vector<CurrentCondition> current_conditions;
};

/// Functions of the sources, in their order.
[[nodiscard]] inline std::vector<SourceFunction> source_functions(const Network& network) {
  std::vector<SourceFunction> functions;
  for (const auto& source : network.sources) functions.push_back(source.function);
  return functions;
}

}  // namespace pwlsim::model
