#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/names.hpp"
#include "elements/conduction.hpp"
#include "elements/tangent.hpp"
#include "elements/twin.hpp"
#include "elements/two_terminal.hpp"

namespace pwlsim::elements::kinds::diode {
namespace {

constexpr Parameter ignored(std::string_view name, std::string_view text) { return {name, "", 0.0, Range::any, true, text, Use::ignored}; }

constexpr Parameter model_parameters[] = {
    {"Ron", "ohm", 0.0, Range::not_negative, false, "Slope resistance beyond Vfwd."},
    {"Roff", "ohm", infinite, Range::positive, true, "Slope resistance between -Vrev and Vfwd."},
    {"Vfwd", "V", 0.0, Range::any, true, "Forward drop; inf: never conducts forward."},
    {"Vrev", "V", infinite, Range::not_negative, true, "Reverse breakdown voltage."},
    {"Rrev", "ohm", 0.0, Range::not_negative, false, "Slope resistance beyond -Vrev."},
    {"IS", "A", 1e-14, Range::not_negative, false, "Saturation current; read for the tangent at i0."},
    {"N", "", 1.0, Range::positive, false, "Emission coefficient; read for the tangent at i0."},
    {"RS", "ohm", 0.0, Range::not_negative, false, "Series resistance; read for the tangent at i0, and becomes Rrev."},
    {"BV", "V", infinite, Range::not_negative, true, "Breakdown voltage; becomes Vrev."},
    {"Ilimit", "A", infinite, Range::positive, true, "Limit of the forward current; the current through Roff is added."},
    {"Revilimit", "A", infinite, Range::positive, true, "Limit of the reverse current."},
    ignored("Epsilon", "Width of the rounded corner at Vfwd."),
    ignored("Revepsilon", "Width of the rounded corner at -Vrev."),
    {"IBV", "A", 1e-3, Range::not_negative, false,
     "Current at the breakdown voltage, 0.1 nA in decks of LTspice; read for the reverse tangent."},
    ignored("IBVL", "Low-level breakdown current."),
    {"NBV", "", 1.0, Range::positive, false, "Emission coefficient of the breakdown, N if not given; read for the reverse tangent."},
    ignored("NBVL", "Low-level breakdown emission coefficient."),
    ignored("CJO", "Junction capacitance."),
    ignored("CJ0", "Junction capacitance."),
    ignored("CJ", "Junction capacitance."),
    ignored("CJP", "Sidewall capacitance."),
    ignored("CJSW", "Sidewall capacitance."),
    ignored("VJ", "Junction potential."),
    ignored("M", "Grading coefficient."),
    ignored("MJSW", "Sidewall grading coefficient."),
    ignored("FC", "Forward-bias depletion coefficient."),
    ignored("TT", "Transit time."),
    ignored("Vp", "Soft reverse recovery parameter."),
    ignored("EG", "Energy gap."),
    ignored("XTI", "Saturation-current temperature exponent."),
    ignored("KF", "Flicker noise coefficient."),
    ignored("AF", "Flicker noise exponent."),
    ignored("IK", "High-injection knee current."),
    ignored("IKF", "High-injection knee current."),
    ignored("IKR", "Reverse high-injection knee current."),
    ignored("ISR", "Recombination current."),
    ignored("NR", "Recombination emission coefficient."),
    ignored("JSW", "Sidewall saturation current."),
    ignored("NS", "Sidewall emission coefficient."),
    ignored("TNOM", "Temperature of the parameters."),
    ignored("Tref", "Temperature of the parameters."),
    ignored("T_measured", "Temperature of the parameters."),
    ignored("TBV1", "Temperature coefficient."),
    ignored("TBV2", "Temperature coefficient."),
    ignored("TRS1", "Temperature coefficient."),
    ignored("TRS2", "Temperature coefficient."),
    ignored("TM1", "Temperature coefficient."),
    ignored("TM2", "Temperature coefficient."),
    ignored("TTT1", "Temperature coefficient."),
    ignored("TTT2", "Temperature coefficient."),
    ignored("TIKF", "Temperature coefficient."),
    ignored("level", "Variant of the exponential model."),
    ignored("perim", "Perimeter."),
    ignored("area", "Area."),
    ignored("Vpk", "Rated peak voltage."),
    {"Iave", "A", infinite, Range::positive, true,
     "Rated average current: a part of the models at hand that carries far more gives a warning."},
    ignored("Ipk", "Rated peak current."),
    ignored("Irms", "Rated current."),
    ignored("diss", "Rated dissipation."),
    maker,
    part_number,
    part_type,
};

constexpr std::string_view ideal_names[] = {"Ron", "Roff", "Vfwd", "Vrev", "Rrev"};
constexpr std::string_view exponential_names[] = {"IS", "N", "RS", "BV"};

/// v = RS·i + N·Vt·ln(i/IS) by its tangent at i0.
void replace_by_tangent(Model& model, const Settings& settings, Diagnostics& diagnostics) {
  Values& values = model.values;
  const double i0 = settings.tangent_current;
  const model::ExponentialLaw exponential = exponential_law(values.get("IS"), values.get("N"), values.get("RS"));
  const model::Tangent law = exponential.tangent(i0);
  if (settings.finds_currents) model.law = exponential;
  const double reverse = values.get("BV");
  diagnostics.note("N-diode-tangent", model.span,
                   fmt::format("the exponential diode {} is replaced by its tangent at {} A{}: Ron = {:.6g} ohm, Vfwd = {:.6g} V{}",
                               model.name, i0, settings.finds_currents ? ", unless a first run finds another current" : "", law.resistance,
                               law.drop, std::isinf(reverse) ? "" : fmt::format(", Vrev = {:.6g} V", reverse)));
  values.set("Ron", law.resistance);
  values.set("Vfwd", law.drop);
  values.set("Vrev", reverse);
  if (!std::isinf(reverse)) values.set("Rrev", values.get("RS"));
  if (!values.has("NBV") && !settings.written_by_ltspice) values.set("NBV", values.get("N"));
  constexpr double breakdown_in_ltspice = 1e-10;  // A, its default of IBV
  if (!values.has("IBV") && settings.written_by_ltspice) values.set("IBV", breakdown_in_ltspice);
}

/// Beyond BV: v = BV + NBV·Vt·ln(i/IBV) + RS·i, as the law of a diode whose saturation current is what this one has at v = 0 (Nagel, SPICE2, 1975). None
/// where that current is no number, with BV above some 17 V: there the knee is a small part of it.
std::optional<model::ExponentialLaw> breakdown_law(const Model& model) {
  const Values& v = model.values;
  if (!model.law || std::isinf(v.get("BV")) || v.get("IBV") == 0.0) return std::nullopt;
  model::ExponentialLaw law = exponential_law(1.0, v.get("NBV"), v.get("RS"));
  law.saturation = v.get("IBV") * std::exp(-v.get("BV") / law.slope);
  constexpr double least = 1e-295;  // A
  return law.saturation > least ? std::optional(law) : std::nullopt;
}

/// The line `.model D D` that LTspice adds to its decks: SPICE's default diode.
bool is_default_diode(const Model& model, const Settings& settings) {
  return settings.written_by_ltspice && same_name(model.name, "D") && model.values.all().empty();
}

void check_slopes(const Model& model, Diagnostics& diagnostics) {
  const Values& v = model.values;
  const double off = v.get("Roff");
  if (v.get("Ron") > off) diagnostics.error("E-range", v.span("Ron"), "Ron of a diode must not exceed Roff");
  if (!std::isinf(v.get("Vrev")) && v.get("Rrev") > off)
    diagnostics.error("E-range", v.span("Rrev"), "Rrev of a diode must not exceed Roff");
  if (v.get("Vfwd") == -infinite || v.get("Vfwd") + v.get("Vrev") < 0.0) {
    diagnostics.error("E-range", model.span,
                      fmt::format("the forward and the reverse branch of {} overlap: Vfwd + Vrev is negative", model.name));
  } else if (v.get("Vfwd") < 0.0) {
    diagnostics.warning("W-negative-drop", model.span,
                        fmt::format("Vfwd of {} is {:.6g} V: with a negative drop the diode delivers power", model.name, v.get("Vfwd")));
  }
}

void complete(Model& model, const Settings& settings, Diagnostics& diagnostics) {
  const std::string ideal = written(model, ideal_names);
  const std::string exponential = written(model, exponential_names);
  if (!ideal.empty() && !exponential.empty()) {
    diagnostics.warning("W-ignored-parameter", model.span,
                        fmt::format("{} of model {} ignored: {} already gives the ideal characteristic", exponential, model.name, ideal));
  } else if (!exponential.empty() || is_default_diode(model, settings)) {
    replace_by_tangent(model, settings, diagnostics);
  }
  check_slopes(model, diagnostics);
}

constexpr ModelKind diode_model{"D", "diode", model_parameters, complete};

constexpr Parameter thyristor_parameters[] = {
    {"Ron", "ohm", 0.0, Range::not_negative, false, "Resistance when on."},
    {"Roff", "ohm", infinite, Range::positive, true, "Resistance when off."},
    {"Vfwd", "V", 0.0, Range::not_negative, false, "Forward drop."},
    {"Vgt", "V", 0.5, Range::any, false, "Gate voltage, against the cathode, above which it conducts like a diode."},
    {"Ih", "A", 0.0, Range::not_negative, false, "Holding current: above it, conduction continues without a gate signal."},
};

void complete_thyristor(Model& model, const Settings&, Diagnostics& diagnostics) {
  const Values& v = model.values;
  if (v.get("Ron") > v.get("Roff")) diagnostics.error("E-range", v.span("Ron"), "Ron of a thyristor must not exceed Roff");
}

constexpr ModelKind thyristor_model{"SCR", "thyristor", thyristor_parameters, complete_thyristor};
constexpr const ModelKind* models[] = {&diode_model, &thyristor_model};

bool is_thyristor(const Model& model) { return model.kind == &thyristor_model; }

constexpr Parameter parameters[] = {
    multiplicity,
    {"area", "", 1.0, Range::any, false, "Area factor.", Use::ignored},
    {"off", "", 0.0, Range::any, false, "Start hint of other simulators.", Use::ignored},
    {"ic", "V", 0.0, Range::any, false, "Start hint of other simulators.", Use::ignored},
    temperature,
    temperature_difference,
};

/// Conducts with that slope beyond the drop, up to the limit.
struct Branch {
  std::string_view name;
  double resistance = 0.0, drop = 0.0, limit = infinite;
  [[nodiscard]] bool conducts() const { return !std::isinf(resistance) && !std::isinf(drop); }
};

/// From anode to cathode, and back.
std::array<Branch, 2> branches(const Values& v, double m) {
  const double off = v.get("Roff");
  return {Branch{"", contact_resistance(v.get("Ron"), off) / m, v.get("Vfwd"), m * v.get("Ilimit")},
          Branch{"reverse", contact_resistance(v.get("Rrev"), off) / m, v.get("Vrev"), m * v.get("Revilimit")}};
}

/// A limit is a current source with an ideal diode across it, which takes what the source has too much.
void add_branch(Emission& emission, const Branch& branch, const NodePair& ends, double sign) {
  if (!branch.conducts()) return;
  NodePair contact = ends;
  if (!std::isinf(branch.limit)) {
    contact.n = emission.inner_node(fmt::format("{}limit", branch.name));
    const model::Label label = emission.label(fmt::format("{}limit", branch.name));
    emission.builder().add(model::Injection{label, contact.n, ends.n, {{Quantity::one, 0, branch.limit}}});
    emission.builder().add(model::Diode{label, ends.n, contact.n, 0.0, 0.0});
  }
  const int index = emission.builder().add(model::Diode{emission.label(branch.name), contact.p, contact.n, branch.resistance, branch.drop});
  emission.result().current.push_back({Quantity::diode_current, index, sign});
}

/// The position of a switch that connects nothing, for the thyristor: closed while its control is above the level.
int add_condition(Emission& emission, std::string_view part, const model::LinearForm& control, double level) {
  model::Switch condition;
  condition.label = emission.label(part);
  condition.resistance = 1.0;  // across itself it carries nothing, open or closed
  condition.control = control;
  condition.on_level = condition.off_level = level;
  return emission.builder().add(std::move(condition));
}

/// A diode while its gate is on or its current, which the latch follows, above Ih; else it blocks.
void emit_thyristor(Emission& emission) {
  const Values& v = emission.model().values;
  model::NetworkBuilder& builder = emission.builder();
  const NodePair ends{emission.p(), emission.n()};
  const double m = emission.value("m");
  model::Diode valve{emission.label(), ends.p, ends.n, contact_resistance(v.get("Ron"), v.get("Roff")) / m, v.get("Vfwd")};
  const auto index = static_cast<int>(builder.network().diodes.size());
  const model::LinearForm current = quantity(Quantity::diode_current, index);
  valve.enabled_by = {add_condition(emission, "gate", model::voltage_between(emission.instance().nodes[2], ends.n), v.get("Vgt")),
                      add_condition(emission, "latch", current, m * v.get("Ih"))};
  builder.add(std::move(valve));
  emission.result().current = current;
  add_leakage(emission, v.get("Roff") / m, ends);
}

void report_gate(Emission& emission, bool has_gate) {
  const std::string &name = emission.instance().name, &model = emission.model().name;
  if (has_gate) {
    emission.diagnostics().error("E-wrong-model-type", emission.instance().span,
                                 fmt::format("{} has a gate, but its model {} is that of a diode; try a model of type SCR", name, model));
  } else {
    emission.diagnostics().error(
        "E-missing-node", emission.instance().span,
        fmt::format("{} needs a gate, as its model {} is that of a thyristor; usage: D<name> anode cathode gate model", name, model));
  }
}

/// The diodes from `first` on are one branch.
void follow_law(Emission& emission, std::size_t first, const std::optional<model::ExponentialLaw>& law) {
  auto& diodes = emission.builder().network().diodes;
  if (!law || diodes.size() != first + 1) return;
  diodes[first].law = law;
  diodes[first].law->parallel = emission.value("m");
}

void emit(Emission& emission) {
  const bool has_gate = emission.instance().nodes.size() > 2;
  if (has_gate != is_thyristor(emission.model())) return report_gate(emission, has_gate);
  if (has_gate) return emit_thyristor(emission);
  const Values& v = emission.model().values;
  const double m = emission.value("m");
  const NodePair ends{emission.p(), emission.n()};
  const auto [forward, reverse] = branches(v, m);
  const std::size_t first = emission.builder().network().diodes.size();
  add_branch(emission, forward, ends, 1.0);
  follow_law(emission, first, emission.model().law);
  const std::size_t second = emission.builder().network().diodes.size();
  add_branch(emission, reverse, {ends.n, ends.p}, -1.0);
  follow_law(emission, second, breakdown_law(emission.model()));
  add_leakage(emission, v.get("Roff") / m, ends);
}

void write_branch(Twin& twin, const Branch& branch, const TwinEnds& ends) {
  if (!branch.conducts()) return;
  const TwinDiode contact{branch.resistance, infinite, branch.drop};
  if (std::isinf(branch.limit)) return twin.diode(branch.name, ends, contact);
  const std::string part = fmt::format("{}limit", branch.name);
  const std::string inner = twin.inner(part);
  twin.diode(branch.name, {ends.p, inner}, contact);
  twin.behaviour(part, {inner, ends.n}, true, fmt::format("{}", branch.limit));
  twin.diode(part, {ends.n, inner}, {});
}

/// Two contacts in parallel, of the gate and of the latch, lead to the diode.
void twin_of_thyristor(Twin& twin) {
  const Values& v = twin.model().values;
  const double m = twin.value("m");
  const TwinEnds ends = twin.ends();
  const std::string inner = twin.inner("anode"), on = twin.inner("on");
  const TwinEnds control{twin.node(twin.instance().nodes[2]), ends.n};
  const double on_resistance = std::max(v.get("Ron") / m, twin.sharpness());
  twin.contact("gate", {ends.p, inner}, control, {0.0, infinite, v.get("Vgt"), v.get("Vgt"), false});
  twin.contact("latch", {ends.p, inner}, {on, "0"}, {0.0, infinite, 0.0, 0.0, false});
  // The current where it conducts, less the holding current.
  twin.behaviour("on", {on, "0"}, false,
                 fmt::format("({}-{})/{}-{}", voltage_text({inner, ends.n}), v.get("Vfwd"), on_resistance, m * v.get("Ih")));
  twin.diode({}, {inner, ends.n}, {on_resistance, infinite, v.get("Vfwd")});
  if (!std::isinf(v.get("Roff"))) twin.resistor("Roff", ends, v.get("Roff") / m);
}

void smooth_twin(Twin& twin) {
  if (is_thyristor(twin.model())) return twin_of_thyristor(twin);
  const Values& v = twin.model().values;
  const double m = twin.value("m");
  if (!std::isinf(v.get("Ilimit")) || !std::isinf(v.get("Revilimit"))) {
    const double off = v.get("Roff");
    const TwinEnds ends = twin.ends();
    const auto [forward, reverse] = branches(v, m);
    write_branch(twin, forward, ends);
    write_branch(twin, reverse, {ends.n, ends.p});
    if (!std::isinf(off)) twin.resistor("Roff", ends, off / m);
    return;
  }
  twin.diode({}, twin.ends(), {v.get("Ron") / m, v.get("Roff") / m, v.get("Vfwd"), v.get("Rrev") / m, v.get("Vrev")});
}

std::optional<TwinEvent> twin_event(const Twin& twin) {
  if (is_thyristor(twin.model())) return std::nullopt;
  const double drop = twin.model().values.get("Vfwd");
  return std::isinf(drop) ? std::nullopt : std::optional(TwinEvent{twin.ends(), drop, drop});
}

constexpr int tied[] = {0, 1};

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "diode";
  kind.letter = 'D';
  kind.usage = "D<name> anode cathode [gate] model [m=]";
  kind.text = "Ideal diode, the piecewise-linear one of its model, or with a gate a thyristor.";
  kind.optional_terminals = 1;
  kind.tied_terminals = tied;
  kind.tail = Tail::model;
  kind.parameters = parameters;
  kind.models = models;
  kind.saved_by_default = true;
  kind.emit = emit;
  kind.smooth_twin = smooth_twin;
  kind.twin_event = twin_event;
  return kind;
}

}  // namespace pwlsim::elements::kinds::diode
