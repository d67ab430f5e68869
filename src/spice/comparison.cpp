#include "spice/comparison.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::spice {
namespace {

constexpr double rounding = 1e-9;  // of a signal's largest: what ngspice's own arithmetic leaves

double largest(const std::vector<double>& values) {
  double result = 0.0;
  for (double value : values) result = std::max(result, std::abs(value));
  return result;
}

ComparedSignal compare_signal(const SignalStudy& study, const std::vector<double>& times, const std::vector<double>& exact) {
  ComparedSignal signal;
  signal.name = study.name;
  signal.scale = largest(exact);
  if (signal.scale == 0.0) signal.scale = study.scale;
  const double unit = signal.scale == 0.0 ? 1.0 : signal.scale;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double difference = std::abs(study.values[k] - exact[k]) / unit;
    signal.mean += difference / static_cast<double>(times.size());
    if (difference <= signal.difference) continue;
    signal.difference = difference;
    signal.time = times[k];
  }
  signal.discretisation = study.discretisation / unit;
  signal.smoothing = study.smoothing / unit;
  signal.settled = study.settled;
  signal.explained = signal.settled && signal.difference <= safety * (signal.discretisation + signal.smoothing) + rounding;
  return signal;
}

/// Changes are partners in their order where both have as many, else each exact one has the nearest.
ComparedEvents compare_events(const SwitchingTimes& exact, const SwitchingTimes& ngspice) {
  ComparedEvents events{exact.name, exact.times.size(), ngspice.times.size(), 0.0, 0.0};
  if (ngspice.times.empty()) return events;
  for (std::size_t k = 0; k < exact.times.size(); ++k) {
    const double time = exact.times[k];
    double distance = std::abs(ngspice.times[std::min(k, ngspice.times.size() - 1)] - time);
    if (events.exact != events.ngspice) {
      const auto next = std::lower_bound(ngspice.times.begin(), ngspice.times.end(), time);
      distance = next == ngspice.times.end() ? time - ngspice.times.back() : *next - time;
      if (next != ngspice.times.begin()) distance = std::min(distance, time - *(next - 1));
    }
    if (distance <= events.worst) continue;
    events.worst = distance;
    events.at = time;
  }
  return events;
}

}  // namespace

Comparison compare(const Study& study, const std::vector<double>& sample_times, const ExactResults& exact) {
  Comparison comparison;
  for (std::size_t k = 0; k < study.signals.size(); ++k)
    comparison.signals.push_back(compare_signal(study.signals[k], sample_times, exact.values[k]));
  for (const SwitchingTimes& changes : exact.switching) {
    const auto part = std::find_if(study.finest.switching.begin(), study.finest.switching.end(),
                                   [&](const SwitchingPart& p) { return p.control.name == changes.name; });
    if (part != study.finest.switching.end()) comparison.events.push_back(compare_events(changes, switching_times(*part, study.waveforms)));
  }
  return comparison;
}

SwitchingTimes switching_times(const SwitchingPart& part, const waveform::RawFile& waveforms) {
  SwitchingTimes result{part.control.name, {}};
  const SignalReader control(waveforms, part.control);
  if (!control.known() || waveforms.rows() == 0) return result;
  double before = control.at_row(0);
  bool on = before > part.on_level;
  for (std::size_t row = 1; row < waveforms.rows(); ++row) {
    const double now = control.at_row(row);
    const double level = on ? part.off_level : part.on_level;
    if (on ? now < level : now > level) {
      on = !on;
      const double from = waveforms.at(row - 1, 0), to = waveforms.at(row, 0);
      const double share = now == before ? 1.0 : std::clamp((level - before) / (now - before), 0.0, 1.0);
      result.times.push_back(from + share * (to - from));
    }
    before = now;
  }
  return result;
}

}  // namespace pwlsim::spice
