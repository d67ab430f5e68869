#include "spice/deck.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include <fmt/format.h>

#include "base/names.hpp"
#include "circuit/names.hpp"
#include "circuit/reporter.hpp"
#include "circuit/signals.hpp"
#include "elements/twin.hpp"

namespace pwlsim::spice {
namespace {

using circuit::FlatCircuit;
using circuit::SignalSource;

constexpr double steps_at_least = 1000.0;
constexpr double leak = 1e12;  // ohm from every node to ground: floating parts have a potential then

std::vector<std::string> node_names(const FlatCircuit& circuit) {
  std::vector<std::string> names;
  for (const model::Label& node : circuit.nodes()) names.push_back(node.name);
  return names;
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

class DeckWriter {
 public:
  DeckWriter(const FlatCircuit& circuit, const DeckSettings& settings, Diagnostics& diagnostics)
      : circuit_(circuit),
        settings_(settings),
        diagnostics_(diagnostics),
        index_(circuit),
        signals_(read_signals()),
        names_(node_names(circuit), circuit.instances),
        twin_(circuit.instances, circuit.models, names_, observed(), {settings.sharpness, stop(), starts_at_conditions()}, diagnostics) {}

  SmoothDeck write() {
    add_conditions();
    for (std::size_t k = 0; k < circuit_.instances.size(); ++k) {
      twin_.select(k);
      circuit_.instances[k].kind->smooth_twin(twin_);
      if (settings_.snubber.impedance > 0.0) add_snubber(circuit_.instances[k]);
    }
    add_samples();
    SmoothDeck deck{fmt::format("* {}\n", one_line(circuit_.title)), vectors(), {}};
    if (settings_.switching) deck.switching = switching_parts();
    for (const std::string& line : twin_.take_lines()) deck.text += line + '\n';
    deck.text += analysis_cards(deck) + ".end\n";
    return deck;
  }

 private:
  std::vector<SignalSource> read_signals() {
    Diagnostics known;  // assemble has said what there is to say
    circuit::Reporter reporter(known);
    return circuit::resolve_signals(circuit_, index_, reporter);
  }

  double stop() const { return circuit_.analyses.transient ? circuit_.analyses.transient->stop.seconds : 0.0; }

  bool starts_at_conditions() const { return circuit_.analyses.transient && circuit_.analyses.transient->use_initial_conditions; }

  std::vector<char> observed() const {
    std::vector<char> list(circuit_.instances.size(), 0);
    for (const SignalSource& signal : signals_)
      if (signal.element >= 0 && signal.quantity == ' ') list[static_cast<std::size_t>(signal.element)] = 1;
    return list;
  }

  void add_conditions() {
    const bool at_start = starts_at_conditions();
    for (const circuit::InitialCondition& condition : circuit_.conditions) {
      if (!condition.is_current) {
        if (const auto node = index_.node(condition.name)) twin_.start_voltage(names_.node(*node), condition.value);
        continue;
      }
      const int element = index_.element(condition.name);
      twin_.set_initial_current(static_cast<std::size_t>(element), condition.value);
      if (!at_start)
        diagnostics_.error(
            "E-no-twin", condition.span,
            fmt::format("ngspice forces no current in an operating point: `.ic I({})` has an effect there only with uic; try uic",
                        condition.name));
    }
  }

  void add_snubber(const elements::Instance& instance) {
    if (instance.kind->twin_event == nullptr || instance.nodes.size() < 2) return;
    const model::NodeIndex other = instance.nodes.back();  // of a transistor the source
    const std::string middle = twin_.inner("snubber");
    const auto& [impedance, time] = settings_.snubber;
    twin_.resistor("snubber", {names_.node(instance.nodes[0]), middle}, impedance / std::sqrt(settings_.sharpness));
    twin_.capacitor("snubber", {middle, names_.node(other)}, settings_.sharpness * time / impedance);
  }

  void add_samples() {
    if (settings_.sample_times.empty()) return;
    std::string corners = "0 1";
    for (std::size_t k = 0; k < settings_.sample_times.size(); ++k) corners += fmt::format(" {} {}", settings_.sample_times[k], k % 2);
    twin_.line(fmt::format("V.sample pwlsim.sample 0 PWL({})", corners));
    twin_.line("R.sample pwlsim.sample 0 1");
  }

  std::vector<SignalVectors> vectors() const {
    std::vector<SignalVectors> list;
    for (const SignalSource& signal : signals_) list.push_back({signal.column, terms(signal)});
    return list;
  }

  std::vector<std::pair<std::string, double>> terms(const SignalSource& signal) const {
    std::vector<std::pair<std::string, double>> list;
    const auto add = [&](char kind, const std::string& name, double sign) {
      list.emplace_back(without_case(fmt::format("{}({})", kind, name)), sign);
    };
    if (signal.element < 0) {
      if (signal.p != model::ground) add('v', names_.node(signal.p), 1.0);
      if (signal.n != model::ground) add('v', names_.node(signal.n), -1.0);
      return list;
    }
    const auto element = static_cast<std::size_t>(signal.element);
    const std::string part = fmt::format("{}{}", signal.quantity, signal.index + 1);
    if (signal.quantity == ' ') add('i', twin_.meter_of(element), 1.0);
    if (signal.quantity == 'u') add('i', names_.device('V', element, part), 1.0);
    if (signal.quantity == 'x') add('v', names_.inner(element, part), 1.0);
    if (signal.quantity == 'y') add('v', names_.inner(element, part), -1.0);
    return list;
  }

  std::vector<SwitchingPart> switching_parts() {
    std::vector<SwitchingPart> list;
    for (const elements::Instance& instance : circuit_.instances) {
      twin_.look_at(static_cast<std::size_t>(&instance - circuit_.instances.data()));
      const auto event = instance.kind->twin_event != nullptr ? instance.kind->twin_event(twin_) : std::nullopt;
      if (event) {
        SwitchingPart part{{instance.name, {}}, event->on_level, event->off_level};
        for (const auto& [node, sign] : {std::pair(event->control.p, 1.0), std::pair(event->control.n, -1.0)})
          if (node != "0") part.control.terms.emplace_back(without_case(fmt::format("v({})", node)), sign);
        list.push_back(std::move(part));
      }
    }
    return list;
  }

  static void add_saves(const SignalVectors& signal, std::unordered_set<std::string>& saved, std::string& cards) {
    for (const auto& term : signal.terms)
      if (saved.insert(term.first).second) cards += fmt::format(".save {}\n", term.first);
  }

  std::string analysis_cards(const SmoothDeck& deck) const {
    std::string cards;
    std::unordered_set<std::string> saved;
    for (const SignalVectors& signal : deck.signals) add_saves(signal, saved, cards);
    for (const SwitchingPart& part : deck.switching) add_saves(part.control, saved, cards);
    cards += fmt::format(".options reltol={} abstol=1e-9 vntol=1e-6 rshunt={} method={}\n", settings_.reltol, leak,
                         settings_.gear ? "gear" : "trap");
    return cards + (circuit_.analyses.transient ? transient_card(*circuit_.analyses.transient) : ".op\n");
  }

  std::string transient_card(const circuit::TransientAnalysis& transient) const {
    const double length = transient.stop.seconds - transient.start.seconds;
    const double step = transient.row_step();
    const double largest = settings_.largest_step == 0.0 ? std::min(step, length / steps_at_least) : settings_.largest_step;
    return fmt::format(".tran {} {} {} {}{}\n", std::min(step, length), transient.stop.seconds, transient.start.seconds, largest,
                       transient.use_initial_conditions ? " uic" : "");
  }

  const FlatCircuit& circuit_;
  const DeckSettings& settings_;
  Diagnostics& diagnostics_;
  circuit::NameIndex index_;
  std::vector<SignalSource> signals_;
  elements::TwinNames names_;
  elements::Twin twin_;
};

}  // namespace

std::optional<SmoothDeck> smooth_deck(const FlatCircuit& circuit, const DeckSettings& settings, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.error_count();
  SmoothDeck deck = DeckWriter(circuit, settings, diagnostics).write();
  if (diagnostics.error_count() != before) return std::nullopt;
  return deck;
}

}  // namespace pwlsim::spice
