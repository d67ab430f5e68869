#include <algorithm>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "model/exosystem.hpp"

namespace pwlsim::model {

namespace {

/// Segments between corner points; a later point at the same time wins (a true jump). Segments that continue the one before are dropped.
std::vector<Track::Segment> segments_of(const std::vector<Pwl::Point>& points) {
  std::vector<Track::Segment> segments;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    const double length = last ? 0.0 : points[i + 1].time - points[i].time;
    if (!last && !(length > 0.0)) continue;
    const double slope = last ? 0.0 : (points[i + 1].value - points[i].value) / length;
    segments.push_back({points[i].time, points[i].value, slope});
  }
  return segments;
}

double value_at(const std::vector<Pwl::Point>& points, double time) {
  std::size_t i = points.size();
  while (i > 0 && points[i - 1].time > time) --i;
  if (i == 0) return points.front().value;
  if (i == points.size()) return points.back().value;
  const auto& a = points[i - 1];
  const auto& b = points[i];
  return a.value + (b.value - a.value) * (time - a.time) / (b.time - a.time);
}

}  // namespace

double Track::largest_slope() const {
  double largest = 0.0;
  for (const auto& segment : prefix) largest = std::max(largest, std::abs(segment.slope));
  for (const auto& segment : loop) largest = std::max(largest, std::abs(segment.slope));
  return largest;
}

double Track::largest_value() const {
  double largest = std::abs(initial);
  for (const auto& segment : prefix) largest = std::max(largest, std::abs(segment.value));
  for (const auto& segment : loop) largest = std::max(largest, std::abs(segment.value));
  return largest;
}

void Track::set_next(Cursor& cursor) const {
  cursor.next_late = 0.0;
  if (cursor.item < prefix.size()) {
    cursor.next = prefix[cursor.item].start;
    return;
  }
  const std::size_t item = cursor.item - prefix.size();
  if (loop.empty() || cursor.period_index > loop_count) {
    cursor.next = forever;
    return;
  }
  // Never accumulated: edge n stands at start + n·period + offset. After the last period one more edge ends the loop.
  const double periods = cursor.period_index > 0.0 ? cursor.period_index * loop_period : 0.0;
  const double base = loop_start + periods;
  const double offset = cursor.period_index < loop_count ? loop[item].start : 0.0;
  cursor.next = base + offset;
  if (periods > 0.0)
    cursor.next_late =
        std::fma(cursor.period_index, loop_period, -periods) + rounding_of_sum(loop_start, periods) + rounding_of_sum(base, offset);
}

/// Behind a segment of the loop.
void Track::count_segment(Cursor& cursor) const {
  if (++cursor.item < prefix.size() + loop.size()) return;
  cursor.item = prefix.size();
  cursor.period_index += 1.0;
  if (!(loop_period < forever)) cursor.period_index = forever;
}

void Track::pass_in_loop(Cursor& cursor, int corners) const {
  for (int i = 1; i < corners; ++i) count_segment(cursor);
  set_next(cursor);
  begin_segment(cursor);
}

void Track::advance(Cursor& cursor) const {
  begin_segment(cursor);
  set_next(cursor);
}

/// At the cursor's `next`.
void Track::begin_segment(Cursor& cursor) const {
  cursor.start = cursor.next;
  cursor.start_late = cursor.next_late;
  if (cursor.item < prefix.size()) {
    const Segment& segment = prefix[cursor.item++];
    cursor.value = segment.value;
    cursor.slope = segment.slope;
  } else if (cursor.period_index >= loop_count) {
    cursor.value = after_loop;
    cursor.slope = 0.0;
    cursor.period_index += 1.0;
  } else {
    const Segment& segment = loop[cursor.item - prefix.size()];
    cursor.value = segment.value;
    cursor.slope = segment.slope;
    count_segment(cursor);
  }
}

bool Track::pass(Cursor& cursor, double time, double tolerance) const {
  const Cursor before = cursor;
  do advance(cursor);
  while (cursor.next <= time + tolerance);
  const double jump = std::abs(cursor.value - before.at(before.next));
  return jump > 0.0 && jump > before.rounding_at(before.next) + std::abs(cursor.slope) * tolerance;
}

Track::Cursor Track::before(double time) const {
  Cursor cursor;
  cursor.start = time;
  cursor.value = initial;
  set_next(cursor);
  while (cursor.next < time) {
    const bool in_loop = cursor.item >= prefix.size();
    const double behind = in_loop ? std::floor((time - loop_start) / loop_period) - 1.0 : 0.0;
    if (in_loop && behind > cursor.period_index && behind < loop_count) {  // a long negative delay: skip whole periods
      cursor.period_index = behind;
      cursor.item = prefix.size();
      set_next(cursor);
    }
    advance(cursor);
  }
  return cursor;
}

bool Track::is_continuous() const {
  Cursor cursor = before(0.0);
  for (std::size_t left = prefix.size() + 2 * loop.size() + 1; left > 0 && cursor.next < forever; --left) {
    const double end = cursor.at(cursor.next);
    const double rounding = cursor.rounding_at(cursor.next);
    advance(cursor);
    if (std::abs(cursor.value - end) > rounding) return false;
  }
  if (loop.empty() || loop_count == forever) return true;
  const Segment& last = loop.back();
  const Cursor behind{.start = last.start, .value = last.value, .slope = last.slope};
  return std::abs(behind.at(loop_period) - after_loop) <= behind.rounding_at(loop_period);
}

double Track::Cursor::rounding_at(double time) const {
  return 4.0 * std::numeric_limits<double>::epsilon() * (std::abs(slope) * (std::abs(time) + std::abs(start)) + std::abs(at(time)));
}

Track make_track(const Pulse& pulse) {
  std::vector<Pwl::Point> points{{0.0, pulse.initial}, {pulse.rise, pulse.pulsed}};
  if (pulse.width < forever) {
    points.push_back({pulse.rise + pulse.width, pulse.pulsed});
    points.push_back({pulse.rise + pulse.width + pulse.fall, pulse.initial});
  }
  Track track;
  track.initial = pulse.initial;
  track.loop = segments_of(points);
  track.loop_start = pulse.delay;
  const bool repeats = pulse.period > 0.0 && pulse.period < forever;
  track.loop_period = repeats ? pulse.period : forever;
  track.loop_count = repeats ? pulse.cycles : 1.0;
  track.after_loop = repeats && pulse.cycles < forever ? pulse.initial : track.loop.back().value;
  if (repeats) std::erase_if(track.loop, [&](const auto& s) { return s.start >= pulse.period; });
  return track;
}

Track make_track(const Pwl& pwl) {
  Track track;
  if (pwl.points.empty()) return track;
  track.initial = pwl.points.front().value;
  track.prefix = segments_of(pwl.points);
  const double end = pwl.points.back().time;
  if (!(pwl.repeats > 0.0) || !(end > pwl.repeat_from)) return track;
  track.prefix.pop_back();  // the last point is where the repetition begins
  std::vector<Pwl::Point> period{{0.0, value_at(pwl.points, pwl.repeat_from)}};
  for (const auto& point : pwl.points)
    if (point.time > pwl.repeat_from) period.push_back({point.time - pwl.repeat_from, point.value});
  track.loop = segments_of(period);
  track.loop.pop_back();
  track.loop_start = end;
  track.loop_period = end - pwl.repeat_from;
  track.loop_count = pwl.repeats;
  track.after_loop = pwl.points.back().value;
  return track;
}

}  // namespace pwlsim::model
