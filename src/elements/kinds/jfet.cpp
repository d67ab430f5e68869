#include <fmt/format.h>

#include "elements/transistor.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::jfet {
namespace {

constexpr Parameter model_parameters[] = {
    {"Vto", "V", -2.0, Range::any, false, "Threshold: closed while v(gate,source) is above; P channel: v(source,gate)."},
    {"Vt0", "V", -2.0, Range::any, false, "Another name of Vto."},
    {"Beta", "A/V^2", 1e-4, Range::positive, false, "Transconductance parameter."},
    {"Ron", "ohm", 0.0, Range::not_negative, false,
     "Resistance when on. Not given: Rd + Rs + 1/(2 Beta (-Vto)), that of v(gate,source) = 0."},
    {"Rd", "ohm", 0.0, Range::not_negative, false, "Drain resistance."},
    {"Rs", "ohm", 0.0, Range::not_negative, false, "Source resistance."},
    {"Is", "A", 1e-14, Range::positive, false, "Saturation current of the gate diodes; read for their tangent at i0."},
    {"N", "", 1.0, Range::positive, false, "Emission coefficient of the gate diodes; read for their tangent at i0."},
    junction_current,
    without_effect("level"),
    without_effect("lambda"),
    without_effect("cgs"),
    without_effect("cgd"),
    without_effect("pb"),
    without_effect("m"),
    without_effect("isr"),
    without_effect("nr"),
    without_effect("alpha"),
    without_effect("vk"),
    without_effect("b"),
    without_effect("fc"),
    without_effect("kf"),
    without_effect("af"),
    without_effect("nlev"),
    without_effect("gdsnoi"),
    without_effect("betatce"),
    without_effect("vtotc"),
    without_effect("xti"),
    without_effect("eg"),
    without_effect("tnom"),
    without_effect("tcv"),
    without_effect("bex"),
    maker,
    part_number,
    part_type,
};

void complete(Model& model, const Settings& settings, Diagnostics& diagnostics) {
  Values& values = model.values;
  if (values.has("Vt0") && !values.has("Vto")) values.set("Vto", values.get("Vt0"), values.span("Vt0"));
  if (settings.finds_currents && !model.values.has("I0")) model.law = exponential_law(model.values.get("Is"), model.values.get("N"), 0.0);
  take_junction_current(model, settings);
  model.finds_drive = settings.finds_drives && !values.has("Ron");
  if (values.has("Ron") || values.get("Vto") < 0.0) return;
  diagnostics.error(
      "E-not-idealised", model.span,
      fmt::format("the {} {} is not a switch: it is off at v(gate,source) = 0; try Ron= on the model", model.kind->text, model.name));
}

constexpr ModelKind n_channel{"NJF", "junction FET", model_parameters, complete, nullptr, true};
constexpr ModelKind p_channel{"PJF", "P-channel junction FET", model_parameters, complete, nullptr, true};
constexpr const ModelKind* models[] = {&n_channel, &p_channel};

constexpr Parameter parameters[] = {
    multiplicity, without_effect("area"), without_effect("off"), without_effect("ic"), temperature, temperature_difference,
};

bool is_p_type(const Model& model) { return model.kind == &p_channel; }

Channel channel_of(const Instance& instance, const Model& model) {
  const Values& v = model.values;
  const double on = v.has("Ron") ? v.get("Ron") : v.get("Rd") + v.get("Rs") - 1.0 / (2.0 * v.get("Beta") * v.get("Vto"));
  // The sign of Vto is that of an N channel in both types.
  return {is_p_type(model), is_p_type(model) ? -v.get("Vto") : v.get("Vto"), on / instance.values.get("m")};
}

/// In saturation the current is Beta (v(gate,source) - Vto)².
model::ChannelLaw law_of_channel(const Instance& instance, const Model& model) {
  const Values& v = model.values;
  const double devices = instance.values.get("m");
  return {(v.get("Rd") + v.get("Rs")) / devices, 2.0 * v.get("Beta") * devices};
}

/// In series with the gate's junction to the drain (`Rd`) or to the source (`Rs`).
Tangent law_of(const Instance& instance, const Model& model, std::string_view series) {
  const Values& v = model.values;
  Tangent law = tangent(v.get("Is"), v.get("N"), v.get(series), v.get("I0"));
  law.resistance /= instance.values.get("m");
  return law;
}

Junction gate_diode(const Instance& instance, const Model& model, std::string_view part, std::size_t terminal) {
  const std::string_view series = terminal == 0 ? "Rd" : "Rs";
  std::optional<model::ExponentialLaw> law = model.law;
  if (law) law->series = model.values.get(series);
  return {part,
          is_p_type(model),
          {instance.nodes[1], instance.nodes[terminal]},
          law_of(instance, model, series),
          infinite,
          in_parallel(law, instance.values.get("m"))};
}

void emit(Emission& emission) {
  const Instance& instance = emission.instance();
  Channel channel = channel_of(instance, emission.model());
  channel.gate = instance.nodes[1];
  if (instance.drive_is_apart && emission.model().finds_drive) channel.law = law_of_channel(instance, emission.model());
  instance.drive_is_apart ? add_following_channel(emission, channel) : add_channel(emission, channel);
  add_junction(emission, gate_diode(instance, emission.model(), "gate-drain diode", 0), -1.0);
  add_junction(emission, gate_diode(instance, emission.model(), "gate-source diode", 2), 0.0);
  note_idealised(emission,
                 fmt::format("{} while v(gate,source) {} {} V, Ron = {:.6g} ohm, and gate diodes, {}",
                             instance.drive_is_apart ? "a linear channel (its gate is not driven against its source) that conducts"
                                                     : "a switch closed",
                             channel.p_type ? "<" : ">", channel.threshold, channel.resistance * emission.value("m"),
                             words_of(law_of(instance, emission.model(), "Rs"))));
}

void smooth_twin(Twin& twin) {
  const Instance& instance = twin.instance();
  twin_of_channel(twin, channel_of(instance, twin.model()));
  const std::string gate = twin.node(instance.nodes[1]);
  twin_of_junction(twin, gate_diode(instance, twin.model(), "drain", 0), {gate, twin.ends().p});
  twin_of_junction(twin, gate_diode(instance, twin.model(), "source", 2), {gate, twin.node(instance.nodes[2])});
}

constexpr int tied[] = {0, 1, 2};

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "junction FET";
  kind.letter = 'J';
  kind.usage = "J<name> drain gate source model [m=]";
  kind.text = "A junction FET as a switch at its threshold with the diodes of its gate.";
  kind.terminals = 3;
  kind.tied_terminals = tied;
  kind.tail = Tail::model;
  kind.parameters = parameters;
  kind.models = models;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  kind.twin_event = [](const Twin& twin) { return std::optional(event_of_channel(twin, channel_of(twin.instance(), twin.model()))); };
  return kind;
}

}  // namespace pwlsim::elements::kinds::jfet
