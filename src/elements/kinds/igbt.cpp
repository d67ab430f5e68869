#include <fmt/format.h>

#include <algorithm>

#include "elements/transistor.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::igbt {
namespace {

constexpr Parameter model_parameters[] = {
    {"VT", "V", 4.7, Range::any, false, "Threshold: conducts from collector to emitter while v(gate,emitter) is above."},
    {"KP", "A/V^2", 0.38, Range::positive, false, "Transconductance of its MOSFET; read for the slope resistance."},
    {"Ron", "ohm", 0.0, Range::not_negative, false, "Slope resistance when on. Not given: 1/(KP (Vdrive - VT))."},
    {"Vce", "V", 0.8, Range::not_negative, false, "Drop when on, where its slope begins."},
    {"Vdrive", "V", 10.0, Range::positive, false, "Gate voltage at which Ron is taken; .options vdrive= sets it for all."},
    without_effect("level"),
    without_effect("agd"),
    without_effect("area"),
    without_effect("bvf"),
    without_effect("bvn"),
    without_effect("cgs"),
    without_effect("coxd"),
    without_effect("jsne"),
    without_effect("kf"),
    without_effect("mun"),
    without_effect("mup"),
    without_effect("nb"),
    without_effect("tau"),
    without_effect("theta"),
    without_effect("vtd"),
    without_effect("wb"),
    maker,
    part_number,
    part_type,
};

double overdrive(const Model& model) { return model.values.get("Vdrive") - model.values.get("VT"); }

void complete(Model& model, const Settings& settings, Diagnostics& diagnostics) {
  Values& values = model.values;
  if (!values.has("Vdrive")) values.set("Vdrive", settings.gate_drive);
  if (values.has("Ron")) return;
  if (overdrive(model) > 0.0) return values.set("Ron", 1.0 / (values.get("KP") * overdrive(model)));
  refuse_drive(model, "VT", diagnostics);
}

constexpr ModelKind n_channel{"NIGBT", "IGBT", model_parameters, complete, nullptr, true};
constexpr const ModelKind* models[] = {&n_channel};

constexpr Parameter parameters[] = {
    multiplicity,         without_effect("area"), without_effect("wb"), without_effect("agd"),
    without_effect("kp"), without_effect("tau"),  temperature,          temperature_difference,
};

/// A diode while its gate is on; else it blocks.
void emit(Emission& emission) {
  const Instance& instance = emission.instance();
  const Values& v = emission.model().values;
  model::NetworkBuilder& builder = emission.builder();
  model::Switch condition;
  condition.label = emission.label("gate");
  condition.resistance = 1.0;  // across itself it carries nothing, open or closed
  condition.control = model::voltage_between(instance.nodes[1], instance.nodes[2]);
  condition.on_level = condition.off_level = v.get("VT");
  model::Diode valve{emission.label(), instance.nodes[0], instance.nodes[2], v.get("Ron") / emission.value("m"), v.get("Vce")};
  const auto index = static_cast<int>(builder.network().diodes.size());
  valve.enabled_by = {builder.add(std::move(condition))};
  builder.add(std::move(valve));
  emission.result().current = quantity(Quantity::diode_current, index);
  note_idealised(emission, fmt::format("while v(gate,emitter) > {} V it conducts from collector to emitter, {}; without a diode across it",
                                       v.get("VT"), words_of({v.get("Ron"), v.get("Vce")})));
}

void smooth_twin(Twin& twin) {
  const Values& v = twin.model().values;
  const std::string collector = twin.ends().p, emitter = twin.node(twin.instance().nodes[2]), inner = twin.inner("collector");
  const double level = v.get("VT");
  twin.contact("gate", {collector, inner}, {twin.node(twin.instance().nodes[1]), emitter}, {0.0, infinite, level, level, false});
  twin.diode({}, {inner, emitter}, {std::max(v.get("Ron") / twin.value("m"), twin.sharpness()), infinite, v.get("Vce")});
}

constexpr int tied[] = {0, 2};

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "IGBT";
  kind.letter = 'Z';
  kind.usage = "Z<name> collector gate emitter model [m=]";
  kind.text = "An IGBT of PSpice as a switch at its threshold that conducts one way, with a drop.";
  kind.terminals = 3;
  kind.tied_terminals = tied;
  kind.tail = Tail::model;
  kind.parameters = parameters;
  kind.models = models;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::igbt
