#include "measure/measuring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/unit.hpp"

namespace pwlsim::measure {

using MeasurementKind = circuit::Measurement::Kind;

Measuring::Measuring(const circuit::Measurements& measurements, double start, double stop, double end)
    : measurements_(measurements), start_(start), stop_(stop), end_(end), view_(measurements.probe_signals.size()) {
  const std::size_t count = measurements.list.size();
  known_.resize(count);
  values_.resize(count);
  failures_.resize(count);
  left_out_.resize(count);
  places_.resize(count);
  impulses_.resize(count);
}

bool Measuring::is_ready(std::size_t index) const {
  const std::vector<int> needed = circuit::results_read(measurements_.list[index]);
  return std::all_of(needed.begin(), needed.end(), [&](int other) { return known_[static_cast<std::size_t>(other)] != 0; });
}

/// Of a measurement that is ready: what it needs and failed, in words.
std::string Measuring::missing(std::size_t index) const {
  for (const int other : circuit::results_read(measurements_.list[index]))
    if (!failures_[static_cast<std::size_t>(other)].empty()) {
      const circuit::Measurement& needed = measurements_.list[static_cast<std::size_t>(other)];
      const std::string& why = failures_[static_cast<std::size_t>(other)];
      return needed.shown ? fmt::format("it needs {}, which failed", needed.name) : why;
    }
  return "";
}

void Measuring::settle(std::size_t index, double value, std::string failure) {
  known_[index] = 1;
  values_[index] = value;
  failures_[index] = std::move(failure);
}

/// What needs no run, as long as there is some that is ready.
void Measuring::evaluate_parameters() {
  bool again = true;
  while (again) {
    again = false;
    for (std::size_t k = 0; k < known_.size(); ++k) {
      if (known_[k] != 0 || !is_ready(k)) continue;
      std::string failure = missing(k);
      const bool is_period = measurements_.list[k].kind == MeasurementKind::period;
      const bool is_parameter = measurements_.list[k].kind == MeasurementKind::parameter;
      if (failure.empty() && !is_parameter && !is_period) continue;
      double value = is_period ? stop_ - start_ : 0.0;
      if (failure.empty() && is_parameter) value = Program(measurements_.list[k].expression).value(values_);
      if (!std::isfinite(value)) failure = "the result is not a finite number";
      settle(k, value, std::move(failure));
      again = true;
    }
  }
}

void Measuring::hold(double from, double to) {
  if (from_ >= to_) {
    from_ = from;
    to_ = to;
  }
  from_ = std::min(from_, from);
  to_ = std::max(to_, to);
}

void Measuring::start_meters() {
  meters_.clear();
  fourier_.clear();
  view_.set({});
  from_ = to_ = 0.0;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    if (known_[k] != 0 || !is_ready(k)) continue;
    Meter meter(measurements_.list[k], values_, start_, stop_, end_);
    if (meter.failure().empty()) {
      hold(meter.from(), meter.to());
      meters_.emplace_back(k, std::move(meter));
    } else {
      settle(k, 0.0, meter.failure());
    }
  }
  if (pass_ > 1) return;
  for (const circuit::FourierAnalysis& analysis : measurements_.fourier)
    for (std::size_t signal = 0; signal < analysis.signals.size(); ++signal) {
      fourier_.emplace_back(analysis, signal, start_, stop_);
      if (fourier_.back().is_possible()) hold(fourier_.back().from(), fourier_.back().to());
    }
}

bool Measuring::begin_pass() {
  ++pass_;
  while (true) {
    evaluate_parameters();
    const auto settled = std::count(known_.begin(), known_.end(), 1);
    start_meters();
    if (pass_ == 1 || !meters_.empty()) return true;
    if (settled == std::count(known_.begin(), known_.end(), 1)) return false;
  }
}

engine::Probes Measuring::probes() {
  engine::Probes probes;
  probes.signals = measurements_.probe_signals;
  probes.from = from_;
  probes.to = to_;
  probes.sink = to_ > from_ ? this : nullptr;
  return probes;
}

/// The values before t = 0 as a piece of their own.
void Measuring::before_start(std::span<const double> values) {
  before_start_.clear();
  for (const double value : values) before_start_.insert(before_start_.end(), linalg::legendre_points, value);
  constexpr double length = 1.0;
  view_.set({-length, 0.0, -length, length, before_start_});
  for (auto& [index, meter] : meters_) meter.before_start(view_);
}

void Measuring::take(const engine::Piece& piece) {
  view_.set(piece);
  for (auto& [index, meter] : meters_) meter.take(view_);
  for (FourierMeter& meter : fourier_) meter.take(view_);
}

void Measuring::impulse(double time, std::span<const double> values) {
  for (auto& [index, meter] : meters_) meter.take_impulse(time, values, view_);
  for (FourierMeter& meter : fourier_) meter.take_impulse(time, values);
}

void Measuring::end_pass(double reached) {
  for (auto& [index, meter] : meters_) {
    meter.finish(reached);
    left_out_[index] = meter.left_out();
    places_[index] = meter.place();
    impulses_[index] = meter.met_impulse() ? 1 : 0;
    settle(index, meter.value(), meter.failure());
  }
  for (const FourierMeter& meter : fourier_) fourier_results_.push_back(meter.finish(reached));
  meters_.clear();
  fourier_.clear();
  evaluate_parameters();
}

Results Measuring::results() const {
  Results results;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    const circuit::Measurement& measurement = measurements_.list[k];
    if (!measurement.shown) continue;
    std::string failure = known_[k] != 0 ? failures_[k] : "the run ended before it was measured";
    results.list.push_back({measurement.name, values_[k], unit_of(measurements_, k), std::move(failure), left_out_[k], measurement.span});
  }
  results.fourier = fourier_results_;
  return results;
}

Diagnostic failure_warning(const Result& result, const std::string& where) {
  return {Severity::warning, "W-measurement-failed", result.span,
          fmt::format("measurement {} failed{}: {}", result.name, where, result.failure)};
}

Diagnostic left_out_warning(const Result& result, const std::string& where) {
  return {Severity::warning, "W-impulse-left-out", result.span,
          fmt::format("measurement {} leaves out{} {}; try a small resistance in the path of the impulse, which gives it a shape",
                      result.name, where, result.left_out)};
}

std::string results_text(const Results& results, int digits) {
  const auto value_text = [&](double value) { return digits == 0 ? fmt::format("{}", value) : fmt::format("{:.{}g}", value, digits); };
  std::string text;
  for (const Result& result : results.list)
    text += fmt::format("{} = {}\n", result.name, result.failure.empty() ? value_text(result.value) : "failed");
  for (const FourierResult& result : results.fourier) text += fourier_text(result);
  return text;
}

}  // namespace pwlsim::measure
