#include "circuit/assemble.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/dangling.hpp"
#include "circuit/floating.hpp"
#include "circuit/gate_drives.hpp"
#include "circuit/names.hpp"
#include "circuit/node_levels.hpp"
#include "circuit/signals.hpp"
#include "circuit/source_resistance.hpp"
#include "elements/emission.hpp"
#include "elements/moving_form.hpp"
#include "elements/steps.hpp"

namespace pwlsim::circuit {
namespace {

using elements::ControlSyntax;
using elements::Instance;

/// "X1.X2." of "X1.X2.R1"
std::string_view prefix_of(std::string_view name) { return name.substr(0, name.rfind('.') + 1); }

class Assembler {
 public:
  Assembler(FlatCircuit& circuit, Reporter& reporter) : circuit_(circuit), reporter_(reporter), names_(circuit) {}

  std::optional<model::Network> run() {
    check_names();
    if (circuit_.instances.empty() && !reporter_.failed()) reporter_.error("E-no-elements", {}, "the deck has no elements");
    for (Instance& instance : circuit_.instances) resolve_references(instance);
    resolve_products(circuit_, reporter_);
    const std::vector<SignalSource> signals = resolve_signals(circuit_, names_, reporter_);
    const std::vector<SignalSource> probes = resolve_probes(circuit_, names_, reporter_);
    resolve_conditions();
    if (!reporter_.failed()) check_complete();
    std::vector<model::NodeIndex> to_tie;
    if (!circuit_.has_gaps) to_tie = report_floating(circuit_, reporter_);
    if (!circuit_.has_gaps) warn_of_dangling(circuit_, reporter_);
    if (reporter_.failed()) return std::nullopt;
    resist_capacitors(circuit_, reporter_);
    emit();
    tie_to_ground(to_tie);
    add_signals(signals, probes);
    if (reporter_.failed()) return std::nullopt;
    elements::decide_steps(builder_);
    circuit_.formula_moves = std::move(builder_.moves());
    return builder_.take();
  }

 private:
  /// No current flows there: nothing else leads to ground.
  void tie_to_ground(const std::vector<model::NodeIndex>& nodes) {
    for (const model::NodeIndex node : nodes)
      builder_.add(model::Resistor{circuit_.nodes()[static_cast<std::size_t>(node)], node, model::ground, 1.0});
  }

  void check_names() {
    for (int second : names_.second_ones()) {
      const Instance& instance = circuit_.instances[static_cast<std::size_t>(second)];
      reporter_.error("E-name-clash", instance.span, fmt::format("two different elements have the full name {}", instance.name));
    }
  }

  void resolve_references(Instance& instance) {
    for (elements::Reference& reference : instance.references) {
      reference.index = names_.element(reference.name);
      if (reference.index < 0) {
        const std::string_view prefix = prefix_of(instance.name);
        const std::string local = reference.name.substr(std::min(prefix.size(), reference.name.size()));
        reporter_.error("E-unknown-element", reference.span,
                        fmt::format("unknown element '{}'{}", local, suggestion(local, names_.element_names(prefix))));
      } else if (instance.kind != nullptr) {
        check_control(*instance.kind, reference);
      }
    }
  }

  void check_control(const elements::Kind& kind, const elements::Reference& reference) {
    const Instance& other = circuit_.instances[static_cast<std::size_t>(reference.index)];
    if (other.kind == nullptr) return;
    if (kind.control == ControlSyntax::element_list && other.kind->letter != 'L') {
      reporter_.error("E-coupling", reference.span, fmt::format("{} is a {}: only inductors can be coupled", other.name, other.kind->name));
    } else if (kind.control != ControlSyntax::element_list && !other.kind->controls_others) {
      reporter_.error(
          "E-no-current", reference.span,
          fmt::format("{} is a {}: its current cannot control another; try a 0 V source in series with it", other.name, other.kind->name));
    }
  }

  void resolve_conditions() {
    for (const InitialCondition& condition : circuit_.conditions) {
      condition.is_current ? current_condition(condition) : node_condition(condition);
    }
  }

  void node_condition(const InitialCondition& condition) {
    const auto node = names_.node(condition.name);
    if (!node) {
      reporter_.error("E-unknown-node", condition.span,
                      fmt::format("unknown node '{}'{}", condition.name, suggestion(condition.name, names_.node_names())));
    } else if (*node == model::ground) {
      reporter_.error("E-ic", condition.span, "ground is 0 V: it has no initial condition");
    } else {
      auto& list = builder_.network().node_conditions;
      const auto same = [&](const model::NodeCondition& other) { return other.node == *node; };
      warn_of_second(condition, std::erase_if(list, same) != 0);
      builder_.add(model::NodeCondition{{condition.name, condition.span}, *node, condition.value});
    }
  }

  void current_condition(const InitialCondition& condition) {
    const int element = names_.element(condition.name);
    if (element < 0) {
      reporter_.error("E-unknown-element", condition.span,
                      fmt::format("unknown element '{}'{}", condition.name, suggestion(condition.name, names_.element_names())));
      return;
    }
    const Instance& instance = circuit_.instances[static_cast<std::size_t>(element)];
    if (instance.kind != nullptr && instance.kind->letter != 'L') {
      reporter_.error("E-ic", condition.span, fmt::format("{} is not an inductor: only inductors have an initial current", condition.name));
      return;
    }
    const auto same = [&](const auto& other) { return other.first == element; };
    warn_of_second(condition, std::erase_if(currents_, same) != 0);
    currents_.emplace_back(element, condition);
  }

  void warn_of_second(const InitialCondition& condition, bool is_second) {
    if (is_second)
      reporter_.warning("W-second-ic", condition.span, fmt::format("a second initial condition for {}: this one is used", condition.name));
  }

  /// What binding sees to; circuits built in code may lack something.
  void check_complete() {
    for (const Instance& instance : circuit_.instances) {
      if (is_complete(instance)) continue;
      reporter_.error("E-incomplete", instance.span, fmt::format("{} is not complete; usage: {}", instance.name, instance.kind->usage));
    }
  }

  static bool is_complete(const Instance& instance) {
    if (instance.raw_system != nullptr) return true;
    const elements::Kind& kind = *instance.kind;
    const std::size_t controls = kind.control == ControlSyntax::node_pair ? instance.control_nodes.size() : instance.references.size();
    const auto terminals = static_cast<std::size_t>(kind.terminals);
    if (instance.nodes.size() < terminals || instance.nodes.size() > terminals + static_cast<std::size_t>(kind.optional_terminals))
      return false;
    if (kind.tail == elements::Tail::formula || instance.formula) return instance.formula.has_value();
    if (kind.control != ControlSyntax::none && controls == 0) return false;
    if (kind.tail == elements::Tail::block) return instance.model >= 0 && !instance.inputs.empty();
    if (kind.tail == elements::Tail::model) return instance.model >= 0;
    return kind.tail != elements::Tail::gain || instance.coefficients.size() == controls + 1;
  }

  void emit() {
    mark_gate_drives(circuit_);
    for (const model::Label& node : circuit_.nodes()) (void)builder_.inner_node(node);
    emitted_.resize(circuit_.instances.size());
    Diagnostics scratch;
    elements::Emission emission(circuit_.instances, circuit_.models, emitted_, builder_, scratch);
    const Analyses& analyses = circuit_.analyses;
    if (analyses.sensitivities || (analyses.small_signal && analyses.steady_state)) emission.keep_comparisons();
    each(emission, &elements::Kind::emit);
    each(emission, &elements::Kind::connect);
    reporter_.forward(scratch);
    check_couplings();
    add_current_conditions();
    warn_of_unused_ic();
  }

  /// Saved ones first, then those that are drawn only, then those that are measured only.
  void add_signals(std::vector<SignalSource> signals, const std::vector<SignalSource>& probes) {
    const std::size_t saved = signals.size();
    std::vector<SignalSource> drawn = resolve_drawn(circuit_, names_, signals);
    circuit_.drawn_signals = drawn.size();
    signals.insert(signals.end(), std::make_move_iterator(drawn.begin()), std::make_move_iterator(drawn.end()));
    auto& numbers = circuit_.measurements.probe_signals;
    for (const SaveRequest& probe : circuit_.probes)
      circuit_.measurements.probe_quantities.push_back(probe.kind == SaveRequest::Kind::voltage   ? Quantity::voltage
                                                       : probe.kind == SaveRequest::Kind::current ? Quantity::current
                                                                                                  : Quantity::other);
    for (const SignalSource& probe : probes) {
      const auto known = std::find_if(signals.begin(), signals.end(), [&](const SignalSource& other) { return other.is_same(probe); });
      numbers.push_back(static_cast<int>(known - signals.begin()));
      if (known == signals.end()) signals.push_back(probe);
    }
    circuit_.measured_signals = signals.size() - saved;
    circuit_.orbit_measurements.probe_signals = numbers;
    circuit_.orbit_measurements.probe_quantities = circuit_.measurements.probe_quantities;
    for (const SignalSource& signal : signals) {
      const int index = builder_.add(signal_of(signal, emitted_));
      if (signal.element < 0 || signal.quantity != ' ') continue;
      elements::add_moves(builder_, model::NetworkMove::Item::signal_form, index,
                          emitted_[static_cast<std::size_t>(signal.element)].current_moved);
    }
  }

  void each(elements::Emission& emission, void (*elements::Kind::*step)(elements::Emission&)) {
    for (std::size_t k = 0; k < circuit_.instances.size(); ++k) {
      const auto function = circuit_.instances[k].kind->*step;
      if (function == nullptr) continue;
      emission.select(k);
      function(emission);
    }
  }

  void check_couplings() {
    std::vector<const model::Coupling*> sorted;
    for (const model::Coupling& coupling : builder_.network().couplings) sorted.push_back(&coupling);
    const auto pair_of = [](const model::Coupling* c) {
      return std::pair(std::min(c->inductor_a, c->inductor_b), std::max(c->inductor_a, c->inductor_b));
    };
    std::stable_sort(sorted.begin(), sorted.end(), [&](const auto* a, const auto* b) { return pair_of(a) < pair_of(b); });
    for (std::size_t k = 1; k < sorted.size(); ++k) {
      if (pair_of(sorted[k - 1]) != pair_of(sorted[k])) continue;
      reporter_.error("E-coupling", sorted[k]->label.span,
                      fmt::format("{} couples two inductors that {} couples already", sorted[k]->label.name, sorted[k - 1]->label.name));
    }
  }

  void add_current_conditions() {
    for (const auto& [element, condition] : currents_) {
      const int inductor = emitted_[static_cast<std::size_t>(element)].inductor;
      if (inductor < 0) {
        reporter_.error("E-ic", condition.span, fmt::format("{} has no inductance: it has no initial current", condition.name));
        continue;
      }
      model::Inductor& item = builder_.network().inductors[static_cast<std::size_t>(inductor)];
      item.has_initial = true;
      item.initial_current = condition.value;
      builder_.add(model::CurrentCondition{{condition.name, condition.span}, inductor, condition.value});
    }
  }

  void warn_of_unused_ic() {
    if (circuit_.analyses.steady_state && circuit_.analyses.steady_state->use_initial_conditions) return;
    if (!circuit_.analyses.transient || circuit_.analyses.transient->use_initial_conditions) return;
    for (const Instance& instance : circuit_.instances) {
      const char letter = instance.kind->letter;
      if ((letter != 'C' && letter != 'L') || !instance.values.has("ic")) continue;
      reporter_.warning("W-ic-unused", instance.values.span("ic"), "ic= has an effect only with uic on .tran; try uic, or .ic");
      return;
    }
  }

  FlatCircuit& circuit_;
  Reporter& reporter_;
  NameIndex names_;
  model::NetworkBuilder builder_;
  std::vector<elements::Emitted> emitted_;
  std::vector<std::pair<int, InitialCondition>> currents_;
};

}  // namespace

std::optional<model::Network> assemble(FlatCircuit& circuit, Reporter& reporter) { return Assembler(circuit, reporter).run(); }

std::optional<model::Network> assemble(FlatCircuit& circuit, Diagnostics& diagnostics) {
  Reporter reporter(diagnostics);
  return assemble(circuit, reporter);
}

}  // namespace pwlsim::circuit
