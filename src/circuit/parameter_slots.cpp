#include "circuit/parameter_slots.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/names.hpp"
#include "elements/block.hpp"
#include "elements/conduction.hpp"
#include "elements/emission.hpp"

namespace pwlsim::circuit {
namespace {

using elements::Values;

/// on·off/(off − on), in parallel with the leak `off`, is `on`.
double to_on(double on, double off) { return std::isinf(off) ? 1.0 : off / (off - on) * (off / (off - on)); }
double to_off(double on, double off) { return std::isinf(off) ? 0.0 : -on / (off - on) * (on / (off - on)); }

std::optional<model::SourceFunction> pulse_value(const model::Pulse& f, std::string_view name, double p) {
  model::Pulse d{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  if (same_name(name, "V1"))
    d.initial = p;
  else if (same_name(name, "V2"))
    d.pulsed = p;
  else if (same_name(name, "Td"))
    d.delay = p;
  else if (same_name(name, "Tr") && f.rise > 0.0)
    d.rise = p;
  else if (same_name(name, "Tf") && f.fall > 0.0)
    d.fall = p;
  else if (same_name(name, "Ton") && !std::isinf(f.width))
    d.width = p;
  else if (same_name(name, "Tper") && !std::isinf(f.period))
    d.period = p;
  else
    return std::nullopt;
  return d;
}

std::optional<model::SourceFunction> sine_value(std::string_view name, double p) {
  model::Sin d{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  if (same_name(name, "Voff"))
    d.offset = p;
  else if (same_name(name, "Vamp"))
    d.amplitude = p;
  else if (same_name(name, "Freq"))
    d.frequency = p;
  else if (same_name(name, "Td"))
    d.delay = p;
  else if (same_name(name, "Theta"))
    d.damping = p;
  else if (same_name(name, "Phi"))
    d.phase = p * (std::acos(-1.0) / 180.0);
  else
    return std::nullopt;
  return d;
}

}  // namespace

bool Slots::element_value(std::string_view name, double p, NetworkMoves& moves) const {
  if (same_name(name, "m")) return multiplicity(p, moves);
  switch (instance_.kind->letter) {
    case 'R':
      return same_name(name, "R") ? resistor("", "R", p, moves) : series_or_parallel(name, p, moves);
    case 'L':
      if (same_name(name, "ic")) return initial(Moved::initial_current, parts_.find(network_.inductors, ""), p, moves);
      return same_name(name, "L") ? inductor("", "L", p, moves) : series_or_parallel(name, p, moves);
    case 'C':
      if (same_name(name, "ic")) return initial(Moved::initial_voltage, parts_.find(network_.capacitors, ""), p, moves);
      return same_name(name, "C") ? capacitor("", "C", p, moves) : series_or_parallel(name, p, moves);
    case 'K':
      parts_.each(network_.couplings, [&](int k) { moves.push_back({.item = Moved::coupling, .index = k, .derivative = p}); });
      return same_name(name, "k");
    case 'V':
      return same_name(name, "Rser") ? branch_resistance(p, moves) : same_name(name, "Cpar") && capacitor("Cpar", "Cpar", p, moves);
    default:
      return false;
  }
}

bool Slots::model_value(std::string_view name, double p, NetworkMoves& moves) const {
  if (model_ == nullptr || model_->kind == nullptr) return false;
  const std::string_view type = model_->kind->type;
  if (type == "D") return diode_value(name, p, moves);
  if (type == "SW" || type == "CSW" || type == "VSWITCH" || type == "ISWITCH") return switch_value(name, p, moves);
  if (type == "NMOS" || type == "PMOS" || type == "VDMOS") return mosfet_value(name, p, moves);
  return false;
}

bool Slots::follows_block(std::string_view name) const {
  if (model_ == nullptr || model_->kind == nullptr || model_->kind->block == nullptr) return false;
  const elements::Values::Given* given = model_->values.find(name);
  return model_->kind->block->law != nullptr && given != nullptr && !given->parameter->is_list;
}

std::string Slots::tangent_note() const {
  std::string note;
  parts_.each(network_.diodes, [&](int k) {
    if (is_tangent(k)) note = ": its tangent follows an exponential model";
  });
  return note;
}

bool Slots::waveform_value(std::string_view name, double p, NetworkMoves& moves) const {
  if (!instance_.waveform) return false;
  std::optional<model::SourceFunction> d;
  if (const auto* pulse = std::get_if<model::Pulse>(&*instance_.waveform)) d = pulse_value(*pulse, name, p);
  if (std::holds_alternative<model::Sin>(*instance_.waveform)) d = sine_value(name, p);
  return d && add_source(*d, moves);
}

bool Slots::constant_value(double p, NetworkMoves& moves) const {
  return instance_.waveform && std::holds_alternative<model::Dc>(*instance_.waveform) && add_source(model::Dc{p}, moves);
}

bool Slots::gain(double p, NetworkMoves& moves) const {
  const auto& c = instance_.coefficients;
  if (c.size() != 2 || c[0] != 0.0 || c[1] == 0.0 || instance_.formula) return false;
  const char letter = instance_.kind->letter;
  const auto add = [&](Moved item, const auto& list, auto form) {
    const int k = parts_.find(list, "");
    if (k < 0) return false;
    model::LinearForm moved = list[static_cast<std::size_t>(k)].*form;
    for (model::Term& term : moved) term.coefficient *= p / c[1];
    // A current that is no unknown stands in the signals that save it, too.
    const std::string current = fmt::format("i({})", instance_.name);
    for (std::size_t s = 0; item == Moved::injection_form && s < network_.signals.size(); ++s)
      if (same_name(network_.signals[s].name, current))
        moves.push_back({.item = Moved::signal_form, .index = static_cast<int>(s), .form = moved});
    moves.push_back({.item = item, .index = k, .form = std::move(moved)});
    return true;
  };
  if (letter == 'E' || letter == 'H') return add(Moved::branch_form, network_.branches, &model::Branch::voltage);
  return (letter == 'G' || letter == 'F') && add(Moved::injection_form, network_.injections, &model::Injection::current);
}

bool Slots::resistor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const {
  if (value(name) != 0.0)
    return proportional(Moved::resistance, network_.resistors, &model::Resistor::resistance, part, value(name), p, moves);
  const int k = parts_.find(network_.resistors, part);
  if (k >= 0) moves.push_back({.item = Moved::resistance, .index = k, .derivative = p / value("m")});
  return k >= 0;
}

bool Slots::inductor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const {
  return proportional(Moved::inductance, network_.inductors, &model::Inductor::inductance, part, value(name), p, moves);
}

bool Slots::capacitor(std::string_view part, std::string_view name, double p, NetworkMoves& moves) const {
  return proportional(Moved::capacitance, network_.capacitors, &model::Capacitor::capacitance, part, value(name), p, moves);
}

bool Slots::series_or_parallel(std::string_view name, double p, NetworkMoves& moves) const {
  for (const std::string_view r : {"Rser", "Rpar"})
    if (same_name(name, r)) return resistor(r, r, p, moves);
  if (same_name(name, "Lser")) return inductor("Lser", "Lser", p, moves);
  return same_name(name, "Cpar") && capacitor("Cpar", "Cpar", p, moves);
}

bool Slots::multiplicity(double p, NetworkMoves& moves) const {
  const char letter = instance_.kind->letter;
  if (letter != 'R' && letter != 'L' && letter != 'C' && letter != 'D') return false;
  const double share = p / value("m");
  parts_.each(network_.resistors, [&](int k) {
    moves.push_back(
        {.item = Moved::resistance, .index = k, .derivative = -share * network_.resistors[static_cast<std::size_t>(k)].resistance});
  });
  parts_.each(network_.inductors, [&](int k) {
    moves.push_back(
        {.item = Moved::inductance, .index = k, .derivative = -share * network_.inductors[static_cast<std::size_t>(k)].inductance});
  });
  parts_.each(network_.capacitors, [&](int k) {
    moves.push_back(
        {.item = Moved::capacitance, .index = k, .derivative = share * network_.capacitors[static_cast<std::size_t>(k)].capacitance});
  });
  parts_.each(network_.diodes, [&](int k) {
    moves.push_back(
        {.item = Moved::diode_resistance, .index = k, .derivative = -share * network_.diodes[static_cast<std::size_t>(k)].resistance});
  });
  bool is_whole = true;
  parts_.each(network_.injections, [&](int) { is_whole = false; });
  parts_.each(network_.diodes, [&](int k) { is_whole &= !is_tangent(k); });
  return is_whole;
}

bool Slots::initial(Moved item, int index, double p, NetworkMoves& moves) {
  if (index >= 0) moves.push_back({.item = item, .index = index, .derivative = p});
  return index >= 0;
}

bool Slots::branch_resistance(double p, NetworkMoves& moves) const {
  const int k = parts_.find(network_.branches, "");
  if (k < 0) return false;
  const model::LinearForm& form = network_.branches[static_cast<std::size_t>(k)].voltage;
  const auto is_own = [&](const model::Term& term) { return term.kind == model::Term::Kind::branch_current && term.index == k; };
  if (std::none_of(form.begin(), form.end(), is_own)) return false;
  moves.push_back({.item = Moved::branch_form, .index = k, .form = {{model::Term::Kind::branch_current, k, p}}});
  return true;
}

bool Slots::contact(Moved item, int index, double p, NetworkMoves& moves) const {
  if ((item == Moved::diode_resistance || item == Moved::diode_drop) && index >= 0 && is_tangent(index)) return false;
  if (index >= 0 && p != 0.0) moves.push_back({.item = item, .index = index, .derivative = p});
  return index >= 0;
}

bool Slots::leak(double p, NetworkMoves& moves) const {
  const int k = parts_.find(network_.resistors, "Roff");
  if (k >= 0) moves.push_back({.item = Moved::resistance, .index = k, .derivative = p});
  return k >= 0;
}

bool Slots::diode_value(std::string_view name, double p, NetworkMoves& moves) const {
  const Values& v = model_->values;
  const double m = value("m"), off = v.get("Roff");
  const int forward = parts_.find(network_.diodes, ""), reverse = parts_.find(network_.diodes, "reverse");
  if (instance_.nodes.size() > 2 || !std::isinf(v.get("Ilimit")) || !std::isinf(v.get("Revilimit"))) return false;
  if (same_name(name, "Ron")) return contact(Moved::diode_resistance, forward, p * to_on(v.get("Ron"), off) / m, moves);
  if (same_name(name, "Rrev")) return reverse < 0 || contact(Moved::diode_resistance, reverse, p * to_on(v.get("Rrev"), off) / m, moves);
  if (same_name(name, "Vfwd")) return contact(Moved::diode_drop, forward, p, moves);
  if (same_name(name, "Vrev")) return contact(Moved::diode_drop, reverse, p, moves);
  if (!same_name(name, "Roff") || !leak(p / m, moves)) return false;
  (void)contact(Moved::diode_resistance, forward, p * to_off(v.get("Ron"), off) / m, moves);
  (void)contact(Moved::diode_resistance, reverse, p * to_off(v.get("Rrev"), off) / m, moves);
  return true;
}

bool Slots::levels(double on, double off, NetworkMoves& moves) const {
  const int k = parts_.find(network_.switches, "");
  if (k < 0) return false;
  if (on != 0.0) moves.push_back({.item = Moved::on_level, .index = k, .derivative = on});
  if (off != 0.0) moves.push_back({.item = Moved::off_level, .index = k, .derivative = off});
  return true;
}

bool Slots::switch_value(std::string_view name, double p, NetworkMoves& moves) const {
  const Values& v = model_->values;
  const std::string_view type = model_->kind->type;
  const int contact_index = parts_.find(network_.switches, "");
  if (same_name(name, "Vser")) return drop(contact_index, p, moves);
  if (same_name(name, "Lser")) {
    const int k = parts_.find(network_.inductors, "Lser");
    if (k >= 0) moves.push_back({.item = Moved::inductance, .index = k, .derivative = p});
    return k >= 0;
  }
  const bool is_swapped = v.get("Ron") > v.get("Roff");
  const double low = std::min(v.get("Ron"), v.get("Roff")), high = std::max(v.get("Ron"), v.get("Roff"));
  if (same_name(name, is_swapped ? "Roff" : "Ron")) return contact(Moved::switch_resistance, contact_index, p * to_on(low, high), moves);
  if (same_name(name, is_swapped ? "Ron" : "Roff"))
    return leak(p, moves) && (contact(Moved::switch_resistance, contact_index, p * to_off(low, high), moves) || true);
  const bool is_around =
      type == "SW" || type == "CSW" || (type == "VSWITCH" && (v.has("Vt") || (v.has("Vh") && !v.has("Von") && !v.has("Voff"))));
  if (is_around && (same_name(name, "Vt") || same_name(name, "It"))) return levels(p, p, moves);
  if (is_around && (same_name(name, "Vh") || same_name(name, "Ih"))) return levels(p, -p, moves);
  if (is_around) return false;
  const bool is_voltage = type == "VSWITCH";
  const bool is_on = same_name(name, is_voltage ? "Von" : "Ion"), is_off = same_name(name, is_voltage ? "Voff" : "Ioff");
  if (!is_on && !is_off) return false;
  const bool is_upright = is_voltage ? v.get("Von") >= v.get("Voff") : v.get("Ion") >= v.get("Ioff");
  const double scale = is_upright ? p : -p;
  return levels(is_on ? scale : 0.0, is_off ? scale : 0.0, moves);
}

bool Slots::mosfet_value(std::string_view name, double p, NetworkMoves& moves) const {
  const Values& v = model_->values;
  const int channel = parts_.find(network_.switches, "");
  const double m = value("m");
  const bool is_drop = same_name(name, "Vfwd");
  if (is_drop || same_name(name, "Rfwd")) {
    bool any = false;
    for (const std::string_view part : {"body diode", "bulk diode"})
      if (const int k = parts_.find(network_.diodes, part); k >= 0)
        any = contact(is_drop ? Moved::diode_drop : Moved::diode_resistance, k, is_drop ? p : p / m, moves) || any;
    return any;
  }
  if (instance_.drive_is_apart || channel < 0) return false;
  if (same_name(name, "Ron") && v.has("Ron")) return contact(Moved::switch_resistance, channel, p / m, moves);
  const bool is_p_type = model_->kind->type == "PMOS" || (model_->kind->type == "VDMOS" && v.has("pchan"));
  return same_name(name, "Vto") && v.has("Ron") && levels(is_p_type ? -p : p, is_p_type ? -p : p, moves);
}

bool Slots::drop(int contact_index, double p, NetworkMoves& moves) const {
  if (std::isinf(std::max(model_->values.get("Ron"), model_->values.get("Roff"))))
    return contact(Moved::switch_drop, contact_index, p, moves);
  const int k = parts_.find(network_.branches, "Vser");
  if (k >= 0) moves.push_back({.item = Moved::branch_form, .index = k, .form = {model::constant(p)}});
  return k >= 0;
}

bool Slots::add_source(const model::SourceFunction& derivative, NetworkMoves& moves) const {
  const int k = parts_.find(network_.sources, "");
  if (k >= 0) moves.push_back({.item = Moved::source, .index = k, .function = derivative});
  return k >= 0;
}

}  // namespace pwlsim::circuit
