#include "steady/wave.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace pwlsim::steady {
namespace {

using model::forever;

/// value + slope·(t − at)
struct Line {
  double at = 0.0, value = 0.0, slope = 0.0;
  [[nodiscard]] double operator()(double t) const { return value + slope * (t - at); }
};

double number(double x) { return std::isfinite(x) ? x : 0.0; }

/// Where in its cycles a pulse is.
struct Place {
  bool is_before = false;           ///< of the first
  double cycle = 0.0, since = 0.0;  ///< s since the cycle's begin
};

Place place_of(const model::Pulse& f, double time, bool is_settled) {
  Place place;
  const bool repeats = f.period < forever && f.period > 0.0;
  place.cycle = repeats ? std::floor((time - f.delay) / f.period) : 0.0;
  if (!is_settled) {
    place.is_before = time < f.delay;
    place.cycle = std::max(0.0, place.cycle);
    if (f.cycles < forever) place.cycle = std::min(place.cycle, f.cycles - 1.0);
  }
  place.since = time - f.delay - (repeats ? place.cycle * f.period : 0.0);
  return place;
}

double cycle_shift(const model::Pulse& d, const Place& place) {
  return d.delay + (place.cycle != 0.0 ? place.cycle * number(d.period) : 0.0);
}

/// Of a ramp from `low` to `high` that begins at 0 and lasts `length`, `since` after its begin; `p` are derivatives.
Line ramp(double time, double since, double low, double high, double length, double low_p, double high_p, double length_p, double shift) {
  const double share = since / length, rate = (high - low) / length;
  const double share_rate_p = (high_p - low_p) / length - rate * length_p / length;
  return {time, low_p + (high_p - low_p) * share - rate * shift - rate * length_p * share, share_rate_p};
}

Line line_of(const model::Pulse& f, const model::Pulse& d, double inside, bool is_settled) {
  const Place place = place_of(f, inside, is_settled);
  if (place.is_before) return {inside, d.initial, 0.0};
  const double shift = cycle_shift(d, place);
  const double top = f.rise, fall = f.rise + f.width, end = fall + f.fall;
  if (place.since < top) return ramp(inside, place.since, f.initial, f.pulsed, f.rise, d.initial, d.pulsed, d.rise, shift);
  if (place.since < fall) return {inside, d.pulsed, 0.0};
  if (place.since >= end) return {inside, d.initial, 0.0};
  return ramp(inside, place.since - fall, f.pulsed, f.initial, f.fall, d.pulsed, d.initial, d.fall,
              shift + number(d.rise) + number(d.width));
}

/// Index of the point behind which `time` lies, and the time within the points; −1: before all of them.
std::pair<std::ptrdiff_t, double> pwl_place(const model::Pwl& f, double time, double& cycle) {
  const double length = f.points.back().time - f.repeat_from;
  cycle = 0.0;
  if (f.repeats > 0.0 && length > 0.0 && time > f.points.back().time) {
    cycle = std::min(std::floor((time - f.repeat_from) / length), f.repeats);
    time -= cycle * length;
  }
  const auto behind =
      std::upper_bound(f.points.begin(), f.points.end(), time, [](double t, const model::Pwl::Point& p) { return t < p.time; });
  return {behind - f.points.begin() - 1, time};
}

double pwl_length_p(const model::Pwl& d) { return d.points.back().time - d.repeat_from; }

Line line_of(const model::Pwl& f, const model::Pwl& d, double inside, bool is_settled) {
  if (f.points.empty()) return {};
  const double length = f.points.back().time - f.repeat_from;
  const bool is_first = is_settled && length > 0.0 && f.repeats == forever && inside < f.points.back().time;
  double cycle = 0.0;
  const auto [at, time] = pwl_place(f, is_first ? inside + length : inside, cycle);
  if (is_first) cycle -= 1.0;
  if (at < 0) return {inside, d.points.front().value, 0.0};
  const auto k = static_cast<std::size_t>(at);
  if (k + 1 >= f.points.size()) return {inside, d.points.back().value, 0.0};
  const model::Pwl::Point &a = f.points[k], &b = f.points[k + 1], &ap = d.points[k], &bp = d.points[k + 1];
  const double shift = ap.time + cycle * pwl_length_p(d);
  return ramp(inside, time - a.time, a.value, b.value, b.time - a.time, ap.value, bp.value, bp.time - ap.time, shift);
}

Line line_of(const Wave& wave, double inside, bool is_settled) {
  if (const auto* d = std::get_if<model::Dc>(&wave.derivative)) return {inside, d->value, 0.0};
  if (const auto* d = std::get_if<model::Pulse>(&wave.derivative))
    return line_of(std::get<model::Pulse>(wave.function), *d, inside, is_settled);
  if (const auto* d = std::get_if<model::Pwl>(&wave.derivative))
    return line_of(std::get<model::Pwl>(wave.function), *d, inside, is_settled);
  return {};
}

bool is_sine(const Wave& wave) { return std::holds_alternative<model::Sin>(wave.derivative); }

/// How the part of a pulse that begins `begin` after the cycle's begin moves, where it lies at `time`; `moved`: of `begin`.
std::optional<double> part_shift(const model::Pulse& f, const model::Pulse& d, double begin, double moved, double time, double near,
                                 bool is_settled) {
  if (!(begin < forever)) return std::nullopt;
  // The cycle whose part is nearest.
  const Place place = place_of(f, time - begin + near, is_settled);
  if (place.is_before || std::abs(place.since - near) > near) return std::nullopt;
  return cycle_shift(d, place) + moved;
}

std::optional<double> edge_shift(const model::Pulse& f, const model::Pulse& d, double time, double near, bool is_settled) {
  if (f.initial == f.pulsed) return std::nullopt;
  if (f.rise == 0.0)
    if (const auto shift = part_shift(f, d, 0.0, 0.0, time, near, is_settled)) return shift;
  if (f.fall == 0.0) return part_shift(f, d, f.rise + f.width, number(d.rise) + number(d.width), time, near, is_settled);
  return std::nullopt;
}

std::optional<double> corner_shift(const model::Pulse& f, const model::Pulse& d, double time, double near, bool is_settled) {
  if (f.initial == f.pulsed) return std::nullopt;
  double begin = 0.0, moved = 0.0;
  std::optional<double> shift;
  const auto take = [&](double length, double length_p, bool is_ramp) {
    if (is_ramp)
      for (const auto& [at, by] : {std::pair(begin, moved), std::pair(begin + length, moved + number(length_p))})
        if (!shift) shift = part_shift(f, d, at, by, time, near, is_settled);
    begin += length;
    moved += number(length_p);
  };
  take(f.rise, d.rise, f.rise > 0.0);
  take(f.width, d.width, false);
  take(f.fall, d.fall, f.fall > 0.0);
  return shift;
}

/// A point within `near` of the time, in a certain cycle.
struct PwlPoint {
  std::size_t index = 0;
  double cycle = 0.0;
  bool wraps = false;  ///< the last point of the cycle before lies there, too
};

std::optional<PwlPoint> pwl_point_at(const model::Pwl& f, double time, double near, bool is_settled) {
  if (f.points.empty()) return std::nullopt;
  const double length = f.points.back().time - f.repeat_from;
  const bool is_first = is_settled && length > 0.0 && f.repeats == forever && time < f.points.back().time;
  double cycle = 0.0;
  const auto [at, own] = pwl_place(f, (is_first ? time + length : time) + near, cycle);
  if (at < 0 || std::abs(f.points[static_cast<std::size_t>(at)].time - own + near) > near) return std::nullopt;
  const auto k = static_cast<std::size_t>(at);
  return PwlPoint{k, is_first ? cycle - 1.0 : cycle, cycle > 0.0 && f.points[k].time == f.repeat_from};
}

std::optional<double> corner_shift(const model::Pwl& f, const model::Pwl& d, double time, double near, bool is_settled) {
  const auto point = pwl_point_at(f, time, near, is_settled);
  if (!point) return std::nullopt;
  const auto [k, cycle, wraps] = *point;
  const auto slope_behind = [&](std::size_t first) {
    const model::Pwl::Point &a = f.points[first], &b = f.points[first + 1];
    return b.time > a.time ? (b.value - a.value) / (b.time - a.time) : 0.0;
  };
  const std::size_t last = f.points.size() - 1;
  const double left = wraps ? slope_behind(last - 1) : k > 0 ? slope_behind(k - 1) : 0.0;
  const double right = k < last ? slope_behind(k) : 0.0;
  if (left == right) return std::nullopt;
  return d.points[k].time + cycle * pwl_length_p(d);
}

std::optional<double> edge_shift(const model::Pwl& f, const model::Pwl& d, double time, double near, bool is_settled) {
  const auto point = pwl_point_at(f, time, near, is_settled);
  if (!point) return std::nullopt;
  const auto [k, cycle, wraps] = *point;
  const double left = k > 0 ? f.points[k - 1].time == f.points[k].time ? f.points[k - 1].value : f.points[k].value : f.points[k].value;
  if (left == f.points[k].value && !(wraps && f.points.back().value != f.points[k].value)) return std::nullopt;
  return d.points[k].time + cycle * pwl_length_p(d);
}

}  // namespace

int wave_size(const Wave& wave) { return is_sine(wave) ? 6 : 2; }

Matrix wave_generator(const Wave& wave) {
  Matrix g = Matrix::Zero(wave_size(wave), wave_size(wave));
  if (!is_sine(wave)) {
    g(0, 1) = 1.0;
    return g;
  }
  const auto& f = std::get<model::Sin>(wave.function);
  const double omega = 2.0 * std::numbers::pi * f.frequency;
  for (const int k : {0, 2}) {
    g(k, k) = g(k + 1, k + 1) = -f.damping;
    g(k, k + 1) = omega;
    g(k + 1, k) = -omega;
  }
  g(2, 0) = g(3, 1) = 1.0;
  return g;
}

Eigen::RowVectorXd wave_row(const Wave& wave) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(wave_size(wave));
  if (!is_sine(wave)) {
    row[0] = 1.0;
    return row;
  }
  const auto& f = std::get<model::Sin>(wave.function);
  const auto& d = std::get<model::Sin>(wave.derivative);
  const double omega = 2.0 * std::numbers::pi * f.frequency, omega_p = 2.0 * std::numbers::pi * d.frequency;
  row << d.amplitude + f.amplitude * f.damping * d.delay, f.amplitude * (d.phase - omega * d.delay), -f.amplitude * d.damping,
      f.amplitude * omega_p, d.offset, 1.0;
  return row;
}

Vector wave_state(const Wave& wave, double time, double inside, bool is_settled) {
  Vector z = Vector::Zero(wave_size(wave));
  if (!is_sine(wave)) {
    const Line line = line_of(wave, inside, is_settled);
    z << line(time), line.slope;
    return z;
  }
  const auto& f = std::get<model::Sin>(wave.function);
  const auto& d = std::get<model::Sin>(wave.derivative);
  const bool has_ended = f.cycles < forever && f.frequency > 0.0 && inside >= f.delay + f.cycles / f.frequency;
  if (!is_settled && (inside < f.delay || has_ended)) {
    z[5] = d.offset + d.amplitude * std::sin(f.phase) + f.amplitude * std::cos(f.phase) * d.phase;
    return z;
  }
  const double since = time - f.delay, angle = 2.0 * std::numbers::pi * f.frequency * since + f.phase, decay = std::exp(-f.damping * since);
  z << decay * std::sin(angle), decay * std::cos(angle), since * decay * std::sin(angle), since * decay * std::cos(angle), 1.0, 0.0;
  return z;
}

std::optional<double> edge_shift(const Wave& wave, double time, double near, bool is_settled) {
  if (const auto* d = std::get_if<model::Pulse>(&wave.derivative))
    return edge_shift(std::get<model::Pulse>(wave.function), *d, time, near, is_settled);
  if (const auto* d = std::get_if<model::Pwl>(&wave.derivative))
    return edge_shift(std::get<model::Pwl>(wave.function), *d, time, near, is_settled);
  return std::nullopt;
}

std::optional<double> corner_shift(const Wave& wave, double time, double near, bool is_settled) {
  if (const auto* d = std::get_if<model::Pulse>(&wave.derivative))
    return corner_shift(std::get<model::Pulse>(wave.function), *d, time, near, is_settled);
  if (const auto* d = std::get_if<model::Pwl>(&wave.derivative))
    return corner_shift(std::get<model::Pwl>(wave.function), *d, time, near, is_settled);
  return std::nullopt;
}

double period_share(const Wave& wave) {
  if (const auto* d = std::get_if<model::Pulse>(&wave.derivative)) {
    const double period = std::get<model::Pulse>(wave.function).period;
    return period < forever ? number(d->period) / period : 0.0;
  }
  if (const auto* d = std::get_if<model::Sin>(&wave.derivative)) {
    const double frequency = std::get<model::Sin>(wave.function).frequency;
    return frequency != 0.0 ? -d->frequency / frequency : 0.0;
  }
  if (const auto* d = std::get_if<model::Pwl>(&wave.derivative)) {
    const auto& f = std::get<model::Pwl>(wave.function);
    return f.repeats > 0.0 && !f.points.empty() ? pwl_length_p(*d) / (f.points.back().time - f.repeat_from) : 0.0;
  }
  return 0.0;
}

std::optional<double> last_value_derivative(const Wave& wave) {
  if (const auto* d = std::get_if<model::Pulse>(&wave.derivative)) {
    const auto& f = std::get<model::Pulse>(wave.function);
    return f.width < forever || (f.period < forever && f.cycles < forever) ? d->initial : d->pulsed;
  }
  if (const auto* d = std::get_if<model::Pwl>(&wave.derivative)) return d->points.empty() ? 0.0 : d->points.back().value;
  if (const auto* d = std::get_if<model::Sin>(&wave.derivative)) {
    const auto& f = std::get<model::Sin>(wave.function);
    const bool has_decayed = f.damping > 0.0 && f.cycles == forever;
    return d->offset + (has_decayed ? 0.0 : d->amplitude * std::sin(f.phase) + f.amplitude * std::cos(f.phase) * d->phase);
  }
  return std::nullopt;
}

std::string wave_failure(const Wave& wave) {
  if (std::holds_alternative<model::Exp>(wave.derivative)) return "numbers of an EXP waveform have no derivative here";
  if (wave.function.index() != wave.derivative.index()) return "the waveform has no derivative here";
  if (const auto* sine = std::get_if<model::Sin>(&wave.function)) {
    const auto& d = std::get<model::Sin>(wave.derivative);
    if (sine->cycles < forever && (d.frequency != 0.0 || d.delay != 0.0))
      return "a SIN waveform that ends has no derivative to its times here";
  }
  return "";
}

}  // namespace pwlsim::steady
