#include "circuit/compile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>
#include <utility>
#include <variant>

#include "base/names.hpp"
#include "circuit/assemble.hpp"
#include "circuit/devices.hpp"
#include "circuit/flatten.hpp"
#include "circuit/parameter_moves.hpp"
#include "circuit/row_step.hpp"
#include "circuit/shipped.hpp"

namespace pwlsim::circuit {
namespace {

/// Names that are not of a constant source are passed over: the caller finds no source of their channel.
void hold_sources(const std::vector<std::string>& names, FlatCircuit& circuit) {
  for (std::size_t channel = 0; channel < names.size(); ++channel)
    for (elements::Instance& instance : circuit.instances) {
      const model::SourceFunction function = instance.waveform.value_or(model::Dc{});
      const auto* const constant = std::get_if<model::Dc>(&function);
      if (constant != nullptr && same_name(instance.name, names[channel]))
        instance.waveform = model::Held{constant->value, static_cast<int>(channel)};
    }
}

/// By its .control section, by cards that print or plot, by the title that KiCad gives its netlists, or by the numbers of exponential diodes and of
/// transistors that are no switches of their own (`Ron`).
bool is_for_ngspice(const FlatCircuit& circuit, const Diagnostics& told) {
  const auto is_section = [](const Diagnostic& diagnostic) {
    return diagnostic.id == "N-control-skipped" || diagnostic.id == "N-diode-tangent";
  };
  const auto is_of_spice = [](const elements::Model& model) {
    constexpr std::string_view types[] = {"NMOS", "PMOS", "VDMOS", "NPN", "PNP", "NJF", "PJF"};
    if (model.kind == nullptr || std::find(std::begin(types), std::end(types), model.kind->type) == std::end(types)) return false;
    const bool may_be_switch = elements::find_parameter(model.values.table(), "Ron") != nullptr;
    return !may_be_switch || !model.values.has("Ron");
  };
  return circuit.prints || circuit.title.find("KiCad") != std::string::npos ||
         std::any_of(told.all().begin(), told.all().end(), is_section) ||
         std::any_of(circuit.models.begin(), circuit.models.end(), is_of_spice);
}

/// What ngspice takes otherwise: a pulse without a top lasts there, and a diode without numbers is SPICE's default one.
void tell_of_ngspice(const FlatCircuit& circuit, Reporter& reporter) {
  for (const elements::Instance& instance : circuit.instances) {
    const auto* const pulse = instance.waveform ? std::get_if<model::Pulse>(&*instance.waveform) : nullptr;
    if (pulse == nullptr || pulse->width != 0.0 || pulse->initial == pulse->pulsed) continue;
    reporter.note("N-pulse-without-top", instance.span,
                  fmt::format("{}: Ton = 0 is a pulse without a top, as in LTspice; ngspice takes it as the time to the end of the run",
                              instance.name));
  }
  for (const elements::Model& each : circuit.models) {
    if (each.kind == nullptr || each.kind->type != "D" || !each.values.all().empty()) continue;
    reporter.note(
        "N-ideal-diode", each.span,
        fmt::format("the model {} has no numbers: its diodes are ideal, without a drop; in SPICE IS is 1e-14 then: try D(IS=1e-14)",
                    each.name));
  }
}

/// A transistor, or a diode within a shipped subcircuit, most of which are amplifiers: small signals of other programs are around its operating
/// point. Null if there is none.
const elements::Instance* amplifying(const FlatCircuit& circuit, const Reporter& reporter) {
  const auto is_amplifying = [&](const elements::Instance& instance) {
    const bool is_transistor = std::string_view("QMJ").find(instance.kind->letter) != std::string_view::npos;
    return is_transistor || (instance.kind->letter == 'D' && is_shipped(reporter.file_of(instance.span)));
  };
  const auto found = std::find_if(circuit.instances.begin(), circuit.instances.end(), is_amplifying);
  return found == circuit.instances.end() ? nullptr : &*found;
}

/// A deck of other programs has several analyses, each a run of its own: the others do not fail with `.ac`.
void leave_out_small_signals(FlatCircuit& circuit, Reporter& reporter) {
  Analyses& analyses = circuit.analyses;
  if (!analyses.small_signal || analyses.steady_state || !(analyses.transient || analyses.operating_point)) return;
  const SmallSignalAnalysis& card = *analyses.small_signal;
  const bool is_of_spice = card.input == SmallSignalAnalysis::Input::marked && card.loop.empty() && card.harmonic == 0 && !card.sample;
  const elements::Instance* instance = amplifying(circuit, reporter);
  if (!is_of_spice || instance == nullptr) return;
  reporter.warning("W-ignored-card", card.span,
                   fmt::format("this .ac is left out: {} is a line in each of its states, and small signals are those around a periodic "
                               "steady state; try .pss",
                               instance->name));
  analyses.small_signal.reset();
}

std::vector<RatedCurrent> rated_currents(const FlatCircuit& circuit, const Reporter& reporter) {
  std::vector<RatedCurrent> rated;
  for (const elements::Instance& instance : circuit.instances) {
    if (instance.model < 0) continue;
    const elements::Model& model = circuit.models[static_cast<std::size_t>(instance.model)];
    const bool is_rated = elements::find_parameter(model.values.table(), "Iave") != nullptr && model.values.has("Iave");
    if (is_rated && reporter.file_of(model.span) == device_models_file)
      rated.push_back({instance.name, model.values.get("Iave") * instance.values.get("m")});
  }
  return rated;
}

/// A Zener diode is there to break down: its row in the table gives a resistance of its own for that.
bool is_meant_to_break_down(const elements::Values& values) {
  return elements::find_parameter(values.table(), "Rrev") != nullptr && values.has("Rrev") && values.get("Rrev") != values.get("Ron");
}

std::vector<std::string> rated_ports(const FlatCircuit& circuit, const model::Network& network, const Reporter& reporter) {
  constexpr std::string_view breakdowns[] = {" (reverse)", " (body diode reverse)"};
  std::unordered_set<std::string> names;
  for (const elements::Instance& instance : circuit.instances) {
    if (instance.model < 0) continue;
    const elements::Model& model = circuit.models[static_cast<std::size_t>(instance.model)];
    if (reporter.file_of(model.span) != device_models_file) continue;
    if (is_meant_to_break_down(model.values)) continue;
    for (const std::string_view breakdown : breakdowns) names.insert(instance.name + std::string(breakdown));
  }
  std::vector<std::string> ports;
  for (const model::Diode& diode : network.diodes)
    if (names.contains(diode.label.name)) ports.push_back(diode.label.name);
  return ports;
}

/// The voltage of a source that a formula has taken as a number has no small signals there.
void warn_of_folded(const FlatCircuit& circuit, Reporter& reporter) {
  if (!circuit.analyses.small_signal) return;
  const SmallSignalAnalysis& card = *circuit.analyses.small_signal;
  for (const FlatCircuit::Folded& folded : circuit.folded) {
    const elements::Instance& source = circuit.instances[static_cast<std::size_t>(folded.source)];
    const elements::Instance& reader = circuit.instances[static_cast<std::size_t>(folded.reader)];
    const bool is_named =
        card.input == SmallSignalAnalysis::Input::source &&
        std::any_of(card.sources.begin(), card.sources.end(), [&](const std::string& name) { return same_name(name, source.name); });
    const bool is_marked = card.loop.empty() && card.input == SmallSignalAnalysis::Input::marked && source.alternating != 0.0;
    if ((is_named || is_marked || same_name(card.loop, source.name)) && reporter.first_time("folded:" + source.name + ':' + reader.name))
      reporter.warning(
          "W-ac-number", reader.span,
          fmt::format("{} takes the voltage of {} as a number: what a small signal of {} does there is not in the response; try an "
                      "expression in which it is no factor",
                      reader.name, source.name, source.name));
  }
}

/// With another node as ground where none is written.
Flattened flatten_with_ground(const netlist::Deck& deck, SourceStore& sources, Reporter& reporter, const CompileOptions& options) {
  Flattened flattened = flatten(deck, sources, reporter, options.analysis_required, options.run);
  if (!flattened.expanded || reporter.failed()) return flattened;
  if (const std::string ground = missing_ground(flattened.circuit); !ground.empty()) {
    Diagnostics said;  // the first time
    Reporter known(said, sources);
    flattened = flatten(deck, sources, known, options.analysis_required, options.run, ground);
    reporter.note("N-no-ground", deck.title_span,
                  fmt::format("no element is connected to ground: the node {} is used as ground; try 0 as its name", ground));
  }
  return flattened;
}

Compiled result_of(FlatCircuit&& circuit, model::Network&& network, const CompileOptions& options, Reporter& reporter) {
  Compiled compiled{circuit.title, std::move(network), circuit.analyses, std::nullopt};
  if (options.measure) compiled.measurements = circuit.measurements;
  if (options.measure) compiled.orbit_measurements = circuit.orbit_measurements;
  compiled.measured_signals = circuit.measured_signals;
  compiled.drawn_signals = circuit.drawn_signals;
  compiled.hidden = circuit.hidden;
  compiled.draws_random = circuit.draws_random;
  compiled.has_mosfets =
      std::any_of(circuit.instances.begin(), circuit.instances.end(), [](const elements::Instance& i) { return i.kind->letter == 'M'; });
  compiled.has_machines = circuit.has_machines;
  compiled.names_signals =
      std::any_of(circuit.saves.begin(), circuit.saves.end(), [](const SaveRequest& save) { return save.kind != SaveRequest::Kind::all; });
  compiled.rated_ports = rated_ports(circuit, compiled.network, reporter);
  compiled.rated_currents = rated_currents(circuit, reporter);
  for (model::Switch& contact : compiled.network.switches)
    if (circuit.hidden.hold(contact.label.name)) contact.written.reset();
  if (options.keep_circuit) compiled.circuit = std::move(circuit);
  return compiled;
}

}  // namespace

std::optional<Compiled> compile(const netlist::Deck& deck, SourceStore& sources, Diagnostics& diagnostics, const CompileOptions& options) {
  Reporter reporter(diagnostics, sources);
  Flattened flattened = flatten_with_ground(deck, sources, reporter, options);
  if (!flattened.expanded) return std::nullopt;
  FlatCircuit& circuit = flattened.circuit;
  if (circuit.analyses.sweeps.runs() == 0) circuit.drawn = options.drawn;
  hold_sources(options.held, circuit);
  if (is_for_ngspice(circuit, diagnostics)) tell_of_ngspice(circuit, reporter);
  std::optional<model::Network> network = assemble(circuit, reporter);
  if (!network) return std::nullopt;
  follow_parameters(circuit, *network, reporter);
  if (reporter.failed()) return std::nullopt;
  leave_out_small_signals(circuit, reporter);
  warn_of_folded(circuit, reporter);
  if (circuit.analyses.transient) {
    check_row_step(*network, *circuit.analyses.transient, reporter);
    resolve_last_periods(*network, circuit.analyses, circuit.measurements, reporter);
    if (reporter.failed()) return std::nullopt;
  }
  if (!options.measure && circuit.analyses.sweeps.runs() > 1)
    reporter.note("N-first-run", circuit.analyses.sweeps.list.front().span,
                  fmt::format("the first of the {} runs of .step is used", circuit.analyses.sweeps.runs()));
  if (!options.measure) {
    network->signals.resize(network->signals.size() - std::exchange(circuit.measured_signals, 0));
    circuit.drawn_signals = 0;
  }
  return result_of(std::move(circuit), std::move(*network), options, reporter);
}

}  // namespace pwlsim::circuit
