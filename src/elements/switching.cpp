#include "elements/switching.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elements/conduction.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements {
namespace {

Thresholds inverted(const Thresholds& t) { return {-t.off, -t.on, -t.scale}; }

Thresholds around(double threshold, double hysteresis) { return {threshold + hysteresis, threshold - hysteresis, 1.0}; }

Thresholds between(double on, double off) { return on >= off ? Thresholds{on, off, 1.0} : inverted({off, on, 1.0}); }

/// Ron above Roff is a switch that conducts better when off: the contact is then closed in the off state.
bool closed_when_off(const Model& model) { return model.values.get("Ron") > model.values.get("Roff"); }

/// PSpice's VSWITCH, and Xyce's SWITCH.
bool is_level_switch(std::string_view type) { return type == "VSWITCH" || type == "SWITCH"; }

/// Of these: Vt and Vh in place of Von and Voff.
bool has_threshold(const Model& model) {
  const Values& v = model.values;
  return v.has("Vt") || (v.has("Vh") && !v.has("Von") && !v.has("Voff"));
}

/// Levels that are called on and off count where the control reaches them, at a peak or on a plateau too: so far inside the band the switch changes.
double reach_of(const Model& model, const Thresholds& levels) {
  constexpr double share = 1e-11;  // of the larger level: above what is rounding in either engine
  const std::string_view type = model.kind->type;
  const bool has_levels = type == "ISWITCH" || (is_level_switch(type) && !has_threshold(model));
  return has_levels ? std::min(share * std::max(std::abs(levels.on), std::abs(levels.off)), 0.25 * (levels.on - levels.off)) : 0.0;
}

NodePair add_series_inductance(Emission& emission, NodePair ends) {
  const double inductance = emission.model().values.get("Lser");
  if (inductance == 0.0) return ends;
  const model::NodeIndex inner = emission.inner_node("Lser");
  emission.builder().add(model::Inductor{emission.label("Lser"), inner, ends.n, inductance, false, 0.0});
  return {ends.p, inner};
}

NodePair add_series_voltage(Emission& emission, NodePair ends, double voltage) {
  if (voltage == 0.0) return ends;
  const model::NodeIndex inner = emission.inner_node("Vser");
  emission.builder().add(model::Branch{emission.label("Vser"), inner, ends.n, {model::constant(voltage)}});
  return {ends.p, inner};
}

}  // namespace

void complete_hysteresis(Model& model, std::string_view threshold, std::string_view hysteresis, Diagnostics& diagnostics) {
  if (model.values.get(hysteresis) >= 0.0) return;
  diagnostics.note("N-negative-hysteresis", model.values.span(hysteresis),
                   fmt::format("{} of {} is negative, a smooth transition: it switches at {} = {}", hysteresis, model.name, threshold,
                               model.values.get(threshold)));
  model.values.set(hysteresis, 0.0, model.values.span(hysteresis));
}

Thresholds thresholds(const Model& model) {
  const Values& v = model.values;
  const std::string_view type = model.kind->type;
  if (type == "SW") return around(v.get("Vt"), v.get("Vh"));
  if (type == "CSW") return around(v.get("It"), v.get("Ih"));
  if (is_level_switch(type) && has_threshold(model)) return around(v.get("Vt"), v.get("Vh"));
  if (is_level_switch(type)) return between(v.get("Von"), v.get("Voff"));
  return between(v.get("Ion"), v.get("Ioff"));
}

void add_switch(Emission& emission) {
  const Values& v = emission.model().values;
  const double on = std::min(v.get("Ron"), v.get("Roff"));
  const double off = std::max(v.get("Ron"), v.get("Roff"));
  const double drop = v.get("Vser");
  NodePair ends = add_series_inductance(emission, {emission.p(), emission.n()});
  if (!std::isinf(off)) ends = add_series_voltage(emission, ends, drop);
  const double resistance = contact_resistance(on, off);
  if (!std::isinf(resistance)) {
    model::Switch item;
    item.label = emission.label();
    item.p = ends.p;
    item.n = ends.n;
    item.resistance = resistance;
    item.drop = std::isinf(off) ? drop : 0.0;
    item.initially_on = emission.instance().flag.value_or(false);
    item.inverted = closed_when_off(emission.model());
    emission.result().item = emission.builder().add(std::move(item));
    emission.result().current = quantity(Quantity::switch_current, emission.result().item);
  }
  add_leakage(emission, off, ends);
}

void set_control(Emission& emission, const model::LinearForm& control) {
  if (emission.result().item < 0) return;
  const Thresholds levels = thresholds(emission.model());
  model::Switch& item = emission.builder().network().switches[static_cast<std::size_t>(emission.result().item)];
  model::accumulate(item.control, control, levels.scale);
  const double reach = reach_of(emission.model(), levels);
  item.on_level = levels.on - reach;
  item.off_level = levels.off + reach;
  item.written = model::WrittenControl{levels.scale, reach, emission.instance().control_nodes.empty() ? "A" : "V"};
}

/// ngspice follows the control of a switch to 0.05 V only: where no source holds it, it is amplified.
double twin_control_gain(const Twin& twin) {
  const Instance& instance = twin.instance();
  const bool held = !instance.control_nodes.empty() && twin.is_held(instance.control_nodes[0]);
  return held ? 1.0 : 1.0 / twin.sharpness();
}

std::optional<TwinEvent> event_of_switch(const Twin& twin) {
  Thresholds levels = thresholds(twin.model());
  if (closed_when_off(twin.model())) levels = inverted(levels);
  const double gain = twin_control_gain(twin);
  return TwinEvent{{twin.inner("control"), "0"}, gain * levels.on, gain * levels.off};
}

void twin_of_switch(Twin& twin, const std::string& control) {
  const Values& v = twin.model().values;
  Thresholds levels = thresholds(twin.model());
  const bool swapped = closed_when_off(twin.model());
  if (swapped) levels = inverted(levels);
  TwinEnds ends = twin.ends();
  if (const double l = v.get("Lser"); l != 0.0) {
    const std::string inner = twin.inner("Lser");
    twin.inductor("Lser", {inner, ends.n}, l);
    ends.n = inner;
  }
  if (const double drop = v.get("Vser"); drop != 0.0) {
    const std::string inner = twin.inner("Vser");
    twin.source("Vser", {inner, ends.n}, false, model::Dc{drop});
    ends.n = inner;
  }
  const double gain = twin_control_gain(twin);
  const std::string node = twin.inner("control");
  twin.behaviour("control", {node, "0"}, false, fmt::format("{}*({})", gain * levels.scale, control));
  twin.contact({}, ends, {node, "0"},
               {std::min(v.get("Ron"), v.get("Roff")), std::max(v.get("Ron"), v.get("Roff")), gain * levels.on, gain * levels.off,
                twin.instance().flag.value_or(false) != swapped});
}

}  // namespace pwlsim::elements
