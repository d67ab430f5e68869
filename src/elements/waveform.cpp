#include "elements/waveform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/names.hpp"

namespace pwlsim::elements {
namespace {

using Function = std::optional<model::SourceFunction>;

constexpr Parameter sin_parameters[] = {
    {"Voff", "V or A", 0.0, Range::any, false, "Offset."},
    {"Vamp", "V or A", 0.0, Range::any, false, "Amplitude."},
    {"Freq", "Hz", 0.0, Range::not_negative, false, "Frequency."},
    {"Td", "s", 0.0, Range::any, false, "Delay; before it the value is Voff + Vamp sin(Phi)."},
    {"Theta", "1/s", 0.0, Range::any, false, "Damping."},
    {"Phi", "deg", 0.0, Range::any, false, "Phase."},
    {"Ncycles", "", 0.0, Range::not_negative, true, "Number of cycles; 0 counts as no limit."},
};

constexpr Parameter pulse_parameters[] = {
    {"V1", "V or A", 0.0, Range::any, false, "Value before the first edge and between pulses."},
    {"V2", "V or A", 0.0, Range::any, false, "Value of the pulse."},
    {"Td", "s", 0.0, Range::any, false, "Delay of the first edge."},
    {"Tr", "s", 0.0, Range::not_negative, false, "Rise time; 0 is a true jump."},
    {"Tf", "s", 0.0, Range::not_negative, false, "Fall time; 0 is a true jump."},
    {"Ton", "s", infinite, Range::not_negative, true, "Time at V2; if omitted, to the end."},
    {"Tper", "s", 0.0, Range::not_negative, true, "Period; 0 is one pulse."},
    {"Ncycles", "", 0.0, Range::not_negative, true, "Number of pulses; 0 counts as no limit."},
};

constexpr Parameter exp_parameters[] = {
    {"V1", "V or A", 0.0, Range::any, false, "Value before Td1."},
    {"V2", "V or A", 0.0, Range::any, false, "Final value of the rise."},
    {"Td1", "s", 0.0, Range::any, false, "Start of the rise."},
    {"Tau1", "s", 0.0, Range::positive, false, "Time constant of the rise."},
    {"Td2", "s", infinite, Range::any, true, "Start of the fall; if omitted, the source never falls."},
    {"Tau2", "s", 1.0, Range::positive, false, "Time constant of the fall."},
};

double unlimited_if_zero(double count) { return count == 0.0 ? model::forever : count; }

Function make_sin(const Values& v, SourceSpan, Diagnostics&) {
  model::Sin sin;
  sin.offset = v.get("Voff");
  sin.amplitude = v.get("Vamp");
  sin.frequency = v.get("Freq");
  sin.delay = v.get("Td");
  sin.damping = v.get("Theta");
  sin.phase = v.get("Phi") * (std::numbers::pi / 180.0);
  sin.cycles = unlimited_if_zero(v.get("Ncycles"));
  return sin;
}

model::Pulse read_pulse(const Values& v) {
  model::Pulse pulse;
  pulse.initial = v.get("V1");
  pulse.pulsed = v.get("V2");
  pulse.delay = v.get("Td");
  pulse.rise = v.get("Tr");
  pulse.fall = v.get("Tf");
  pulse.width = v.get("Ton");
  pulse.period = std::isinf(pulse.width) ? model::forever : unlimited_if_zero(v.get("Tper"));
  pulse.cycles = unlimited_if_zero(v.get("Ncycles"));
  return pulse;
}

double length(const model::Pulse& pulse) { return pulse.rise + pulse.width + pulse.fall; }

/// Edges that fill the period but for rounding must not overtake the next pulse.
void fit_period(model::Pulse& pulse) {
  pulse.width = std::max(0.0, pulse.period - pulse.rise - pulse.fall);
  while (length(pulse) > pulse.period && pulse.width > 0.0) pulse.width = std::nextafter(pulse.width, 0.0);
}

/// A pulse train whose pulses are cut by the next: the same as a repeated polyline that ends at the period.
model::Pwl cut_train(const model::Pulse& pulse) {
  using Point = model::Pwl::Point;
  const double top = pulse.rise + pulse.width;
  const Point corners[] = {{0.0, pulse.initial}, {pulse.rise, pulse.pulsed}, {top, pulse.pulsed}, {top + pulse.fall, pulse.initial}};
  model::Pwl pwl;
  pwl.repeats = model::forever;
  pwl.repeat_from = pulse.delay;
  Point last = corners[0];
  for (const Point& corner : corners) {
    if (corner.time >= pulse.period) {
      const double slope = corner.time > last.time ? (corner.value - last.value) / (corner.time - last.time) : 0.0;
      pwl.points.push_back({pulse.delay + pulse.period, last.value + slope * (pulse.period - last.time)});
      break;
    }
    pwl.points.push_back({pulse.delay + corner.time, corner.value});
    last = corner;
  }
  return pwl;
}

Function make_pulse(const Values& v, SourceSpan span, Diagnostics& diagnostics) {
  constexpr double rounding = 1e-12;  // of the period: more than the sums of a deck's expressions lose
  model::Pulse pulse = read_pulse(v);
  if (!std::isinf(pulse.cycles) && pulse.cycles != std::floor(pulse.cycles)) {
    diagnostics.error("E-range", v.span("Ncycles"), "Ncycles of a PULSE must be a whole number");
    return std::nullopt;
  }
  if (std::isinf(pulse.period) || length(pulse) <= pulse.period) return pulse;
  if (length(pulse) <= pulse.period * (1.0 + rounding) && pulse.rise + pulse.fall <= pulse.period) {
    fit_period(pulse);
    return pulse;
  }
  constexpr double unseen = 1e-3;  // a triangle whose top is given a picosecond, as simulators with steps ask for
  if (length(pulse) > pulse.period * (1.0 + unseen))
    diagnostics.warning("W-pulse-cut", span, "Tr + Ton + Tf is longer than Tper: each pulse is cut short by the next");
  return std::isinf(pulse.cycles) ? Function(cut_train(pulse)) : Function(pulse);
}

Function make_exp(const Values& v, SourceSpan span, Diagnostics& diagnostics) {
  if (v.has("Td2") && !v.has("Tau2")) {
    diagnostics.error("E-missing-value", span, "EXP has Td2 but no Tau2; usage: EXP(V1 V2 Td1 Tau1 [Td2 Tau2])");
    return std::nullopt;
  }
  if (v.get("Td2") < v.get("Td1")) {
    diagnostics.error("E-range", v.span("Td2"), "Td2 must not be less than Td1");
    return std::nullopt;
  }
  return model::Exp{v.get("V1"), v.get("V2"), v.get("Td1"), v.get("Tau1"), v.get("Td2"), v.get("Tau2")};
}

constexpr WaveformKind kind_table[] = {
    {"SIN", "SINE", "SIN(Voff Vamp Freq [Td Theta Phi Ncycles])", sin_parameters, 3, make_sin},
    {"PULSE", "", "PULSE(V1 V2 [Td Tr Tf Ton Tper Ncycles])", pulse_parameters, 2, make_pulse},
    {"EXP", "", "EXP(V1 V2 Td1 Tau1 [Td2 Tau2])", exp_parameters, 4, make_exp},
};

}  // namespace

std::span<const WaveformKind> waveform_kinds() { return kind_table; }

const WaveformKind* find_waveform(std::string_view name) {
  const auto matches = [&](const WaveformKind& kind) {
    return same_name(kind.name, name) || (!kind.other_name.empty() && same_name(kind.other_name, name));
  };
  const auto* found = std::find_if(std::begin(kind_table), std::end(kind_table), matches);
  return found == std::end(kind_table) ? nullptr : found;
}

}  // namespace pwlsim::elements
