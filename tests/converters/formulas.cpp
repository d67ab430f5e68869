#include "converters/formulas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "converters/integrator.hpp"

namespace pwlsim::test::converters {
namespace {

constexpr double patience = 10.0;

ConverterBuilder start(const char* name, Contact diode, double period, double stop) {
  ConverterBuilder builder(name);
  builder.converter.models = {diode, {1e-3, 1e9, 0.0}};
  builder.converter.fast = period;
  builder.converter.row_step = stop / 37;
  builder.converter.stop = stop;
  return builder;
}

/// `expected`: the signals at a time.
double compare(const Converter& converter, const std::function<std::vector<double>(double)>& expected) {
  const Resolved resolved = resolve(converter, 1e-9, patience);
  if (!resolved.waveforms.trouble.empty()) {
    fmt::print("{}: {}\n", converter.family, resolved.waveforms.trouble);
    return infinity;
  }
  std::vector<std::vector<double>> rows;
  for (const double time : resolved.waveforms.times) rows.push_back(expected(time));
  const double error = largest_difference(resolved.waveforms, rows, converter).size;
  fmt::print("{}: {:.1e}\n", converter.family, error);
  return error;
}

/// L and C in series behind a diode at a constant voltage E: v = E(1 - cos ωt) until π/ω, then 2E.
double resonant_charge() {
  constexpr double volts = 10.0, henry = 1e-5, farad = 1e-6;
  const double omega = 1.0 / std::sqrt(henry * farad), end = std::numbers::pi / omega;
  ConverterBuilder builder = start("resonant charge through an ideal diode", {}, end, 3.0 * end);
  builder.source("a", "0", constant(volts));
  builder.diode("a", "b");
  builder.inductor("b", "c", henry);
  builder.capacitor("c", "0", farad);
  return compare(builder.converter, [=](double t) -> std::vector<double> {
    if (t >= end) return {0.0, 2.0 * volts};
    return {volts * farad * omega * std::sin(omega * t), volts * (1.0 - std::cos(omega * t))};
  });
}

/// R, L and a diode in series at a PULSE: exponentials through Ron until the current is zero, then what leaks through Roff.
double blocked_inductor() {
  constexpr double volts = 5.0, ohms = 2.0, henry = 1e-3, off = 1e9, high = 1e-3;
  ConverterBuilder builder = start("inductor behind Roff", {0.1, off, 0.0}, 1e-3, 3e-3);
  Wave wave = pulse(0.0, 0.0, 0.0, high, 1.0);
  wave.offset = -volts;
  wave.high = volts;
  builder.source("a", "0", wave);
  builder.resistor("a", "b", ohms);
  builder.diode("b", "c");
  builder.inductor("c", "0", henry);
  const double resistance = ohms + 0.1, steady = volts / resistance, rate = resistance / henry;
  const double at_edge = steady * (1.0 - std::exp(-rate * high));
  const double zero = high + std::log((at_edge + steady) / steady) / rate;
  return compare(builder.converter, [=](double t) -> std::vector<double> {
    if (t < high) return {steady * (1.0 - std::exp(-rate * t))};
    if (t < zero) return {(at_edge + steady) * std::exp(-rate * (t - high)) - steady};
    return {-volts / (ohms + off)};  // L/Roff is 1e-12 s
  });
}

/// R and L at a sinusoid, from rest: the steady sinusoid less what it has at 0, decaying.
double sinusoid() {
  constexpr double volts = 325.0, ohms = 3.0, henry = 0.02, frequency = 50.0, phase = 40.0;
  const double omega = 2.0 * std::numbers::pi * frequency, size = volts / std::hypot(ohms, omega * henry);
  const double angle = phase / 180.0 * std::numbers::pi - std::atan2(omega * henry, ohms);
  ConverterBuilder builder = start("R and L at a sinusoid", {}, 1.0 / frequency, 0.1);
  builder.source("a", "0", sine(volts, frequency, phase));
  builder.resistor("a", "b", ohms);
  builder.inductor("b", "0", henry);
  return compare(builder.converter, [=](double t) -> std::vector<double> {
    return {size * (std::sin(omega * t + angle) - std::sin(angle) * std::exp(-ohms / henry * t))};
  });
}

/// A perfect transformer with a resistor: the flux decays with R times the turns squared.
double transformer() {
  constexpr double volts = 12.0, henry = 1e-3, ratio = 0.5, ohms = 7.0, source_ohms = 1.0;
  ConverterBuilder builder = start("perfect transformer", {}, 1e-3, 2e-3);
  builder.source("a", "0", constant(volts));
  builder.resistor("a", "b", source_ohms);
  builder.couple({builder.inductor("b", "0", henry), builder.inductor("s", "0", henry * ratio * ratio)}, 1.0);
  builder.resistor("s", "0", ohms);
  const double load = ohms / (ratio * ratio), parallel = load * source_ohms / (load + source_ohms);
  return compare(builder.converter, [=](double t) -> std::vector<double> {
    const double primary = volts * parallel / source_ohms * std::exp(-parallel / henry * t);
    return {(volts - primary) / source_ohms, -primary * ratio / ohms};
  });
}

/// A thyristor, R and L at a sinusoid, ωL = R, fired at α: with i' + i = sin t the current is (sin(t − π/4) − sin(α − π/4) e^{α−t})/√2 until that is zero.
double fired_rectifier(double alpha) {
  constexpr double volts = 100.0, ohms = 2.0, frequency = 50.0, pi = std::numbers::pi;
  const double omega = 2.0 * pi * frequency, period = 1.0 / frequency;
  ConverterBuilder builder = start("thyristor with R and L", {}, period, 2.9 * period);
  builder.source("a", "0", sine(volts, frequency, 0.0));
  builder.thyristor("a", "b", builder.gate(pulse(alpha / omega, 0.0, 0.0, 0.003 * period, period)));
  builder.inductor("b", "c", ohms / omega);
  builder.resistor("c", "0", ohms);
  const auto current = [=](double angle) {
    return volts / ohms * (std::sin(angle - pi / 4) - std::sin(alpha - pi / 4) * std::exp(alpha - angle)) / std::sqrt(2.0);
  };
  return compare(builder.converter, [=](double t) -> std::vector<double> {
    const double angle = std::fmod(omega * t, 2.0 * pi);
    return {angle < alpha ? 0.0 : std::max(0.0, current(angle))};  // it stays negative until the next period
  });
}

}  // namespace

double check_formulas() {
  return std::max({resonant_charge(), blocked_inductor(), sinusoid(), transformer(), fired_rectifier(0.3), fired_rectifier(2.0)});
}

}  // namespace pwlsim::test::converters
