#include "measure/meter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace pwlsim::measure {
namespace {

/// Of the run: what is shorter is rounding of an instant.
constexpr double share_of_stop = 1e-14;
/// A window may reach so much of the run beyond its ends: times that an expression gave are rounded.
constexpr double overhang = 1e-9;
/// What is looked at around an instant, of the run: a derivative needs a piece of some length.
constexpr double surroundings = 1e-3;
/// Of the larger side of a comparison: a difference below it is none.
constexpr double equality = 1e-13;
/// Of a factor of an impulse: it is the same on both sides if it differs by less.
constexpr double steady = 1e-6;
constexpr const char* not_finite = "the expression is not finite everywhere in its window";

std::string too_fast(double from, double to) { return fmt::format("the expression varies too fast from {} s to {} s", from, to); }

circuit::MeasuredExpression difference_of(const circuit::Crossing& crossing) {
  circuit::MeasuredExpression difference = crossing.left;
  difference.steps.insert(difference.steps.end(), crossing.right.steps.begin(), crossing.right.steps.end());
  difference.steps.push_back({.kind = circuit::StepKind::operation, .operation = "-"});
  return difference;
}

std::string_view verb(circuit::Edge edge) {
  return edge == circuit::Edge::rise ? "rises through" : edge == circuit::Edge::fall ? "falls through" : "crosses";
}

std::string times(std::uint64_t count) { return count == 1 ? "once" : fmt::format("{} times", count); }

double largest_of(const double* values) {
  double size = 0.0;
  for (std::size_t i = 0; i < linalg::legendre_points; ++i) size = std::max(size, std::abs(values[i]));
  return size;
}

}  // namespace

Meter::Meter(const circuit::Measurement& measurement, const std::vector<double>& results, double start, double stop, double end)
    : measurement_(measurement),
      results_(results),
      expression_(measurement.expression),
      sliver_(share_of_stop * stop),
      lead_(surroundings * stop) {
  if (measurement.when) {
    const circuit::Crossing& crossing = *measurement.when;
    difference_ = Program(difference_of(crossing));
    left_ = Program(crossing.left);
    right_ = Program(crossing.right);
    watch_.emplace(crossing.edge, crossing.count, crossing.last);
  }
  needs_left_ = integrates() && !expression_.is_linear();
  measurement.at ? set_place(end) : set_window(start, stop, end);
}

void Meter::set_place(double stop) {
  at_ = Program(*measurement_.at).value(results_);
  if (!(at_ >= 0.0 && at_ <= stop * (1.0 + overhang))) return fail(fmt::format("AT = {} s is not within the run, 0 … {} s", at_, stop));
  at_ = std::min(at_, stop);
  from_ = std::max(0.0, at_ - surroundings * stop);
  to_ = std::min(stop, at_ + surroundings * stop);
}

void Meter::set_window(double start, double stop, double end) {
  from_ = measurement_.from ? Program(*measurement_.from).value(results_) : start;
  to_ = measurement_.to ? Program(*measurement_.to).value(results_) : stop;
  if (measurement_.when && measurement_.when->delay) {
    const double delay = Program(*measurement_.when->delay).value(results_);
    from_ = measurement_.from ? std::max(from_, delay) : delay;
  }
  if (!(from_ >= -end * overhang && to_ <= end * (1.0 + overhang)))
    return fail(fmt::format("the window {} s … {} s is not within the run, 0 … {} s", from_, to_, end));
  if (!(from_ < to_)) return fail(fmt::format("the window from {} s to {} s is empty", from_, to_));
  from_ = std::max(from_, 0.0);
  to_ = std::min(to_, end);
}

/// The view holds what was before t = 0.
void Meter::before_start(PieceView& view) {
  if (!watch_ || from_ > 0.0) return;
  watch_->start(view.value(difference_, results_, 0.0), noise_of(view, view.piece().from, view.piece().to));
}

double Meter::noise_of(PieceView& view, double from, double to) {
  linalg::LegendreValues values;
  view.values(left_, results_, from, to, values.data());
  double size = largest_of(values.data());
  view.values(right_, results_, from, to, values.data());
  size = std::max(size, largest_of(values.data()));
  return std::max(equality * size, view.noise_of(difference_, results_, from, to));
}

void Meter::take(PieceView& view) {
  if (needs_left_) note_sizes(view.piece());
  if (instant_) settle_impulses(view);
  if (is_done()) return;
  if (measurement_.at) return take_at(view);
  const double from = std::max(from_, view.piece().from);
  const double to = std::min(to_, view.piece().to);
  if (!(from < to)) return;
  watch_ ? take_when(view, from, to) : take_window(view, from, to);
}

/// Windows take what happens at their begin, not at their end. The factors of an impulse must be the same on both sides of it, so it waits for the
/// piece after it.
void Meter::take_impulse(double time, std::span<const double> values, const PieceView& before) {
  if (is_done() || watch_ || measurement_.at || time < from_ - sliver_ || time >= to_ - sliver_ || !feels(values, time)) return;
  met_impulse_ = true;
  if (!integrates()) return leave_out(time);
  const bool is_linear = expression_.is_linear();
  const auto is_known = [&](int probe) { return std::isfinite(values[static_cast<std::size_t>(probe)]); };
  if (is_linear || !std::all_of(expression_.probes().begin(), expression_.probes().end(), is_known)) {
    const double share = is_linear ? expression_.impulse(values, values, results_, time) : std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(share)) return fail(fmt::format("impulses of higher order act at t = {} s", time));
    sum_ += share;
    return;
  }
  if (!instant_) {
    instant_ = {time, std::vector<double>(values.size(), 0.0), {}};
    if (!before.piece().values.empty() && std::abs(before.piece().to - time) <= sliver_) instant_->left = before.signals(expression_, time);
  }
  for (std::size_t probe = 0; probe < values.size(); ++probe) instant_->impulses[probe] += values[probe];
}

/// Whether it reads an impulse that bears on it: of a minimum of a sum of signals only one downwards does.
bool Meter::feels(std::span<const double> impulses, double time) const {
  const auto& probes = expression_.probes();
  if (std::all_of(probes.begin(), probes.end(), [&](int probe) { return impulses[static_cast<std::size_t>(probe)] == 0.0; })) return false;
  const bool is_minimum = measurement_.kind == Kind::minimum || measurement_.kind == Kind::time_of_minimum;
  const bool is_maximum = measurement_.kind == Kind::maximum || measurement_.kind == Kind::time_of_maximum;
  if (!expression_.is_linear() || !(is_minimum || is_maximum)) return true;
  const double share = expression_.impulse(impulses, impulses, results_, time);
  return is_minimum ? !(share >= 0.0) : !(share <= 0.0);
}

void Meter::note_sizes(const engine::Piece& piece) {
  sizes_.resize(piece.values.size() / linalg::legendre_points, 0.0);
  for (const int probe : expression_.probes()) {
    double& size = sizes_[static_cast<std::size_t>(probe)];
    size = std::max(size, largest_of(piece.values.data() + static_cast<std::size_t>(probe) * linalg::legendre_points));
  }
}

void Meter::settle_impulses(const PieceView& after) {
  const Instant instant = std::move(*instant_);
  instant_.reset();
  if (instant.left.empty() || !expression_.is_affine_in(instant.impulses)) return leave_out(instant.time);
  const double left = expression_.impulse(instant.impulses, instant.left, results_, instant.time);
  const double right = expression_.impulse(instant.impulses, after.signals(expression_, instant.time), results_, instant.time);
  const double rounding = equality * std::abs(expression_.impulse(instant.impulses, sizes_, results_, instant.time));
  if (!(std::abs(right - left) <= std::max(steady * std::max(std::abs(left), std::abs(right)), rounding))) return leave_out(instant.time);
  sum_ += right;
}

void Meter::leave_out(double time) {
  if (left_out_ == 0) first_left_out_ = time;
  if (left_out_ == 0 || time > last_left_out_ + sliver_) ++left_out_;
  last_left_out_ = time;
}

std::string Meter::left_out() const {
  if (left_out_ == 0 || !failure_.empty()) return "";
  const bool is_one = left_out_ == 1;
  const std::string what = is_one ? fmt::format("the impulse at t = {} s", first_left_out_)
                                  : fmt::format("impulses at {} instants, first at t = {} s", left_out_, first_left_out_);
  if (integrates()) return fmt::format("{}: {} has no integral over {}", what, measurement_.expression.text, is_one ? "it" : "them");
  if (measurement_.kind == Kind::rms) return fmt::format("{}: {} no integral", what, is_one ? "its square has" : "their squares have");
  return fmt::format("{}: {} infinite", what, is_one ? "it is" : "they are");
}

/// The value on the right of an instant counts; at the end of the run that on its left.
void Meter::take_at(PieceView& view) {
  if (view.piece().from > at_ + sliver_ || view.piece().to < at_ - sliver_) return;
  read_at(view, std::clamp(at_, view.piece().from, view.piece().to));
}

void Meter::read_at(PieceView& view, double time) {
  found_ = true;
  found_at_ = time;
  found_in_from_ = view.piece().from;
  found_in_to_ = view.piece().to;
  if (measurement_.kind == Kind::time) {
    value_ = time;
  } else if (measurement_.kind == Kind::value) {
    value_ = view.value(expression_, results_, time);
  } else {
    const double end = view.piece().begin + view.piece().length;
    const bool resolved = view.resolve(expression_, results_, view.piece().begin, end, scale_, [&](const PolynomialPart& part) {
      if (time < part.from || (time >= part.to && part.to < end)) return;
      value_ = part.series.derivative()(std::clamp(part.place(time), -1.0, 1.0)) * 2.0 / part.length();
    });
    if (!resolved) fail(too_fast(view.piece().begin, end));
  }
}

void Meter::take_when(PieceView& view, double from, double to) {
  const double noise = noise_of(view, from, to);
  const bool resolved = view.resolve(difference_, results_, from, to, scale_, [&](const PolynomialPart& part) {
    const bool is_done = found_ && !measurement_.when->last;
    if (is_done || !is_finite(part)) return;
    scale_ = std::max(scale_, largest_of(part.values.data()));
    watch_->take(part, noise, [&](double time) { read_at(view, view.refined_zero(difference_, results_, part, time, noise)); });
  });
  if (resolved && to >= to_ && !watch_->is_done())
    watch_->finish(view.value(difference_, results_, to), noise, to, [&](double time) { read_at(view, time); });
  if (!resolved && failure_.empty()) fail(too_fast(from, to));
}

void Meter::take_window(PieceView& view, double from, double to) {
  const auto take = [&](const PolynomialPart& part) {
    if (!is_finite(part)) return;
    scale_ = std::max(scale_, largest_of(part.values.data()));
    add(part);
  };
  const bool resolved = view.resolve(expression_, results_, from, to, scale_, take, integrates());
  if (!resolved && failure_.empty()) fail(too_fast(from, to));
}

/// False, and failed, where the expression has no value.
bool Meter::is_finite(const PolynomialPart& part) {
  if (std::all_of(part.values.begin(), part.values.end(), [](double value) { return std::isfinite(value); })) return true;
  fail(not_finite);
  return false;
}

void Meter::add(const PolynomialPart& part) {
  switch (measurement_.kind) {
    case Kind::average:
    case Kind::integral:
      sum_ += static_cast<long double>(part.length()) * part.series.mean();
      break;
    case Kind::rms: {
      const auto& weight = linalg::gauss_legendre().weight;
      double sum = 0.0;
      for (std::size_t i = 0; i < part.values.size(); ++i) sum += weight[i] * part.values[i] * part.values[i];
      sum_ += 0.5L * static_cast<long double>(part.length()) * sum;
      break;
    }
    default:
      add_extremes(part);
      break;
  }
  any_ = true;
}

void Meter::add_extremes(const PolynomialPart& part) {
  const double size = part.series.variation();
  const bool is_sliver = part.length() <= sliver_;
  if (is_sliver && any_ && !only_slivers_) return;
  // What a window that begins a rounding before a jump has of before it.
  if (only_slivers_ && !is_sliver) any_ = false;
  only_slivers_ = is_sliver && (!any_ || only_slivers_);
  if (any_ && (part.series.mean() - size >= least_ && part.series.mean() + size <= largest_)) return;
  const linalg::Extremes found = linalg::extremes(part.series);
  if (!any_ || found.least < least_) least_ = found.least, least_at_ = part.time(found.least_at);
  if (!any_ || found.largest > largest_) largest_ = found.largest, largest_at_ = part.time(found.largest_at);
}

void Meter::finish(double reached) {
  if (!failure_.empty()) return;
  const bool is_short = reached < to_ - sliver_;
  if (watch_ || measurement_.at) {
    if (found_ && !(is_short && watch_ && measurement_.when->last)) return;
    if (is_short) return fail(fmt::format("the run ended at t = {} s", reached));
    const circuit::Crossing& crossing = *measurement_.when;
    return fail(fmt::format("{} {} {} {} from {} s to {} s{}", crossing.left.text, verb(crossing.edge), crossing.right.text,
                            watch_->seen() == 0 ? "at no time" : times(watch_->seen()), from_, to_,
                            crossing.count > 1 ? fmt::format(", not {} times", crossing.count) : ""));
  }
  if (is_short) return fail(fmt::format("the run ended at t = {} s, before the end of its window at {} s", reached, to_));
  const auto length = static_cast<long double>(to_) - from_;
  switch (measurement_.kind) {
    case Kind::average:
      value_ = static_cast<double>(sum_ / length);
      break;
    case Kind::integral:
      value_ = static_cast<double>(sum_);
      break;
    case Kind::rms:
      value_ = static_cast<double>(std::sqrt(sum_ / length));
      break;
    case Kind::minimum:
      value_ = least_;
      break;
    case Kind::maximum:
      value_ = largest_;
      break;
    case Kind::peak_to_peak:
      value_ = largest_ - least_;
      break;
    case Kind::time_of_minimum:
      value_ = least_at_;
      break;
    default:
      value_ = largest_at_;
      break;
  }
  if (!std::isfinite(value_)) fail(not_finite);
}

}  // namespace pwlsim::measure
