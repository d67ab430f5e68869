#include "analysis/bode_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pwlsim::analysis {
namespace {

constexpr std::size_t most_curves = 6;
constexpr double full_turn = 360.0;

/// `value_at(k)`: at frequency number k.
template <class Values>
void add_curves(const std::string& name, const std::vector<double>& frequencies, const Values& value_at, waveform::Figure& figure) {
  waveform::Curve magnitude{name, {}, {}}, phase{name, {}, {}};
  double last = 0.0;
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    const std::complex<double> value = value_at(k);
    if (!(frequencies[k] > 0.0) || !(std::abs(value) > 0.0)) continue;  // nothing that a logarithm shows
    double degrees = std::arg(value) * 180.0 / std::numbers::pi;
    if (!phase.y.empty()) degrees += full_turn * std::nearbyint((last - degrees) / full_turn);
    last = degrees;
    for (waveform::Curve* curve : {&magnitude, &phase}) curve->x.push_back(std::log10(frequencies[k]));
    magnitude.y.push_back(20.0 * std::log10(std::abs(value)));
    phase.y.push_back(degrees);
  }
  figure.panels[0].curves.push_back(std::move(magnitude));
  figure.panels[1].curves.push_back(std::move(phase));
}

}  // namespace

waveform::Figure bode_figure(const std::string& title, const SmallSignalResult& result) {
  waveform::Figure figure{title, "frequency", "Hz", {{"magnitude", {}, "dB"}, {"phase", {}, "°"}}};
  figure.is_logarithmic = true;
  if (result.loop) {
    const LoopGain& loop = *result.loop;
    add_curves(
        fmt::format("loop {}", loop.source), result.frequencies, [&](std::size_t k) { return loop.values[k]; }, figure);
    waveform::Marks crossovers{"crossover", {}, {}}, margins{"gain margin", {}, {}};
    for (const auto& at : loop.crossovers) crossovers.x.push_back(std::log10(at.frequency));
    for (const auto& at : loop.gain_margins) margins.x.push_back(std::log10(at.frequency));
    for (waveform::Marks* marks : {&crossovers, &margins})
      if (!marks->x.empty()) figure.marks.push_back(std::move(*marks));
    return figure;
  }
  const std::size_t drawn = std::min(result.signals.size(), most_curves);
  for (std::size_t s = 0; s < drawn; ++s)
    add_curves(
        result.signals[s], result.frequencies, [&](std::size_t k) { return result.values[k][s]; }, figure);
  if (drawn < result.signals.size()) figure.title += fmt::format(" ({} of {} signals)", drawn, result.signals.size());
  return figure;
}

bool has_response(const SweptRuns& runs) {
  return std::any_of(runs.list.begin(), runs.list.end(), [](const SweptRun& run) { return run.small_signal.has_value(); });
}

waveform::Figure bode_figure(const std::string& title, const SweptRuns& runs) {
  waveform::Figure figure{title, "frequency", "Hz", {{"magnitude", {}, "dB"}, {"phase", {}, "°"}}};
  figure.is_logarithmic = true;
  std::vector<std::size_t> have;
  for (std::size_t k = 0; k < runs.list.size(); ++k)
    if (const auto& result = runs.list[k].small_signal; result && (result->loop || !result->signals.empty())) have.push_back(k);
  const std::size_t drawn = std::min(have.size(), most_curves);
  for (std::size_t i = 0; i < drawn; ++i) {
    const std::size_t run = have[drawn == 1 ? 0 : i * (have.size() - 1) / (drawn - 1)];
    const SmallSignalResult& result = *runs.list[run].small_signal;
    const std::string name = result.loop ? fmt::format("loop {}", result.loop->source) : result.signals.front();
    add_curves(
        fmt::format("{}, {}", name, runs.name(run)), result.frequencies,
        [&](std::size_t k) { return result.loop ? result.loop->values[k] : result.values[k].front(); }, figure);
  }
  if (drawn < have.size()) figure.title += fmt::format(" ({} of {} runs)", drawn, have.size());
  return figure;
}

}  // namespace pwlsim::analysis
