#include <cmath>

#include <fmt/format.h>

#include "elements/transistor.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::mosfet {
namespace {

constexpr Parameter threshold{"Vto", "V", 0.0, Range::any, false, "Threshold: closed while v(gate,source) is above; P channel: below."};
constexpr Parameter on_resistance{
    "Ron", "ohm", 0.0, Range::not_negative, false, "Resistance when on. Not given: Rd + Rs + 1/(Kp W/L (Vdrive - Vto))."};
constexpr Parameter drain_resistance{"Rd", "ohm", 0.0, Range::not_negative, false, "Drain resistance."};
constexpr Parameter source_resistance{"Rs", "ohm", 0.0, Range::not_negative, false, "Source resistance."};
constexpr Parameter drive{"Vdrive",        "V",   10.0,
                          Range::positive, false, "Gate voltage at which Ron is taken; .options vdrive= sets it for all."};
constexpr Parameter body_saturation{
    "Is", "A", 1e-14, Range::positive, false, "Saturation current of the body diode; read for its tangent at i0."};
constexpr Parameter body_emission{
    "N", "", 1.0, Range::positive, false, "Emission coefficient of the body diode; read for its tangent at i0."};
constexpr Parameter body_drop{"Vfwd", "V", 0.0, Range::not_negative, false, "Drop of the body diode; from Is and N if given."};
constexpr Parameter body_slope{"Rfwd", "ohm", 0.0, Range::not_negative, false, "Slope resistance of the body diode, likewise."};

constexpr Parameter gate_resistance{"Rg", "ohm", 0.0, Range::not_negative, false, "Gate resistance; read with .options gatecap."};

constexpr Parameter planar_parameters[] = {
    threshold,
    {"Vt0", "V", 0.0, Range::any, false, "Another name of Vto."},
    {"Kp", "A/V^2", 2e-5, Range::positive, false,
     "Transconductance parameter. Not given: mobility times capacitance of the oxide, with tox."},
    {"tox", "m", 1e-7, Range::positive, false, "Thickness of the oxide; read for Kp."},
    {"u0", "cm^2/(V s)", 600.0, Range::positive, false, "Mobility; read for Kp."},
    {"uo", "cm^2/(V s)", 600.0, Range::positive, false, "Another name of u0."},
    on_resistance,
    drain_resistance,
    source_resistance,
    drive,
    body_saturation,
    body_emission,
    body_drop,
    body_slope,
    {"W", "m", 1e-4, Range::positive, false, "Width of the channel; a value on the element takes precedence."},
    {"L", "m", 1e-4, Range::positive, false, "Length of the channel; a value on the element takes precedence."},
    {"level", "", 1.0, Range::any, false, "1, 2 or 3: Shichman-Hodges, Grove-Frohman, semi-empirical."},
    without_effect("gamma"),
    without_effect("phi"),
    without_effect("lambda"),
    without_effect("cbd"),
    without_effect("cbs"),
    without_effect("pb"),
    {"cgso", "F/m", 0.0, Range::not_negative, false, "Gate-source overlap capacitance per width; read with .options gatecap."},
    {"cgdo", "F/m", 0.0, Range::not_negative, false, "Gate-drain overlap capacitance per width; read with .options gatecap."},
    without_effect("cgbo"),
    without_effect("cgs"),
    without_effect("cgd"),
    without_effect("cgdmin"),
    without_effect("cgdmax"),
    without_effect("cjo"),
    without_effect("rsh"),
    without_effect("cj"),
    without_effect("mj"),
    without_effect("cjsw"),
    without_effect("mjsw"),
    without_effect("js"),
    without_effect("ld"),
    without_effect("fc"),
    without_effect("nsub"),
    without_effect("nss"),
    without_effect("nfs"),
    without_effect("tpg"),
    without_effect("xj"),
    without_effect("ucrit"),
    without_effect("uexp"),
    without_effect("utra"),
    without_effect("vmax"),
    without_effect("neff"),
    without_effect("delta"),
    without_effect("theta"),
    without_effect("eta"),
    without_effect("kappa"),
    without_effect("kf"),
    without_effect("af"),
    without_effect("tnom"),
    gate_resistance,
    without_effect("rb"),
    without_effect("rds"),
    without_effect("wd"),
    without_effect("xl"),
    without_effect("xw"),
    without_effect("jssw"),
    without_effect("nlev"),
    without_effect("tt"),
    without_effect("gdsnoi"),
    without_effect("xqc"),
    maker,
    part_number,
    part_type,
};

constexpr Parameter vertical_parameters[] = {
    threshold,
    {"Kp", "A/V^2", 1.0, Range::positive, false, "Transconductance parameter."},
    on_resistance,
    drain_resistance,
    source_resistance,
    drive,
    body_saturation,
    body_emission,
    {"Rb", "ohm", 0.0, Range::not_negative, false, "Series resistance of the body diode; read for its tangent at i0."},
    {"BV", "V", infinite, Range::not_negative, true, "Breakdown voltage of the body diode."},
    body_drop,
    body_slope,
    {"nchan", "", 0.0, Range::any, false, "A single word: N channel, the default.", Use::honoured, false, true},
    {"pchan", "", 0.0, Range::any, false, "A single word: P channel.", Use::honoured, false, true},
    without_effect("phi"),
    without_effect("lambda"),
    without_effect("mtriode"),
    without_effect("ksubthres"),
    without_effect("subthres"),
    without_effect("subshift"),
    without_effect("theta"),
    without_effect("rq"),
    without_effect("vq"),
    without_effect("ibv"),
    without_effect("nbv"),
    gate_resistance,
    without_effect("rds"),
    without_effect("cjo"),
    {"cgs", "F", 0.0, Range::not_negative, false, "Gate-source capacitance; read with .options gatecap."},
    {"cgdmin", "F", 0.0, Range::not_negative, false, "Least gate-drain capacitance; read with .options gatecap."},
    {"cgdmax", "F", 0.0, Range::not_negative, false, "Largest gate-drain capacitance; read with .options gatecap."},
    without_effect("cgd"),
    without_effect("cgso"),
    without_effect("cgdo"),
    without_effect("cgbo"),
    without_effect("a"),
    without_effect("m"),
    without_effect("vj"),
    without_effect("fc"),
    without_effect("tt"),
    without_effect("eg"),
    without_effect("xti"),
    without_effect("L"),
    without_effect("W"),
    without_effect("kf"),
    without_effect("af"),
    without_effect("tnom"),
    without_effect("Vds"),
    without_effect("Qg"),
    without_effect("vtotc"),
    without_effect("tcvth"),
    without_effect("mu"),
    without_effect("texp0"),
    without_effect("texp1"),
    without_effect("trd1"),
    without_effect("trd2"),
    without_effect("trg1"),
    without_effect("trg2"),
    without_effect("trs1"),
    without_effect("trs2"),
    without_effect("trb1"),
    without_effect("trb2"),
    without_effect("tbv1"),
    without_effect("tbv2"),
    without_effect("rthjc"),
    without_effect("rthca"),
    without_effect("cthj"),
    without_effect("tksubthres1"),
    without_effect("tksubthres2"),
    without_effect("vgs_max"),
    without_effect("vgd_max"),
    without_effect("vds_max"),
    without_effect("id_max"),
    without_effect("idr_max"),
    without_effect("pd_max"),
    without_effect("rth_ja"),
    without_effect("rth_jc"),
    without_effect("te_max"),
    without_effect("derating"),
    maker,
    part_number,
    part_type,
};

constexpr std::string_view vertical_gate_names[] = {"Rg", "cgs", "cgdmin", "cgdmax"}, planar_gate_names[] = {"Rg", "cgso", "cgdo"};
constexpr std::string_view body_names[] = {"Is", "N", "Rb", "BV"};

bool is_vertical(const Model& model) { return model.kind->type == "VDMOS"; }
bool is_p_type(const Model& model) { return model.kind->type == "PMOS" || (is_vertical(model) && model.values.has("pchan")); }

/// A parameter that only some of the types have.
double optional(const Model& model, std::string_view name, double fallback) {
  return find_parameter(model.values.table(), name) != nullptr ? model.values.get(name) : fallback;
}

double overdrive(const Model& model) {
  const double vto = model.values.get("Vto");
  return model.values.get("Vdrive") - (is_p_type(model) ? -vto : vto);
}

void take_body_diode(Model& model, const Settings& settings) {
  bool is_exponential = settings.written_by_ltspice || !model.values.has("Ron");  // a model of SPICE, where Is and N have defaults
  for (std::string_view name : body_names)
    is_exponential |= find_parameter(model.values.table(), name) != nullptr && model.values.has(name);
  if (!is_exponential || model.values.has("Vfwd") || model.values.has("Rfwd")) return;
  const model::ExponentialLaw exponential = exponential_law(model.values.get("Is"), model.values.get("N"), optional(model, "Rb", 0.0));
  const Tangent law = exponential.tangent(settings.tangent_current);
  if (settings.finds_currents) model.law = exponential;
  model.values.set("Vfwd", law.drop);
  model.values.set("Rfwd", law.resistance);
}

/// Kp of a planar transistor whose model tells of its oxide instead.
void take_transconductance(Values& values) {
  constexpr double oxide_permittivity = 3.9 * 8.8541878128e-12;  // F/m
  constexpr double square_metres = 1e-4;                         // of a cm²
  const double mobility = square_metres * (values.has("uo") ? values.get("uo") : values.get("u0"));
  if (values.has("tox") && !values.has("Kp")) values.set("Kp", mobility * oxide_permittivity / values.get("tox"));
}

/// Linear ones: of a power MOSFET the gate-drain capacitance at v(gate,drain) = 0, half way between its least and its largest (LTspice's help, "M. MOSFET").
void take_gate(Model& model, const Settings& settings, Diagnostics& diagnostics) {
  const Values& v = model.values;
  if (!settings.keeps_gates) {
    const std::string names =
        written(model, is_vertical(model) ? std::span<const std::string_view>(vertical_gate_names) : planar_gate_names);
    if (!names.empty())
      diagnostics.warning("W-ignored-parameter", model.span,
                          fmt::format("{} of model {} {} ignored, because gates switch without delay; try .options gatecap", names,
                                      model.name, names.find(',') == std::string::npos ? "is" : "are"));
    return;
  }
  model.gate = is_vertical(model) ? GateParts{v.get("Rg"), v.get("cgs"), 0.5 * (v.get("cgdmin") + v.get("cgdmax"))}
                                  : GateParts{v.get("Rg"), v.get("cgso"), v.get("cgdo")};
}

void complete(Model& model, const Settings& settings, Diagnostics& diagnostics) {
  Values& values = model.values;
  take_gate(model, settings, diagnostics);
  if (!is_vertical(model)) take_transconductance(values);
  if (!is_vertical(model) && values.has("Vt0") && !values.has("Vto")) values.set("Vto", values.get("Vt0"), values.span("Vt0"));
  model.finds_drive = settings.finds_drives && !values.has("Vdrive") && !values.has("Ron");
  if (!values.has("Vdrive")) values.set("Vdrive", settings.gate_drive);
  take_body_diode(model, settings);
  if (values.has("Ron") || overdrive(model) > 0.0) return;
  refuse_drive(model, "Vto", diagnostics);
}

constexpr double levels[] = {1.0, 2.0, 3.0};
constexpr ModelKind n_channel{"NMOS", "MOSFET", planar_parameters, complete, nullptr, true, levels};
constexpr ModelKind p_channel{"PMOS", "P-channel MOSFET", planar_parameters, complete, nullptr, true, levels};
constexpr ModelKind vertical{"VDMOS", "power MOSFET", vertical_parameters, complete, nullptr, true, {}, false};
constexpr const ModelKind* models[] = {&n_channel, &p_channel, &vertical};

constexpr Parameter parameters[] = {
    multiplicity,
    {"W", "m", 1e-4, Range::positive, false, "Width of the channel."},
    {"L", "m", 1e-4, Range::positive, false, "Length of the channel."},
    without_effect("AD"),
    without_effect("AS"),
    without_effect("PD"),
    without_effect("PS"),
    without_effect("NRD"),
    without_effect("NRS"),
    without_effect("off"),
    without_effect("ic"),
    without_effect("nf"),
    temperature,
    temperature_difference,
};

double size_of(const Instance& instance, const Model& model, std::string_view name) {
  return instance.values.has(name) ? instance.values.get(name) : model.values.get(name);
}

/// Of one device.
model::ChannelLaw law_of(const Instance& instance, const Model& model) {
  const Values& v = model.values;
  const double shape = is_vertical(model) ? 1.0 : size_of(instance, model, "W") / size_of(instance, model, "L");
  return {v.get("Rd") + v.get("Rs"), v.get("Kp") * shape};
}

double resistance_of(const Instance& instance, const Model& model) {
  return model.values.has("Ron") ? model.values.get("Ron") : law_of(instance, model).resistance(overdrive(model));
}

Channel channel_of(const Instance& instance, const Model& model) {
  const double devices = instance.values.get("m");
  Channel channel{is_p_type(model), model.values.get("Vto"), resistance_of(instance, model) / devices};
  if (model.finds_drive) {
    const model::ChannelLaw one = law_of(instance, model);
    channel.law = model::ChannelLaw{one.series / devices, one.gain * devices};
  }
  return channel;
}

model::NodeIndex bulk_of(const Instance& instance, const Model& model) {
  return is_vertical(model) || instance.nodes.size() < 4 ? instance.nodes[2] : instance.nodes[3];
}

Junction body_diode(const Instance& instance, const Model& model, std::string_view part, std::size_t terminal) {
  const Values& v = model.values;
  return {part,
          is_p_type(model),
          {bulk_of(instance, model), instance.nodes[terminal]},
          {v.get("Rfwd") / instance.values.get("m"), v.get("Vfwd")},
          optional(model, "BV", infinite),
          in_parallel(model.law, instance.values.get("m"))};
}

/// Of the instance: all its devices, and their width.
GateParts gate_of(const Instance& instance, const Model& model) {
  const double devices = instance.values.get("m"), width = devices * (is_vertical(model) ? 1.0 : size_of(instance, model, "W"));
  return {model.gate->resistance / devices, width * model.gate->to_source, width * model.gate->to_drain};
}

/// The gate of the channel, behind its resistance, with its capacitances.
model::NodeIndex add_gate(Emission& emission) {
  const Instance& instance = emission.instance();
  const model::NodeIndex outside = instance.nodes[1];
  if (!emission.model().gate) return outside;
  const GateParts gate = gate_of(instance, emission.model());
  model::NodeIndex inside = outside;
  if (gate.resistance > 0.0) {
    inside = emission.inner_node("gate");
    emission.builder().add(model::Resistor{emission.label("Rg"), outside, inside, gate.resistance});
  }
  const auto add = [&](std::string_view part, std::size_t terminal, double capacitance) {
    if (capacitance <= 0.0 || inside == instance.nodes[terminal]) return -1;
    return emission.builder().add(model::Capacitor{emission.label(part), inside, instance.nodes[terminal], capacitance, false, 0.0});
  };
  add("Cgs", 2, gate.to_source);
  const int drain = add("Cgd", 0, gate.to_drain);
  if (drain >= 0) emission.result().current.push_back({Quantity::capacitor_current, drain, -1.0});
  return inside;
}

std::string words_of_gate(const Instance& instance, const Model& model) {
  const GateParts gate = gate_of(instance, model);
  return fmt::format(", Rg = {:.6g} ohm, Cgs = {:.6g} F, Cgd = {:.6g} F", gate.resistance, gate.to_source, gate.to_drain);
}

/// A channel that closed at once would pull its own gate back over the gate-drain capacitance.
bool follows_gate(const Instance& instance, const Model& model) {
  return instance.drive_is_apart || (model.gate && model.gate->to_drain > 0.0);
}

void note(Emission& emission, const Channel& channel) {
  const Model& model = emission.model();
  const Values& v = model.values;
  const std::string_view origin = v.has("Ron")         ? "its Ron"
                                  : is_vertical(model) ? "Rd + Rs + 1/(Kp (Vdrive - Vto))"
                                                       : "Rd + Rs + 1/(Kp W/L (Vdrive - Vto))";
  const std::string at = v.has("Ron") ? "" : fmt::format(" at Vdrive = {} V", v.get("Vdrive"));
  const char* const what = !follows_gate(emission.instance(), emission.model()) ? "a switch closed"
                           : emission.instance().drive_is_apart
                               ? "a linear channel (its gate is not driven against its source alone) that conducts"
                               : "a linear channel that conducts";
  const std::string gate = model.gate ? words_of_gate(emission.instance(), model) : "";
  note_idealised(emission, fmt::format("{} while v(gate,source) {} {} V, Ron = {:.6g} ohm ({}{}){}, and a body diode, {}", what,
                                       channel.p_type ? "<" : ">", channel.threshold, channel.resistance * emission.value("m"), origin, at,
                                       gate, words_of({v.get("Rfwd"), v.get("Vfwd")})));
}

void emit(Emission& emission) {
  const Instance& instance = emission.instance();
  Channel channel = channel_of(instance, emission.model());
  channel.gate = add_gate(emission);
  follows_gate(instance, emission.model()) ? add_following_channel(emission, channel) : add_channel(emission, channel);
  add_junction(emission, body_diode(instance, emission.model(), "body diode", 0), -1.0);
  add_junction(emission, body_diode(instance, emission.model(), "bulk diode", 2), 0.0);
  note(emission, channel);
}

/// The channel, which its gate drives from behind a resistance.
Channel twin_channel(const Twin& twin) {
  Channel channel = channel_of(twin.instance(), twin.model());
  if (twin.model().gate && twin.model().gate->resistance > 0.0) channel.twin_gate = twin.inner("gate");
  return channel;
}

void twin_of_gate(Twin& twin) {
  const Instance& instance = twin.instance();
  if (!twin.model().gate) return;
  const GateParts gate = gate_of(instance, twin.model());
  const std::string outside = twin.node(instance.nodes[1]), inside = gate.resistance > 0.0 ? twin.inner("gate") : outside;
  if (gate.resistance > 0.0) twin.resistor("Rg", {outside, inside}, gate.resistance);
  if (gate.to_source > 0.0) twin.capacitor("Cgs", {inside, twin.node(instance.nodes[2])}, gate.to_source);
  if (gate.to_drain > 0.0) twin.capacitor("Cgd", {inside, twin.ends().p}, gate.to_drain);
}

void smooth_twin(Twin& twin) {
  const Instance& instance = twin.instance();
  twin_of_gate(twin);
  follows_gate(instance, twin.model()) ? twin_of_following_channel(twin, twin_channel(twin)) : twin_of_channel(twin, twin_channel(twin));
  const std::string bulk = twin.node(bulk_of(instance, twin.model()));
  twin_of_junction(twin, body_diode(instance, twin.model(), "body", 0), {bulk, twin.ends().p});
  twin_of_junction(twin, body_diode(instance, twin.model(), "bulk", 2), {bulk, twin.node(instance.nodes[2])});
}

constexpr int tied[] = {0, 2, 3};

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "MOSFET";
  kind.letter = 'M';
  kind.usage = "M<name> drain gate source [bulk] model [W= L= m=]";
  kind.text = "A MOSFET as a switch at its threshold with a body diode, of bulk (else source) against drain and source.";
  kind.terminals = 3;
  kind.optional_terminals = 1;
  kind.tied_terminals = tied;
  kind.tail = Tail::model;
  kind.parameters = parameters;
  kind.models = models;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  kind.twin_event = [](const Twin& twin) { return std::optional(event_of_channel(twin, twin_channel(twin))); };
  return kind;
}

}  // namespace pwlsim::elements::kinds::mosfet
