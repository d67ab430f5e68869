#include "circuit/row_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/names.hpp"

namespace pwlsim::circuit {

namespace {

constexpr double rows_a_period = 2.0;  ///< as many or fewer do not show it
constexpr double suggested_rows = 40.0;

}  // namespace

double period_of(const model::SourceFunction& function) {
  if (const auto* sine = std::get_if<model::Sin>(&function); sine && sine->amplitude != 0.0 && sine->frequency > 0.0 && sine->cycles > 1.0)
    return 1.0 / sine->frequency;
  if (const auto* pulse = std::get_if<model::Pulse>(&function); pulse && pulse->initial != pulse->pulsed && pulse->cycles > 1.0)
    return pulse->period;
  return model::forever;
}

void check_row_step(const model::Network& network, const TransientAnalysis& transient, Reporter& reporter) {
  const auto fastest = std::min_element(network.sources.begin(), network.sources.end(),
                                        [](const auto& x, const auto& y) { return period_of(x.function) < period_of(y.function); });
  if (fastest == network.sources.end()) return;
  const double period = period_of(fastest->function);
  const double length = transient.stop.seconds - transient.start.seconds, step = transient.row_step();
  if (!(period < length) || step * rows_a_period < period) return;
  reporter.warning(
      "W-coarse-rows", transient.span,
      fmt::format("rows every {:.6g} s do not show {}, whose period is {:.6g} s; for the waveforms try .tran {:.2g} {:.6g} or --plot; "
                  "measurements do not depend on the rows",
                  step, fastest->label.name, period, period / suggested_rows, transient.stop.seconds));
}

namespace {

MeasuredExpression constant(double value, std::vector<double> gradient) {
  MeasuredExpression expression;
  expression.steps.push_back({.kind = StepKind::number, .number = value, .gradient = std::move(gradient)});
  return expression;
}

/// How the period of a source moves with a parameter.
double period_move(const model::Network& network, const model::Source& source, const SensitivityAnalysis::Parameter& parameter) {
  for (const model::NetworkMove& move : parameter.moves) {
    if (move.item != model::NetworkMove::Item::source) continue;
    if (network.sources[static_cast<std::size_t>(move.index)].label.name != source.label.name) continue;
    if (const auto* pulse = std::get_if<model::Pulse>(&*move.function)) return std::isfinite(pulse->period) ? pulse->period : 0.0;
    const auto* sine = std::get_if<model::Sin>(&*move.function);
    const double period = period_of(source.function);
    return sine != nullptr ? -sine->frequency * period * period : 0.0;
  }
  return 0.0;
}

/// To each parameter: of the period of a source. Elements whose values move it get a number of their own.
std::vector<double> period_gradient(const model::Network& network, const model::Source& source, std::optional<SensitivityAnalysis>& card) {
  std::vector<double> gradient;
  if (!card) return gradient;
  int count = 0;
  for (const SensitivityAnalysis::Parameter& parameter : card->parameters) count = std::max(count, parameter.number + 1);
  for (SensitivityAnalysis::Parameter& parameter : card->parameters) {
    const double move = period_move(network, source, parameter);
    if (move == 0.0) continue;
    if (parameter.number < 0) parameter.number = count++;
    gradient.resize(static_cast<std::size_t>(count), 0.0);
    gradient[static_cast<std::size_t>(parameter.number)] = move;
  }
  return gradient;
}

}  // namespace

void resolve_last_periods(const model::Network& network, Analyses& analyses, Measurements& measurements, Reporter& reporter) {
  const TransientAnalysis& transient = *analyses.transient;
  for (Measurement& measurement : measurements.list) {
    if (!measurement.last_periods) continue;
    const Measurement::LastPeriods& last = *measurement.last_periods;
    const auto source = std::find_if(network.sources.begin(), network.sources.end(),
                                     [&](const model::Source& each) { return same_name(each.label.name, last.source); });
    const double period = source == network.sources.end() ? model::forever : period_of(source->function);
    const double stop = transient.stop.seconds, from = stop - last.count * period;
    constexpr double rounding = 1e-9;  // of a period
    if (!(period < model::forever)) {
      reporter.error("E-measurement", last.span,
                     fmt::format("measurement {}: {} is not a periodic source; try one with SIN or PULSE", measurement.name, last.source));
    } else if (from < -rounding * period) {
      reporter.error(
          "E-measurement", last.span,
          fmt::format("measurement {}: the run contains {:.6g} periods of {} ({:.6g} s), not {}; try a later Tstop or a smaller n",
                      measurement.name, stop / period, last.source, period, last.count));
    } else {
      std::vector<double> moves = period_gradient(network, *source, analyses.sensitivities);
      moves.resize(std::max(moves.size(), transient.stop.gradient.size()), 0.0);
      for (double& move : moves) move *= -last.count;
      for (std::size_t k = 0; k < transient.stop.gradient.size(); ++k) moves[k] += transient.stop.gradient[k];
      measurement.from = constant(std::max(from, 0.0), std::move(moves));
      measurement.to = constant(stop, transient.stop.gradient);
    }
  }
}

}  // namespace pwlsim::circuit
