#include "analysis/modulation.hpp"

#include <cmath>
#include <numbers>

namespace pwlsim::analysis {
namespace {

using circuit::SmallSignalAnalysis;
using Complex = std::complex<double>;

constexpr double same_time = 1e-9;  ///< of the period: an instant is that of an edge

/// A pulse that begins later by a unit, or that ends later by one (`ends_only`).
steady::Wave moved_pulse(const model::Pulse& pulse, bool ends_only, int input) {
  model::Pulse by{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  (ends_only ? by.width : by.delay) = 1.0;
  return {input, pulse, by, -1, ""};
}

/// Empty where the source's sinusoid decays or ends.
std::optional<ModulatedSine> modulated_sine(const model::SourceFunction& function, std::size_t input, double period) {
  const auto* sine = std::get_if<model::Sin>(&function);
  if (sine == nullptr || sine->damping != 0.0 || std::isfinite(sine->cycles)) return std::nullopt;
  const double turn = 2.0 * std::numbers::pi;
  return ModulatedSine{input, sine->amplitude, sine->frequency, sine->phase - turn * sine->frequency * sine->delay,
                       static_cast<int>(std::lround(sine->frequency * period))};
}

}  // namespace

/// Why the timing of a source cannot be modulated; "" where it can.
std::string immovable(const model::SourceFunction& function, const SmallSignalAnalysis& card) {
  if (std::holds_alternative<model::Pulse>(function)) return "";
  if (card.input == SmallSignalAnalysis::Input::duty) return "is not a PULSE source: only edges of PULSE sources can be moved";
  return modulated_sine(function, 0, 1.0) ? ""
                                          : "is neither a PULSE source nor a sinusoid without damping: its frequency cannot be modulated";
}

Modulation::Modulation(const SmallSignalAnalysis& card, const std::vector<const model::SourceFunction*>& sources,
                       const steady::LinearisedOrbit& orbit)
    : card_(card), orbit_(orbit) {
  for (std::size_t k = 0; k < sources.size(); ++k) {
    if (const auto* pulse = std::get_if<model::Pulse>(sources[k]))
      waves_.push_back(moved_pulse(*pulse, card.input == SmallSignalAnalysis::Input::duty, static_cast<int>(k)));
    if (const auto sine = modulated_sine(*sources[k], k, orbit.period())) sines_.push_back(*sine);
  }
}

steady::ComplexVector Modulation::response(steady::Transfer& transfer, double f, const std::vector<Complex>& amplitudes,
                                           const std::optional<double>& sample) const {
  const Complex turning(0.0, 2.0 * std::numbers::pi);
  std::vector<Complex> by;
  for (const steady::Wave& wave : waves_) {
    const double own = std::get<model::Pulse>(wave.function).period;
    by.push_back(card_.input == SmallSignalAnalysis::Input::duty ? Complex(own) : -own / (turning * f));
  }
  steady::ComplexVector sum = transfer.at(f, card_.harmonic, amplitudes, shifts(by), sample).signals;
  for (const ModulatedSine& sine : sines_) sum += response_to(sine, transfer, f, sample);
  return sum;
}

/// Pulses move in time, as much as `by` says of each.
steady::TimeShifts Modulation::shifts(const std::vector<Complex>& by) const {
  const double near = same_time * orbit_.period();
  steady::TimeShifts moved;
  for (const steady::LinearInstant& instant : orbit_.instants()) {
    Complex& shift = moved.shifts.emplace_back(0.0);
    const bool passes_threshold = instant.island >= 0 || instant.level_switch >= 0;
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      auto own = steady::edge_shift(waves_[k], instant.time, near, true);
      if (!own && !passes_threshold) own = steady::corner_shift(waves_[k], instant.time, near, true);
      if (own) shift = by[k] * *own;
    }
  }
  moved.amplitude = [this, by](std::size_t input, double time) {
    for (std::size_t k = 0; k < waves_.size(); ++k)
      if (waves_[k].input == static_cast<int>(input)) return by[k] * steady::wave_state(waves_[k], time, time, true)[0];
    return Complex(0.0);
  };
  return moved;
}

/// Its harmonic: c_{h−N} of the input at f + f₀, and c_{h+N} of that at f − f₀.
steady::ComplexVector Modulation::response_to(const ModulatedSine& sine, steady::Transfer& transfer, double f,
                                              const std::optional<double>& sample) const {
  steady::ComplexVector sum;
  for (const int side : {1, -1}) {
    std::vector<Complex> amplitudes(card_.sources.size(), 0.0);
    amplitudes[sine.input] = 0.5 * sine.amplitude * std::exp(Complex(0.0, side * sine.phase)) / (Complex(0.0, 1.0) * f);
    steady::ComplexVector own = transfer.at(f + side * sine.frequency, card_.harmonic - side * sine.cycles, amplitudes, {}, sample).signals;
    if (sample) own *= std::exp(Complex(0.0, side * 2.0 * std::numbers::pi * sine.frequency * *sample));
    sum = side > 0 ? own : steady::ComplexVector(sum + own);
  }
  return sum;
}

}  // namespace pwlsim::analysis
