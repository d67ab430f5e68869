#include <fmt/format.h>

#include "elements/transistor.hpp"
#include "elements/two_terminal.hpp"

/// Ebers and Moll's transport model with its two exponentials replaced by their tangents: the base-emitter and the base-collector diode, and of the
/// current of each the share alpha that reaches the opposite side. It saturates, amplifies by BF between, and blocks.
namespace pwlsim::elements::kinds::bipolar {
namespace {

constexpr Parameter model_parameters[] = {
    {"IS", "A", 1e-16, Range::positive, false, "Transport saturation current; read for the tangents at i0."},
    {"BF", "", 100.0, Range::positive, false, "Forward current gain."},
    {"BR", "", 1.0, Range::positive, false, "Reverse current gain."},
    {"NF", "", 1.0, Range::positive, false, "Forward emission coefficient; read for the tangent at i0."},
    {"NR", "", 1.0, Range::positive, false, "Reverse emission coefficient; read for the tangent at i0."},
    {"RB", "ohm", 0.0, Range::not_negative, false, "Base resistance."},
    {"RE", "ohm", 0.0, Range::not_negative, false, "Emitter resistance."},
    {"RC", "ohm", 0.0, Range::not_negative, false, "Collector resistance."},
    junction_current,
    without_effect("level"),
    without_effect("vaf"),
    without_effect("va"),
    without_effect("var"),
    without_effect("vb"),
    without_effect("ikf"),
    without_effect("ik"),
    without_effect("ikr"),
    without_effect("ise"),
    without_effect("isc"),
    without_effect("c2"),
    without_effect("c4"),
    without_effect("ne"),
    without_effect("nc"),
    without_effect("irb"),
    without_effect("rbm"),
    without_effect("cje"),
    without_effect("vje"),
    without_effect("pe"),
    without_effect("mje"),
    without_effect("me"),
    without_effect("tf"),
    without_effect("xtf"),
    without_effect("vtf"),
    without_effect("itf"),
    without_effect("ptf"),
    without_effect("cjc"),
    without_effect("vjc"),
    without_effect("pc"),
    without_effect("mjc"),
    without_effect("mc"),
    without_effect("xcjc"),
    without_effect("xcjc2"),
    without_effect("tr"),
    without_effect("cjs"),
    without_effect("ccs"),
    without_effect("vjs"),
    without_effect("ps"),
    without_effect("mjs"),
    without_effect("ms"),
    without_effect("xtb"),
    without_effect("eg"),
    without_effect("xti"),
    without_effect("pt"),
    without_effect("kf"),
    without_effect("af"),
    without_effect("fc"),
    without_effect("tnom"),
    without_effect("tref"),
    without_effect("iss"),
    without_effect("ns"),
    without_effect("nk"),
    without_effect("nkf"),
    without_effect("subs"),
    without_effect("rco"),
    without_effect("vo"),
    without_effect("gamma"),
    without_effect("qco"),
    without_effect("trb1"),
    without_effect("trb2"),
    without_effect("tre1"),
    without_effect("tre2"),
    without_effect("trc1"),
    without_effect("trc2"),
    without_effect("trm1"),
    without_effect("trm2"),
    without_effect("bvcbo"),
    without_effect("bvbe"),
    without_effect("Vceo"),
    without_effect("Icrating"),
    maker,
    part_number,
    part_type,
};

/// The law of a junction has a saturation current of its own: this one says that currents are to be found.
void complete(Model& model, const Settings& settings, Diagnostics&) {
  if (settings.finds_currents && !model.values.has("I0")) model.law = exponential_law(model.values.get("IS"), model.values.get("NF"), 0.0);
  take_junction_current(model, settings);
}

constexpr ModelKind npn{"NPN", "NPN transistor", model_parameters, complete, nullptr, true};
constexpr ModelKind pnp{"PNP", "PNP transistor", model_parameters, complete, nullptr, true};
constexpr ModelKind lateral{"LPNP", "lateral PNP transistor", model_parameters, complete, nullptr, true};
constexpr const ModelKind* models[] = {&npn, &pnp, &lateral};

constexpr Parameter parameters[] = {
    multiplicity, without_effect("area"), without_effect("off"), without_effect("ic"), temperature, temperature_difference,
};

bool is_p_type(const Model& model) { return model.kind != &npn; }
double share_of(double gain) { return gain / (1.0 + gain); }

/// A diode carries 1/alpha of the transport current.
Tangent law_of(const Instance& instance, const Model& model, std::string_view emission_name, double share) {
  const Values& v = model.values;
  Tangent law = tangent(v.get("IS"), v.get(emission_name), 0.0, v.get("I0"));
  law.resistance *= share / instance.values.get("m");
  return law;
}

Tangent forward_law(const Instance& instance, const Model& model) {
  return law_of(instance, model, "NF", share_of(model.values.get("BF")));
}
Tangent reverse_law(const Instance& instance, const Model& model) {
  return law_of(instance, model, "NR", share_of(model.values.get("BR")));
}

/// A diode carries 1/alpha of the transport current, whose saturation current is IS.
std::optional<model::ExponentialLaw> exponential_of(const Instance& instance, const Model& model, std::string_view emission_name,
                                                    double share) {
  if (!model.law) return std::nullopt;
  const Values& v = model.values;
  return in_parallel(exponential_law(v.get("IS") / share, v.get(emission_name), 0.0), instance.values.get("m"));
}

/// The node behind a series resistance.
model::NodeIndex behind(Emission& emission, std::string_view name, std::size_t terminal) {
  const model::NodeIndex outside = emission.instance().nodes[terminal];
  const double resistance = emission.model().values.get(name) / emission.value("m");
  if (resistance == 0.0) return outside;
  const model::NodeIndex inside = emission.inner_node(name);
  emission.builder().add(model::Resistor{emission.label(name), outside, inside, resistance});
  return inside;
}

void add_transport(Emission& emission, const NodePair& ends, int diode, double share) {
  if (diode >= 0)
    emission.builder().add(model::Injection{emission.label("transport"), ends.p, ends.n, {{Quantity::diode_current, diode, share}}});
}

void emit(Emission& emission) {
  const Instance& instance = emission.instance();
  const Model& model = emission.model();
  const bool p_type = is_p_type(model);
  const double forward_share = share_of(model.values.get("BF")), reverse_share = share_of(model.values.get("BR"));
  const model::NodeIndex c = behind(emission, "RC", 0), b = behind(emission, "RB", 1), e = behind(emission, "RE", 2);
  const Junction emitter{"base-emitter diode",         p_type,   {b, e},
                         forward_law(instance, model), infinite, exponential_of(instance, model, "NF", forward_share)};
  const Junction collector{"base-collector diode",       p_type,   {b, c},
                           reverse_law(instance, model), infinite, exponential_of(instance, model, "NR", reverse_share)};
  const int forward = add_junction(emission, emitter, forward_share);
  const int reverse = add_junction(emission, collector, -1.0);
  const double sign = p_type ? -1.0 : 1.0;
  add_transport(emission, {c, b}, forward, sign * forward_share);
  add_transport(emission, {e, b}, reverse, sign * reverse_share);
  note_idealised(emission,
                 fmt::format("Ebers and Moll's model with BF = {}, BR = {} and piecewise-linear diodes: base-emitter {}, base-collector {}",
                             model.values.get("BF"), model.values.get("BR"), words_of(forward_law(instance, model)),
                             words_of(reverse_law(instance, model))));
}

std::string behind(Twin& twin, std::string_view name, const std::string& outside) {
  const double resistance = twin.model().values.get(name) / twin.value("m");
  if (resistance == 0.0) return outside;
  std::string inside = twin.inner(name);
  twin.resistor(name, {outside, inside}, resistance);
  return inside;
}

/// The diode behind a meter, and what of its current reaches the other side.
void twin_of_side(Twin& twin, const Junction& junction, const TwinEnds& ends, const std::string& opposite, double share) {
  const std::string middle = twin.inner(junction.part);
  twin.short_circuit(junction.part, {ends.p, middle});
  twin_of_junction(twin, junction, {middle, ends.n});
  twin.behaviour(junction.part, {opposite, ends.p}, true, term_text(share, current_text(twin.device('V', junction.part))));
}

void smooth_twin(Twin& twin) {
  const Instance& instance = twin.instance();
  const Model& model = twin.model();
  const std::string c = behind(twin, "RC", twin.ends().p), b = behind(twin, "RB", twin.node(instance.nodes[1])),
                    e = behind(twin, "RE", twin.node(instance.nodes[2]));
  twin_of_side(twin, {"be", is_p_type(model), {}, forward_law(instance, model)}, {b, e}, c, share_of(model.values.get("BF")));
  twin_of_side(twin, {"bc", is_p_type(model), {}, reverse_law(instance, model)}, {b, c}, e, share_of(model.values.get("BR")));
}

constexpr int tied[] = {0, 1, 2};

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "bipolar transistor";
  kind.letter = 'Q';
  kind.usage = "Q<name> collector base emitter [substrate] model [m=]";
  kind.text = "A bipolar transistor: saturated, amplifying by its current gain, or blocking.";
  kind.terminals = 3;
  kind.optional_terminals = 1;
  kind.tied_terminals = tied;
  kind.tail = Tail::model;
  kind.parameters = parameters;
  kind.models = models;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  return kind;
}

}  // namespace pwlsim::elements::kinds::bipolar
