#include "steady/parameter_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "linalg/dense.hpp"
#include "linalg/factorisations.hpp"
#include "model/conditions.hpp"
#include "model/forms.hpp"
#include "model/moved_network.hpp"
#include "steady/linearised.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using Item = model::NetworkMove::Item;
using Kind = model::Term::Kind;
using model::LinearForm;

/// Of an input its value and derivatives, the last of which shows whether it would need more; `usual` where no element differentiates, by the current of a capacitor.
constexpr int usual_states = 4, most_states = 8;

int states_of_inputs(const model::Network& network) {
  int states = usual_states;
  model::for_each_equation(network, [&](const LinearForm& form) {
    const auto differentiates = [](const model::Term& term) { return term.kind == Kind::capacitor_current; };
    if (std::any_of(form.begin(), form.end(), differentiates)) states = most_states;
  });
  return states;
}

/// An input, and the signal or store that it is a multiple of.
struct Pair {
  int input = 0, signal = -1;
  std::string store{};
  std::optional<Drive::HeldVoltage> held{};
};

/// The voltage of a node that a branch of sources alone ties to ground; empty where it is none, or where a name stands for several sources.
std::optional<Drive::HeldVoltage> held_by_sources(const model::Network& network, const model::Term& read) {
  if (read.kind != Kind::node_voltage && read.kind != Kind::source) return std::nullopt;
  const auto name_of = [&](int source) { return network.sources[static_cast<std::size_t>(source)].label.name; };
  const auto is_alone = [&](const model::Term& term) {
    const auto same = [&](const model::Source& other) { return other.label.name == name_of(term.index); };
    return term.kind == Kind::one || std::count_if(network.sources.begin(), network.sources.end(), same) == 1;
  };
  if (read.kind == Kind::source) {
    if (!is_alone(read)) return std::nullopt;
    return Drive::HeldVoltage{{{name_of(read.index), read.coefficient}}, 0.0};
  }
  for (const model::Branch& branch : network.branches) {
    const bool is_upright = branch.p == read.index && branch.n == model::ground;
    if (!is_upright && !(branch.n == read.index && branch.p == model::ground)) continue;
    const auto is_source = [](const model::Term& term) { return term.kind == Kind::one || term.kind == Kind::source; };
    if (!std::all_of(branch.voltage.begin(), branch.voltage.end(), is_source)) continue;
    if (!std::all_of(branch.voltage.begin(), branch.voltage.end(), is_alone)) return std::nullopt;
    Drive::HeldVoltage held;
    for (const model::Term& term : branch.voltage) {
      const double coefficient = (is_upright ? read.coefficient : -read.coefficient) * term.coefficient;
      if (term.kind == Kind::one)
        held.constant += coefficient;
      else
        held.sources.emplace_back(name_of(term.index), coefficient);
    }
    return held;
  }
  return std::nullopt;
}

double inductance_between(const model::Network& network, const model::Coupling& coupling) {
  return coupling.coefficient * std::sqrt(network.inductors[static_cast<std::size_t>(coupling.inductor_a)].inductance *
                                          network.inductors[static_cast<std::size_t>(coupling.inductor_b)].inductance);
}

class Adder {
 public:
  explicit Adder(model::Network& network)
      : network_(network), original_(network), started_(model::with_initial_values(network)), states_(states_of_inputs(network)) {}

  ParameterInputs add(const model::NetworkMoves& moves) {
    ParameterInputs result;
    linalg::Matrix inductances;
    for (const model::NetworkMove& move : moves) {
      if (is_magnetic(move))
        take_inductance(move, inductances);
      else
        take(move, result);
    }
    if (inductances.size() > 0) add_inductances(inductances, result);
    return result;
  }

  SensitivityInputs take_all() { return std::move(all_); }

 private:
  static bool is_magnetic(const model::NetworkMove& move) { return move.item == Item::inductance || move.item == Item::coupling; }

  std::string new_name() { return "sens " + std::to_string(all_.names.size()); }

  int new_input() {
    all_.names.push_back(new_name());
    sources_.push_back(add_small_input(network_, all_.names.back(), {1.0, states_}));
    return static_cast<int>(all_.names.size()) - 1;
  }

  int new_signal(LinearForm form) {
    network_.signals.push_back({"sens signal", std::move(form)});
    ++all_.signals;
    return static_cast<int>(network_.signals.size()) - 1;
  }

  [[nodiscard]] LinearForm source_of(int input, double coefficient = 1.0) const {
    return {{Kind::source, sources_[static_cast<std::size_t>(input)], coefficient}};
  }

  /// A voltage between the element and its node n.
  template <class Element>
  int input_in_series(Element& element) {
    const int input = new_input();
    const auto node = static_cast<model::NodeIndex>(network_.nodes.size());
    network_.nodes.push_back({all_.names.back(), element.label.span});
    network_.branches.push_back({{all_.names.back(), element.label.span}, node, element.n, source_of(input)});
    // What `.ic` says of its node says it of the new one.
    for (const model::NodeCondition& condition : original_.node_conditions)
      if (condition.node == element.n) network_.node_conditions.push_back({condition.label, node, condition.voltage});
    element.n = node;
    return input;
  }

  template <class Make>
  Pair pair_of(Item item, int index, const Make& make) {
    const auto key = std::pair(item, index);
    const auto known = pairs_.find(key);
    return known != pairs_.end() ? known->second : pairs_[key] = make();
  }

  template <class Element>
  Pair in_series(Item item, int index, std::vector<Element>& list, Kind current) {
    return pair_of(item, index, [&] {
      const int input = input_in_series(list[static_cast<std::size_t>(index)]);
      return Pair{input, new_signal({{current, index, 1.0}})};
    });
  }

  Pair capacitor(int index) {
    return pair_of(Item::capacitance, index, [&] {
      model::Capacitor& item = network_.capacitors[static_cast<std::size_t>(index)];
      return Pair{input_in_series(item), -1, item.state.empty() ? "v(" + item.label.name + ")" : item.state};
    });
  }

  /// A current beside the inductor: all that reads its current reads both.
  Pair inductor(int index) {
    return pair_of(Item::inductance, index, [&] {
      const model::Inductor& item = network_.inductors[static_cast<std::size_t>(index)];
      const int input = new_input();
      read_beside(index, input);
      network_.injections.push_back({{all_.names.back(), item.label.span}, item.p, item.n, source_of(input)});
      return Pair{input, new_signal({{Kind::inductor_current, index, 1.0}})};
    });
  }

  void read_beside(int inductor, int input) {
    const auto extend = [&](LinearForm& form) {
      const std::size_t terms = form.size();
      for (std::size_t i = 0; i < terms; ++i)
        if (form[i].kind == Kind::inductor_current && form[i].index == inductor)
          form.push_back({Kind::source, sources_[static_cast<std::size_t>(input)], form[i].coefficient});
    };
    for (auto& branch : network_.branches) extend(branch.voltage);
    for (auto& injection : network_.injections) extend(injection.current);
    for (auto& item : network_.complementarities) extend(item.slack);
    for (auto& item : network_.switches) extend(item.control);
    const std::size_t own = network_.signals.size() - all_.signals;
    for (std::size_t k = 0; k < own; ++k) extend(network_.signals[k].form);
  }

  /// Of a form: one input for all that moves it.
  template <class Element>
  void add_form(const model::NetworkMove& move, std::vector<Element>& list, LinearForm Element::*form, ParameterInputs& result) {
    const int input = pair_of(move.item, move.index, [&] {
                        const int own = new_input();
                        (list[static_cast<std::size_t>(move.index)].*form).push_back(source_of(own).front());
                        return Pair{own, -1};
                      }).input;
    for (const model::Term& term : move.form) {
      const model::Term read{term.kind, term.index, 1.0};
      if (term.kind == Kind::one)
        add_drop({input, -1}, term.coefficient, result);
      else if (auto held = held_by_sources(original_, read))
        drive(result, {input, -1, {}, std::move(held)}, term.coefficient);
      else
        drive(result, {input, signal_of(read)}, term.coefficient);
    }
  }

  int signal_of(const model::Term& read) {
    const auto [known, is_new] = signals_.try_emplace({read.kind, read.index}, -1);
    if (is_new) known->second = new_signal({read});
    return known->second;
  }

  static void drive(ParameterInputs& result, const Pair& pair, double weight) {
    result.drives.push_back({pair.input, pair.signal, weight, pair.store, pair.held});
  }

  void take(const model::NetworkMove& move, ParameterInputs& result) {
    const auto at = static_cast<std::size_t>(move.index);
    const double p = move.derivative;
    switch (move.item) {
      case Item::resistance:
        return drive(result, in_series(Item::resistance, move.index, network_.resistors, Kind::resistor_current), p);
      case Item::diode_resistance:
        return drive(result, in_series(Item::diode_resistance, move.index, network_.diodes, Kind::diode_current), p);
      case Item::switch_resistance:
        return drive(result, in_series(Item::switch_resistance, move.index, network_.switches, Kind::switch_current), p);
      case Item::diode_drop:
        return add_drop(in_series(Item::diode_resistance, move.index, network_.diodes, Kind::diode_current), p, result);
      case Item::switch_drop:
        return add_drop(in_series(Item::switch_resistance, move.index, network_.switches, Kind::switch_current), p, result);
      case Item::capacitance: {
        const model::Capacitor& item = started_.capacitors[at];
        drive(result, capacitor(move.index), -p / item.capacitance);
        result.starts.push_back({true, item.label.name, item.initial_voltage * p / item.capacitance});
        return;
      }
      case Item::on_level:
        result.levels.push_back({move.index, p, 0.0});
        return;
      case Item::off_level:
        result.levels.push_back({move.index, 0.0, p});
        return;
      case Item::source:
        return add_wave({source(move.index), original_.sources[at].function, *move.function, move.index, original_.sources[at].label.name},
                        result);
      case Item::branch_form:
        return add_form(move, network_.branches, &model::Branch::voltage, result);
      case Item::injection_form:
        return add_form(move, network_.injections, &model::Injection::current, result);
      case Item::slack_form:
        return add_form(move, network_.complementarities, &model::Complementarity::slack, result);
      case Item::control_form:
        return add_form(move, network_.switches, &model::Switch::control, result);
      case Item::signal_form:
        return add_form(move, network_.signals, &model::Signal::form, result);
      case Item::initial_voltage:
        result.starts.push_back({true, original_.capacitors[at].label.name, p});
        return;
      case Item::initial_current:
        result.starts.push_back({false, original_.inductors[at].label.name, p});
        return;
      case Item::node_condition:
        result.conditions.push_back({false, original_.node_conditions[at].label.name, p});
        return;
      case Item::current_condition:
        result.conditions.push_back({true, original_.current_conditions[at].label.name, p});
        return;
      case Item::inductance:
      case Item::coupling:
        return;
    }
  }

  static void add_drop(const Pair& pair, double drop, ParameterInputs& result) {
    result.waves.push_back({pair.input, model::Dc{}, model::Dc{drop}, -1, {}});
  }

  /// The derivatives of one function add up.
  static void add_wave(Wave wave, ParameterInputs& result) {
    const auto known = std::find_if(result.waves.begin(), result.waves.end(), [&](const Wave& other) { return other.input == wave.input; });
    if (known == result.waves.end())
      result.waves.push_back(std::move(wave));
    else
      model::add(known->derivative, wave.derivative);
  }

  int source(int index) {
    return pair_of(Item::source, index,
                   [&] {
                     const int input = new_input();
                     superpose_input(network_, index, sources_[static_cast<std::size_t>(input)]);
                     return Pair{input, -1};
                   })
        .input;
  }

  [[nodiscard]] linalg::Matrix inductance_matrix() const {
    const auto n = static_cast<Eigen::Index>(original_.inductors.size());
    linalg::Matrix m = linalg::Matrix::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) m(i, i) = original_.inductors[static_cast<std::size_t>(i)].inductance;
    for (const model::Coupling& coupling : original_.couplings)
      m(coupling.inductor_a, coupling.inductor_b) = m(coupling.inductor_b, coupling.inductor_a) = inductance_between(original_, coupling);
    return m;
  }

  void take_inductance(const model::NetworkMove& move, linalg::Matrix& moved) const {
    const auto n = static_cast<Eigen::Index>(original_.inductors.size());
    if (moved.size() == 0) moved = linalg::Matrix::Zero(n, n);
    const auto at = static_cast<std::size_t>(move.index);
    if (move.item == Item::coupling) {
      const model::Coupling& c = original_.couplings[at];
      const double p = move.derivative * std::sqrt(original_.inductors[static_cast<std::size_t>(c.inductor_a)].inductance *
                                                   original_.inductors[static_cast<std::size_t>(c.inductor_b)].inductance);
      moved(c.inductor_a, c.inductor_b) += p;
      moved(c.inductor_b, c.inductor_a) += p;
      return;
    }
    moved(move.index, move.index) += move.derivative;
    for (const model::Coupling& c : original_.couplings) {
      if (c.inductor_a != move.index && c.inductor_b != move.index) continue;
      const double p = 0.5 * inductance_between(original_, c) * move.derivative / original_.inductors[at].inductance;
      moved(c.inductor_a, c.inductor_b) += p;
      moved(c.inductor_b, c.inductor_a) += p;
    }
  }

  void add_inductances(const linalg::Matrix& moved, ParameterInputs& result) {
    const linalg::Matrix m = inductance_matrix();
    const Eigen::ArrayXd size = m.diagonal().array().abs().sqrt().max(1e-300);
    const linalg::Matrix scaled = (m.array().colwise() / size).rowwise() / size.transpose();
    const Eigen::FullPivLU<linalg::Matrix> lu(scaled);
    if (!lu.isInvertible() || lu.rcond() < tolerance::coupled_pivot) {  // the estimate leaves out pivots that are zero
      result.failure = "it changes perfectly coupled inductors";
      return;
    }
    // −M⁻¹P, and what starts at given currents keeps them.
    const linalg::Matrix right = (moved.array().colwise() / size).matrix();
    const linalg::Matrix weights = -(lu.solve(right).array().colwise() / size).matrix();
    linalg::Vector currents(m.rows());
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      currents[i] = started_.inductors[static_cast<std::size_t>(i)].initial_current;
    }
    const linalg::Vector starts = -(weights * currents);
    for (Eigen::Index a = 0; a < m.rows(); ++a) {
      if (weights.row(a).isZero(0.0)) continue;
      const Pair own = inductor(static_cast<int>(a));
      for (Eigen::Index b = 0; b < m.cols(); ++b)
        if (weights(a, b) != 0.0) result.drives.push_back({own.input, inductor(static_cast<int>(b)).signal, weights(a, b), {}});
      result.starts.push_back({false, original_.inductors[static_cast<std::size_t>(a)].label.name, starts[a]});
    }
  }

  model::Network& network_;
  const model::Network original_, started_;  ///< started_: what `.ic` says are initial values there
  int states_;                               ///< of an input
  SensitivityInputs all_;
  std::vector<int> sources_;  ///< of the inputs
  std::map<std::pair<Item, int>, Pair> pairs_;
  std::map<std::pair<Kind, int>, int> signals_;
};

}  // namespace

SensitivityInputs add_parameter_inputs(model::Network& network, const std::vector<model::NetworkMoves>& parameters) {
  Adder adder(network);
  std::vector<ParameterInputs> list;
  for (const model::NetworkMoves& moves : parameters) list.push_back(adder.add(moves));
  SensitivityInputs all = adder.take_all();
  all.parameters = std::move(list);
  return all;
}

}  // namespace pwlsim::steady
