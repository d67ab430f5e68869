#include <fmt/format.h>

#include "elements/switching.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::voltage_switch {
namespace {

constexpr Parameter hysteresis_parameters[] = {
    switch_on_resistance,
    switch_off_resistance,
    {"Vt", "V", 0.0, Range::any, false, "Threshold: on above Vt+Vh, off below Vt-Vh."},
    {"Vh", "V", 0.0, Range::any, false, "Half width of the hysteresis; a negative one counts as zero."},
    switch_inductance,
    switch_drop,
    switch_limit,
    switch_level,
    switch_one_way,
    switch_corner,
};

constexpr Parameter level_parameters[] = {
    switch_on_resistance,
    switch_off_resistance,
    {"Von", "V", 1.0, Range::any, false, "On above; with Voff above Von: on below."},
    {"Voff", "V", 0.0, Range::any, false, "Off below; with Voff above Von: off above."},
    {"On", "V", 1.0, Range::any, false, "Another name of Von (Xyce)."},
    {"Off", "V", 0.0, Range::any, false, "Another name of Voff (Xyce)."},
    {"Vt", "V", 0.0, Range::any, false, "Threshold, in place of Von and Voff: on above Vt+Vh, off below Vt-Vh."},
    {"Vh", "V", 0.0, Range::any, false, "Half width of the hysteresis, with Vt; a negative one counts as zero."},
    {"TD", "s", 0.0, Range::any, false, "Delay.", Use::refused},
    switch_inductance,
    switch_drop,
};

void complete(Model& model, const Settings&, Diagnostics& diagnostics) { complete_hysteresis(model, "Vt", "Vh", diagnostics); }

constexpr ModelKind hysteresis_model{"SW", "voltage-controlled switch", hysteresis_parameters, complete};
void check_levels(Model& model, const Settings&, Diagnostics& diagnostics) {
  Values& v = model.values;
  if (v.has("On") && !v.has("Von")) v.set("Von", v.get("On"), v.span("On"));
  if (v.has("Off") && !v.has("Voff")) v.set("Voff", v.get("Off"), v.span("Off"));
  const std::string_view level = v.has("Von") ? "Von" : "Voff";
  if (!v.has(level)) return complete_hysteresis(model, "Vt", "Vh", diagnostics);
  if (v.has("Vt"))
    diagnostics.error(
        "E-duplicate-parameter", v.span("Vt"),
        fmt::format("Vt of model {} repeats what {} already defines; try either Von and Voff, or Vt and Vh", model.name, level));
  else if (v.has("Vh"))
    diagnostics.warning("W-ignored-parameter", v.span("Vh"),
                        fmt::format("Vh of model {} is ignored: {} already gives the levels", model.name, level));
}

constexpr ModelKind level_model{"VSWITCH", "voltage-controlled switch", level_parameters, check_levels};
constexpr ModelKind generic_model{"SWITCH", "voltage-controlled switch", level_parameters, check_levels};
constexpr const ModelKind* models[] = {&hysteresis_model, &level_model, &generic_model};

void connect(Emission& emission) {
  const NodePair& control = emission.instance().control_nodes[0];
  set_control(emission, model::voltage_between(control.p, control.n));
}

void smooth_twin(Twin& twin) {
  const NodePair& control = twin.instance().control_nodes[0];
  twin_of_switch(twin, voltage_text({twin.node(control.p), twin.node(control.n)}));
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "voltage-controlled switch";
  kind.letter = 'S';
  kind.usage = "S<name> n+ n- nc+ nc- model [on|off]";
  kind.text = "Switch driven by v(nc+,nc-).";
  kind.control = ControlSyntax::node_pair;
  kind.tail = Tail::model;
  kind.models = models;
  kind.takes_flag = true;
  kind.saved_by_default = true;
  kind.emit = add_switch;
  kind.connect = connect;
  kind.smooth_twin = smooth_twin;
  kind.twin_event = event_of_switch;
  return kind;
}

}  // namespace pwlsim::elements::kinds::voltage_switch
