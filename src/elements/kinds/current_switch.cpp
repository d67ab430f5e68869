#include <fmt/format.h>

#include "elements/switching.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::current_switch {
namespace {

constexpr Parameter hysteresis_parameters[] = {
    switch_on_resistance,
    switch_off_resistance,
    {"It", "A", 0.0, Range::any, false, "Threshold: on above It+Ih, off below It-Ih."},
    {"Ih", "A", 0.0, Range::any, false, "Half width of the hysteresis; a negative one counts as zero."},
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
    {"Ion", "A", 1e-3, Range::any, false, "On above; with Ioff above Ion: on below."},
    {"Ioff", "A", 0.0, Range::any, false, "Off below; with Ioff above Ion: off above."},
    {"Von", "A", 1e-3, Range::any, false, "Another name of Ion."},
    {"Voff", "A", 0.0, Range::any, false, "Another name of Ioff."},
    switch_inductance,
    switch_drop,
};

void complete(Model& model, const Settings&, Diagnostics& diagnostics) { complete_hysteresis(model, "It", "Ih", diagnostics); }

/// The two spellings of a level become one.
void merge_names(Model& model, std::string_view name, std::string_view other, Diagnostics& diagnostics) {
  if (!model.values.has(other)) return;
  if (model.values.has(name)) {
    diagnostics.error("E-duplicate-parameter", model.values.span(other), fmt::format("{} and {} name the same level", name, other));
  }
  model.values.set(name, model.values.get(other), model.values.span(other));
}

void complete_levels(Model& model, const Settings&, Diagnostics& diagnostics) {
  merge_names(model, "Ion", "Von", diagnostics);
  merge_names(model, "Ioff", "Voff", diagnostics);
}

constexpr ModelKind hysteresis_model{"CSW", "current-controlled switch", hysteresis_parameters, complete};
constexpr ModelKind level_model{"ISWITCH", "current-controlled switch", level_parameters, complete_levels};
constexpr const ModelKind* models[] = {&hysteresis_model, &level_model};

void connect(Emission& emission) { set_control(emission, emission.referenced_result(0).current); }

void smooth_twin(Twin& twin) { twin_of_switch(twin, current_text(twin.meter_of(twin.instance().references[0]))); }

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "current-controlled switch";
  kind.letter = 'W';
  kind.usage = "W<name> n+ n- element model [on|off]";
  kind.text = "Switch driven by i(element).";
  kind.control = ControlSyntax::element;
  kind.tail = Tail::model;
  kind.models = models;
  kind.takes_flag = true;
  kind.emit = add_switch;
  kind.connect = connect;
  kind.smooth_twin = smooth_twin;
  kind.twin_event = event_of_switch;
  return kind;
}

}  // namespace pwlsim::elements::kinds::current_switch
