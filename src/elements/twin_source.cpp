/// Waveforms as stock ngspice reads them: true jumps become short ramps, numbers of cycles and repetitions are written out.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "elements/twin.hpp"

namespace pwlsim::elements {
namespace {

constexpr double edge_scale =
    1e-3;  // of the shortest piece, times the square root of the sharpness: still steeper ones make ngspice lose its step
constexpr double never = 1e12;                // s; ngspice reads 0 as "omitted"
constexpr std::size_t most_points = 200'000;  // of a waveform written out

using PwlPoints = std::vector<model::Pwl::Point>;

/// Pieces at rounding level do not count.
double shortest_piece(const PwlPoints& points) {
  constexpr double rounding = 1e-12;
  const double least = rounding * std::max(std::abs(points.front().time), std::abs(points.back().time));
  double shortest = infinite;
  for (std::size_t k = 1; k < points.size(); ++k)
    if (const double length = points[k].time - points[k - 1].time; length > least) shortest = std::min(shortest, length);
  return std::isinf(shortest) ? 1.0 : shortest;
}

std::string points_text(const PwlPoints& points) {
  std::string text = "PWL(";
  for (std::size_t k = 0; k < points.size(); ++k) text += fmt::format("{}{} {}", k == 0 ? "" : " ", points[k].time, points[k].value);
  return text + ")";
}

/// Jumps become ramps of length `edge`; several at one instant become one.
PwlPoints ramped(const PwlPoints& points, double edge) {
  const double same_instant = edge_scale * edge;
  PwlPoints result;
  for (const model::Pwl::Point& point : points) {
    if (result.size() > 1 && result.back().time >= point.time && result.back().time == result[result.size() - 2].time + edge) {
      result.back().value = point.value;
    } else if (!result.empty() && point.time <= result.back().time + same_instant) {
      if (point.value != result.back().value) result.push_back({result.back().time + edge, point.value});
    } else {
      result.push_back(point);
    }
  }
  return result;
}

double value_at(const PwlPoints& points, double time) {
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (points[k].time < time || points[k].time == points[k - 1].time) continue;
    const double part = (time - points[k - 1].time) / (points[k].time - points[k - 1].time);
    return points[k - 1].value + std::clamp(part, 0.0, 1.0) * (points[k].value - points[k - 1].value);
  }
  return points.back().value;
}

/// The repetitions up to `stop` one after the other. Empty where they are too many.
PwlPoints written_out(const model::Pwl& pwl, double stop) {
  PwlPoints points = pwl.points;
  const double length = points.back().time - pwl.repeat_from;
  if (pwl.repeats == 0.0 || length <= 0.0) return points;
  PwlPoints block{{pwl.repeat_from, value_at(points, pwl.repeat_from)}};
  for (const auto& point : points)
    if (point.time > pwl.repeat_from) block.push_back(point);
  for (double pass = 1.0; pass <= pwl.repeats && points.back().time <= stop; pass += 1.0) {
    if (points.size() > most_points) return {};
    for (const auto& point : block) points.push_back({point.time + pass * length, point.value});
  }
  return points;
}

class SourceText {
 public:
  explicit SourceText(Twin& twin) : twin_(twin) {}

  std::string operator()(const model::Dc& dc) const { return fmt::format("DC {}", dc.value); }

  std::string operator()(const model::Held& held) const { return fmt::format("DC {}", held.value); }

  std::string operator()(const model::SmallInput&) const { return "DC 0"; }

  std::string operator()(const model::Sin& sin) const {
    if (sin.frequency == 0.0) return decay(sin);
    if (!std::isinf(sin.cycles)) return burst(sin);
    return fmt::format("SIN({} {} {} {} {} {})", sin.offset, sin.amplitude, sin.frequency, sin.delay, sin.damping,
                       sin.phase * (180.0 / std::numbers::pi));
  }

  std::string operator()(const model::Pulse& pulse) const {
    if (!std::isinf(pulse.cycles)) return (*this)(as_points(pulse));
    if (twin_.settings().use_initial_conditions && pulse.delay == 0.0 && pulse.rise == 0.0 && pulse.width > 0.0)
      return text_of(behind_first_edge(pulse));
    return text_of(pulse);
  }

  std::string operator()(const model::Pwl& pwl) const {
    PwlPoints points = written_out(pwl, twin_.settings().stop);
    if (points.empty()) {
      twin_.refuse(fmt::format("its waveform has more than {} points when written out", most_points));
      return "DC 0";
    }
    if (twin_.settings().use_initial_conditions)
      while (points.size() > 1 && points[1].time == 0.0) points.erase(points.begin());
    return points_text(ramped(points, edge_scale * std::sqrt(twin_.sharpness()) * shortest_piece(points)));
  }

  std::string operator()(const model::Exp& exp) const {
    const double fall = std::isinf(exp.td2) ? never : exp.td2;
    return fmt::format("EXP({} {} {} {} {} {})", exp.v1, exp.v2, exp.td1, exp.tau1, fall, exp.tau2);
  }

 private:
  /// The same waveform from its first plateau on: a pulse from V2 down to V1.
  static model::Pulse behind_first_edge(const model::Pulse& pulse) {
    model::Pulse rest;
    rest.initial = pulse.pulsed;
    rest.pulsed = pulse.initial;
    rest.delay = pulse.width;
    rest.rise = pulse.fall;
    rest.period = pulse.period;
    if (!std::isinf(pulse.period)) rest.width = std::max(0.0, pulse.period - pulse.width - pulse.fall);
    return rest;
  }

  std::string text_of(const model::Pulse& pulse) const {
    if (std::isinf(pulse.delay)) return fmt::format("DC {}", pulse.initial);
    const double end = pulse.rise + pulse.width + pulse.fall;
    const double gap = std::isinf(pulse.period) ? infinite : pulse.period - end;
    const double edge = edge_of({pulse.rise, pulse.width, pulse.fall, gap, twin_.settings().stop});
    const double rise = pulse.rise == 0.0 ? edge : pulse.rise, fall = pulse.fall == 0.0 ? edge : pulse.fall;
    double width = std::isinf(pulse.width) ? never : pulse.width;
    if (pulse.rise == 0.0) width -= edge;
    if (pulse.fall == 0.0 && gap < edge) width -= edge;
    const double period = std::isinf(pulse.period) ? 2.0 * never : pulse.period;
    return fmt::format("PULSE({} {} {} {} {} {} {})", pulse.initial, pulse.pulsed, pulse.delay, rise, fall,
                       std::max(width, edge * edge_scale), period);
  }

  double edge_of(std::initializer_list<double> pieces) const {
    double shortest = infinite;
    for (double piece : pieces)
      if (piece > 0.0) shortest = std::min(shortest, piece);
    return edge_scale * std::sqrt(twin_.sharpness()) * (std::isinf(shortest) ? 1.0 : shortest);
  }

  /// Of frequency 0: offset + amplitude·sin(phase)·exp(−damping·(t − delay)).
  std::string decay(const model::Sin& sin) const {
    const double height = sin.amplitude * std::sin(sin.phase);
    if (sin.damping == 0.0) return fmt::format("DC {}", sin.offset + height);
    return fmt::format("EXP({} {} {} {} {} 1)", sin.offset + height, sin.offset, sin.delay, 1.0 / sin.damping, never);
  }

  /// A number of cycles: the sine of a B source that a gate of time lets through.
  std::string burst(const model::Sin& sin) const {
    const double end = sin.delay + sin.cycles / sin.frequency, rest = sin.offset + sin.amplitude * std::sin(sin.phase);
    const std::string t = fmt::format("(time-{})", sin.delay);
    const std::string decay = sin.damping == 0.0 ? "" : fmt::format("*exp(-({})*{})", sin.damping, t);
    return fmt::format("=time<{} ? {} : (time>{} ? {} : {}+({}){}*sin({}*{}+({})))", sin.delay, rest, end, rest, sin.offset, sin.amplitude,
                       decay, 2.0 * std::numbers::pi * sin.frequency, t, sin.phase);
  }

  static model::Pwl as_points(const model::Pulse& pulse) {
    model::Pwl pwl;
    pwl.points.push_back({0.0, pulse.initial});
    const double width = std::isinf(pulse.width) ? never : pulse.width;
    for (double n = 0.0; n < pulse.cycles && pwl.points.size() <= most_points; n += 1.0) {
      const double start = pulse.delay + (n == 0.0 ? 0.0 : n * pulse.period);
      pwl.points.push_back({start, pulse.initial});
      const double next = start + pulse.period;
      append(pwl, {start + pulse.rise, pulse.pulsed}, next);
      append(pwl, {start + pulse.rise + width, pulse.pulsed}, next);
      append(pwl, {start + pulse.rise + width + pulse.fall, pulse.initial}, next);
    }
    if (pwl.points.back().value != pulse.initial) pwl.points.push_back({pwl.points.back().time, pulse.initial});
    return pwl;
  }

  /// Up to `end`, where a pulse that is longer than its period is cut.
  static void append(model::Pwl& pwl, model::Pwl::Point point, double end) {
    const model::Pwl::Point last = pwl.points.back();
    if (last.time >= end && point.time > end) return;
    if (point.time > end) point = {end, last.value + (point.value - last.value) * (end - last.time) / (point.time - last.time)};
    pwl.points.push_back(point);
  }

  Twin& twin_;
};

}  // namespace

void Twin::source(std::string_view part, const TwinEnds& ends, bool is_current, const model::SourceFunction& function) {
  const std::string text = std::visit(SourceText(*this), function);
  if (text[0] == '=') return behaviour(part, ends, is_current, std::string_view(text).substr(1));
  line(fmt::format("{} {} {} {}", device(is_current ? 'I' : 'V', part), ends.p, ends.n, text));
}

}  // namespace pwlsim::elements
