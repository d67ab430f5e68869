#include "analysis/small_signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "analysis/modulation.hpp"
#include "analysis/small_signal_columns.hpp"
#include "base/zero_between.hpp"
#include "engine/exact/exact_model.hpp"
#include "engine/sparse/linear_response.hpp"
#include "steady/transfer.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::SmallSignalAnalysis;
using Complex = std::complex<double>;
using Response = std::function<steady::ComplexVector(double frequency, const std::vector<Complex>& amplitudes)>;

bool is_interrupted(const std::atomic<int>* interrupt) { return interrupt != nullptr && interrupt->load(std::memory_order_relaxed) != 0; }

/// T at a frequency; `voltages`: the response there to the voltage source alone.
Complex gain_at(const SmallSignalInputs& inputs, const Response& response, double frequency, const steady::ComplexVector& voltages) {
  const Complex by_voltage = -voltages[inputs.negative] / voltages[inputs.positive];
  if (inputs.current < 0) return by_voltage;
  const Complex through = response(frequency, {0.0, 1.0})[inputs.current];
  const Complex by_current = (inputs.injected_at_negative + through) / (inputs.injected_at_positive - through);
  return (by_voltage * by_current - 1.0) / (by_voltage + by_current + 2.0);
}

/// A zero of a real function between two frequencies at which it has different signs.
double zero_between_frequencies(double low, double high, const std::function<double(double)>& f) {
  constexpr int most = 60;
  constexpr double rounding = 1e-14;
  return std::exp(zero_between(std::log(low), std::log(high), rounding, most, [&](double at) { return f(std::exp(at)); }));
}

/// `values`: T at the frequencies.
LoopGain loop_gain(const SmallSignalAnalysis& card, const std::vector<double>& frequencies, const SmallSignalInputs& inputs,
                   const Response& response, std::vector<Complex> values, const std::atomic<int>* interrupt) {
  LoopGain loop;
  loop.source = card.loop;
  const auto gain = [&](double f) { return gain_at(inputs, response, f, response(f, inputs.amplitudes)); };
  loop.values = std::move(values);
  const auto margin = [](Complex t) {
    double phase = 180.0 + degrees(t);
    while (phase > 180.0) phase -= 360.0;
    return phase;
  };
  for (std::size_t k = 1; k < frequencies.size() && !is_interrupted(interrupt); ++k) {
    const Complex a = loop.values[k - 1], b = loop.values[k];
    if (frequencies[k - 1] <= 0.0) continue;
    if ((std::abs(a) > 1.0) != (std::abs(b) > 1.0)) {
      const double f = zero_between_frequencies(frequencies[k - 1], frequencies[k], [&](double at) { return std::abs(gain(at)) - 1.0; });
      loop.crossovers.push_back({f, margin(gain(f))});
    }
    if (a.real() < 0.0 && b.real() < 0.0 && (a.imag() > 0.0) != (b.imag() > 0.0)) {
      const double f = zero_between_frequencies(frequencies[k - 1], frequencies[k], [&](double at) { return gain(at).imag(); });
      loop.gain_margins.push_back({f, -20.0 * std::log10(std::abs(gain(f)))});
    }
  }
  return loop;
}

/// c₀ for a constant input of an orbit whose phase nothing holds: its limit from frequencies at which there is one, c₀(ω) = Re c₀(0) + a ω² + b ω⁴ + ….
steady::ComplexVector limit_at_rest(double period, const std::function<steady::ComplexVector(double frequency)>& at) {
  constexpr double slow = 2e-5;        // of 1/period: what the series leaves out is of the order of (2π·slow)⁴
  constexpr double same_value = 1e-3;  // of two responses: they have a limit
  constexpr double rounding = 1e-12;   // of the largest response: nothing
  const steady::ComplexVector one = at(slow / period), two = at(2.0 * slow / period);
  steady::ComplexVector limit = ((4.0 * one - two) / 3.0).real().cast<Complex>();
  const double least = rounding * (one.allFinite() ? one.cwiseAbs().maxCoeff() : 0.0);
  for (Eigen::Index k = 0; k < limit.size(); ++k)
    if (!(std::abs(one[k] - two[k]) <= same_value * std::abs(one[k]) + least))
      limit[k] = Complex(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN());
  return limit;
}

SmallSignalResult evaluate(const circuit::Compiled& compiled, const SmallSignalInputs& inputs, const Response& response,
                           const std::atomic<int>* interrupt) {
  const SmallSignalAnalysis& card = *compiled.analyses.small_signal;
  SmallSignalResult result;
  const std::size_t saved = compiled.saved_signals();
  for (std::size_t k = 0; k < saved; ++k) result.signals.push_back(compiled.network.signals[k].name);
  const std::vector<SelectedColumn> selected = select_columns(compiled, result.signals);
  for (const SelectedColumn& column : selected) result.columns.push_back({column.name, {}});
  std::vector<Complex> gains;
  for (const double f : card.frequencies) {
    if (is_interrupted(interrupt)) break;
    result.frequencies.push_back(f);
    const steady::ComplexVector all = response(f, inputs.amplitudes);
    if (!card.loop.empty()) gains.push_back(gain_at(inputs, response, f, all));
    result.values.emplace_back(all.data(), all.data() + saved);
    for (std::size_t k = 0; k < selected.size(); ++k)
      result.columns[k].values.push_back(part_of(all[static_cast<Eigen::Index>(selected[k].signal)], selected[k].part));
    const auto is_infinite = [&](std::size_t signal) { return !std::isfinite(std::abs(all[static_cast<Eigen::Index>(signal)])); };
    bool is_singular = std::any_of(selected.begin(), selected.end(), [&](const SelectedColumn& each) { return is_infinite(each.signal); });
    for (std::size_t k = 0; k < saved; ++k) is_singular |= is_infinite(k);
    if (is_singular) result.singular.push_back(f);
  }
  if (!card.loop.empty()) result.loop = loop_gain(card, result.frequencies, inputs, response, std::move(gains), interrupt);
  return result;
}

}  // namespace

SmallSignalResult small_signals(const circuit::Compiled& compiled, const SmallSignalInputs& inputs, const model::Network& network,
                                const engine::ExactModel& model, const steady::Trace& trace, double period, bool is_driven,
                                const std::atomic<int>* interrupt) {
  const SmallSignalAnalysis& card = *compiled.analyses.small_signal;
  steady::LinearisedOrbit linear(model, trace, period, is_driven, inputs.names);
  const std::vector<int> unknown = linear.take_impulses(trace, is_driven);
  steady::Transfer transfer(linear, network.signals.size());
  const std::optional<double> sample = card.sample ? std::optional(std::fmod(*card.sample, period)) : std::nullopt;
  std::optional<Modulation> modulation;
  if (moves_edges(card)) {
    std::vector<const model::SourceFunction*> sources;
    for (const std::string& name : card.sources)
      sources.push_back(&network.sources[static_cast<std::size_t>(sources_named(network, name).front())].function);
    modulation.emplace(card, sources, linear);
  }
  const auto at = [&](double f, const std::vector<Complex>& amplitudes) {
    return modulation ? modulation->response(transfer, f, amplitudes, sample)
                      : transfer.at(f, card.harmonic, amplitudes, {}, sample).signals;
  };
  const auto response = [&](double f, const std::vector<Complex>& amplitudes) {
    const bool is_limit = f == 0.0 && !is_driven && !modulation && card.harmonic == 0 && !sample;
    return is_limit ? limit_at_rest(period, [&](double near) { return at(near, amplitudes); }) : at(f, amplitudes);
  };
  SmallSignalResult result = evaluate(compiled, inputs, response, interrupt);
  const std::vector<char> read_to_the_last = linear.inputs_read_to_the_last();
  result.is_beyond_derivatives = std::any_of(read_to_the_last.begin(), read_to_the_last.end(), [](char is) { return is != 0; });
  result.unknown_impulses = unknown;
  return result;
}

namespace {

/// What belongs to a period, "" where the card asks for nothing of the kind.
std::string periodic_part(const SmallSignalAnalysis& card) {
  if (card.input == SmallSignalAnalysis::Input::frequency) return "freq() modulates a period";
  if (card.input == SmallSignalAnalysis::Input::duty) return "duty() modulates edges of a period";
  if (card.harmonic != 0) return "harm= is a sideband of a period";
  if (card.sample) return "sample= is a time of a period";
  return "";
}

}  // namespace

LinearSmallSignals::LinearSmallSignals(const circuit::Compiled& compiled) : compiled_(&compiled), network_(compiled.network) {
  const SmallSignalAnalysis& card = *compiled.analyses.small_signal;
  inputs_ = add_small_signal_inputs(card, network_);
  Diagnostics diagnostics;
  equations_ = engine::sparse::prepare(network_, diagnostics);
  if (!equations_) {
    for (const Diagnostic& each : diagnostics.all())
      if (id_.empty() && each.severity == Severity::error) fail(each.id, each.text);
    return;
  }
  const std::string switching = engine::sparse::LinearResponse::switching(*equations_), part = periodic_part(card);
  if (!switching.empty())
    fail("E-ac-needs-pss", fmt::format("{} switches: small signals are those around a periodic steady state; try .pss", switching));
  else if (inputs_.id.empty() && !part.empty())
    fail("E-ac-needs-pss", part + ", and the deck has none; try .pss");
  else
    fail(inputs_.id, inputs_.message);
}

void LinearSmallSignals::fail(std::string id, std::string message) {
  id_ = std::move(id);
  message_ = std::move(message);
}

SmallSignalResult LinearSmallSignals::result(const std::atomic<int>* interrupt) const {
  if (!id_.empty()) return {};
  engine::sparse::LinearResponse linear(*equations_, inputs_.names);
  const auto response = [&](double f, const std::vector<Complex>& amplitudes) {
    const std::vector<Complex> values = linear.at(f, amplitudes);
    return steady::ComplexVector(Eigen::Map<const steady::ComplexVector>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  return evaluate(*compiled_, inputs_, response, interrupt);
}

void leave_out_impulsive(const circuit::Compiled& compiled, const std::vector<int>& signals, SmallSignalResult& result) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const std::vector<SelectedColumn> selected = select_columns(compiled, result.signals);
  for (const int signal : signals) {
    const auto number = static_cast<std::size_t>(signal);
    const auto is_column = [&](const SelectedColumn& column) { return column.signal == number; };
    if (number >= result.signals.size() && std::none_of(selected.begin(), selected.end(), is_column)) continue;
    result.impulsive.push_back(compiled.network.signals[number].name);
    for (auto& row : result.values)
      if (number < row.size()) row[number] = {unknown, unknown};
    for (std::size_t k = 0; k < selected.size(); ++k)
      if (selected[k].signal == number) std::fill(result.columns[k].values.begin(), result.columns[k].values.end(), unknown);
  }
}

std::string impulsive_text(const std::vector<std::string>& signals, const std::string& where) {
  return fmt::format("no response of {}{}: the orbit has impulses there, which the input changes; try a small resistance in their path",
                     fmt::join(signals, ", "), where);
}

}  // namespace pwlsim::analysis
