#include "measure/fourier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pwlsim::measure {
namespace {

/// ωk·length up to which sixteen points resolve the product of a signal and a sinusoid.
constexpr double largest_angle = 4.0;
constexpr double share_of_window = 1e-14;
constexpr double degree = 180.0 / std::numbers::pi;
/// Of the fundamental: a magnitude that is rounding has no phase, and a fundamental of that size no distortion.
constexpr double nothing = 1e-13;
/// Of the mean square: what is left of it behind the fundamental, and is rounding.
constexpr double parseval_rounding = 4e-15;

circuit::MeasuredExpression signal_expression(int probe) {
  circuit::MeasuredExpression expression;
  expression.steps.push_back({.kind = circuit::StepKind::signal, .index = probe});
  return expression;
}

}  // namespace

FourierMeter::FourierMeter(const circuit::FourierAnalysis& analysis, std::size_t signal, double start, double stop)
    : analysis_(analysis),
      signal_(signal),
      program_(signal_expression(analysis.signals[signal].probe)),
      to_(stop),
      periods_(analysis.periods) {
  constexpr double rounding = 1e-9;
  if (periods_ == 0.0) periods_ = std::floor((stop - start) * analysis.frequency * (1.0 + rounding));
  from_ = stop - periods_ / analysis.frequency;
  if (periods_ < 1.0 || from_ < -rounding * stop)
    failure_ = fmt::format("the run of {} s contains no {} of {} Hz", stop, periods_ > 1.0 ? fmt::format("{} periods", periods_) : "period",
                           analysis.frequency);
  from_ = std::max(from_, 0.0);
  sums_.resize(analysis.harmonics);
}

void FourierMeter::take(PieceView& view) {
  const double from = std::max(from_, view.piece().from);
  const double to = std::min(to_, view.piece().to);
  if (!failure_.empty() || !(from < to)) return;
  const double fastest = 2.0 * std::numbers::pi * analysis_.frequency * static_cast<double>(analysis_.harmonics);
  const auto parts = static_cast<std::size_t>(std::ceil(fastest * (to - from) / largest_angle));
  static const std::vector<double> no_results;
  linalg::LegendreValues values;
  double begin = from;
  for (std::size_t i = 1; i <= parts; ++i) {
    const double end = i == parts ? to : from + (to - from) * static_cast<double>(i) / static_cast<double>(parts);
    if (!(begin < end)) continue;
    view.values(program_, no_results, begin, end, values.data());
    add(values, begin, end);
    begin = end;
  }
}

/// The window takes what happens at its begin, not at its end.
void FourierMeter::take_impulse(double time, std::span<const double> values) {
  const double impulse = values[static_cast<std::size_t>(analysis_.signals[signal_].probe)];
  const double edge = share_of_window * to_;
  if (!failure_.empty() || impulse == 0.0 || time < from_ - edge || time >= to_ - edge) return;
  if (!std::isfinite(impulse)) {
    failure_ = fmt::format("impulses of higher order act at t = {} s", time);
    return;
  }
  has_impulse_ = true;
  const std::complex<double> turn = std::polar(1.0, 2.0 * std::numbers::pi * analysis_.frequency * (time - from_));
  std::complex<double> power = impulse;
  for (auto& sum : sums_) {
    sum += std::complex<long double>(power);
    power *= turn;
  }
}

void FourierMeter::add(const linalg::LegendreValues& values, double from, double to) {
  const auto& rule = linalg::gauss_legendre();
  const double half = 0.5 * (to - from);
  const double omega = 2.0 * std::numbers::pi * analysis_.frequency;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double angle = omega * ((from - from_) + half * (rule.point[i] + 1.0));
    const std::complex<double> turn = std::polar(1.0, angle);
    const double weighted = half * rule.weight[i] * values[i];
    square_ += static_cast<long double>(weighted) * values[i];
    std::complex<double> power = weighted;
    for (auto& sum : sums_) {
      sum += std::complex<long double>(power);
      power *= turn;
    }
  }
}

FourierResult FourierMeter::finish(double reached) const {
  FourierResult result;
  result.column = analysis_.signals[signal_].column;
  result.failure = failure_;
  if (failure_.empty() && reached < to_ * (1.0 - share_of_window)) result.failure = fmt::format("the run ended at t = {} s", reached);
  if (!result.failure.empty()) return result;
  const long double length = static_cast<long double>(periods_) / analysis_.frequency;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    // Σ y e^{ikωt}: twice its real part is the cosine's amplitude, twice the imaginary part that of the sine.
    const std::complex<long double> c = sums_[k] * ((k == 0 ? 1.0L : 2.0L) / length);
    const auto magnitude = static_cast<double>(k == 0 ? c.real() : std::abs(c));
    const auto phase = k == 0 ? 0.0 : static_cast<double>(std::atan2(c.real(), c.imag())) * degree;
    result.harmonics.push_back({static_cast<double>(k) * analysis_.frequency, magnitude, phase});
  }
  if (result.harmonics.size() < 2) return result;
  double size = std::sqrt(static_cast<double>(square_ / length));
  for (const Harmonic& harmonic : result.harmonics) size = std::max(size, harmonic.magnitude);
  const double fundamental = result.harmonics[1].magnitude;
  double listed = 0.0;
  for (std::size_t k = 1; k < result.harmonics.size(); ++k) {
    Harmonic& harmonic = result.harmonics[k];
    if (harmonic.magnitude <= nothing * size) harmonic.phase = 0.0;
    if (k > 1) listed += harmonic.magnitude * harmonic.magnitude;
  }
  if (fundamental <= nothing * size) return result;
  result.listed_distortion = std::sqrt(listed) / fundamental;
  if (has_impulse_) {
    result.total_distortion = std::numeric_limits<double>::infinity();
    return result;
  }
  const double mean = result.harmonics[0].magnitude;
  const auto power = static_cast<double>(2.0L * square_ / length);
  const double all = power - 2.0 * mean * mean - fundamental * fundamental;
  const bool is_rounding = all <= parseval_rounding * power;
  result.total_distortion = std::sqrt(is_rounding ? listed : std::max(all, listed)) / fundamental;
  return result;
}

std::string fourier_text(const FourierResult& result) {
  if (!result.failure.empty()) return fmt::format("Fourier analysis for {}: failed\n", result.column);
  const std::string all =
      std::isinf(result.total_distortion) ? "infinite (there are impulses)" : fmt::format("{:.6g} %", 100.0 * result.total_distortion);
  std::string text = fmt::format("Fourier analysis for {}:\n  No. Harmonics: {}, THD: {:.6g} %, THD of all harmonics: {}\n\n",
                                 result.column, result.harmonics.size(), 100.0 * result.listed_distortion, all);
  text += "Harmonic Frequency     Magnitude        Phase       Norm. Mag        Norm. Phase\n";
  text += "-------- ---------     ---------        -----       ---------        -----------\n";
  const Harmonic first = result.harmonics.size() > 1 ? result.harmonics[1] : Harmonic{};
  for (std::size_t k = 0; k < result.harmonics.size(); ++k) {
    const Harmonic& h = result.harmonics[k];
    const bool is_normed = k > 0 && first.magnitude > 0.0;
    text += fmt::format("{:<8} {:<13.8g} {:<16.9g} {:<11.6g} {:<16.9g} {:<.6g}\n", k, h.frequency, h.magnitude, h.phase,
                        is_normed ? h.magnitude / first.magnitude : 0.0, is_normed ? h.phase - first.phase : 0.0);
  }
  return text + "\n";
}

}  // namespace pwlsim::measure
