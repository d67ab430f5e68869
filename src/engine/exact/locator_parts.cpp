/// Events in the slow part of a mode (model/slow_part.hpp).
#include <algorithm>
#include <cmath>

#include "engine/exact/locator.hpp"

namespace pwlsim::engine {

namespace {

/// What a slow part's event may be off by, in time, against the segment's length.
constexpr double parting_error = 1e-9;

}  // namespace

/// Goes on in the slowest part whose fast remainder has died out; true when the part is a new one.
bool Locator::enter_slow_part(Segment& s) {
  const model::Mode& whole = *s.whole;
  if (!whole.slow_parts_known) {
    whole.slow_parts = model::slow_parts(*s.system, whole);
    whole.slow_parts_known = true;
  }
  if (whole.slow_parts.empty() || s.part == whole.slow_parts.back().get()) return false;
  const auto ny = static_cast<std::size_t>(whole.ny);
  whole_y_.resize(ny);
  slow_y_.resize(ny);
  if (s.part)
    s.part->to_whole(s.y.data(), whole_y_.data());
  else
    std::copy_n(s.y.begin(), ny, whole_y_.begin());
  for (auto part = whole.slow_parts.rbegin(); part != whole.slow_parts.rend() && part->get() != s.part; ++part) {
    if (!(*part)->enter(whole_y_.data(), slow_y_.data())) continue;
    s.part = part->get();
    s.mode = &s.part->mode;
    s.step = 0.0;
    std::copy_n(slow_y_.begin(), static_cast<std::size_t>(s.mode->ny), s.y.begin());
    drop_idle_rows(s);
    return true;
  }
  return false;
}

/// Guards that the slow part does not move stay where they are.
void Locator::drop_idle_rows(Segment& s) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    if (s.mode->guard_constant[static_cast<std::size_t>(s.rows[i])] != 0) continue;
    s.rows[kept] = s.rows[i];
    s.departures[kept++] = s.departures[i];
  }
  s.rows.resize(kept);
  s.departures.resize(kept);
}

/// The state of the whole mode at the event that its slow part has found: Newton's method on the whole flow from the anchor, so that
/// nothing of the parting's rounding stays.
void Locator::leave_slow_part(const Segment& s, Located& located) {
  const model::Mode& whole = *s.whole;
  const auto ny = static_cast<std::size_t>(whole.ny);
  const auto at = [&](double tau) {
    std::copy_n(s.y0.begin(), ny, whole_y_.begin());
    whole.flow.apply_once(tau, whole_y_.data(), work_.data());
  };
  at(located.tau);
  for (int round = 0; located.row >= 0 && round < 3; ++round) {
    linalg::multiply(whole.flow.a(), whole_y_.data(), slow_y_.data());
    const double slope = linalg::row_times(whole.guards, located.row, slow_y_.data());
    const double value = linalg::row_times(whole.guards, located.row, whole_y_.data());
    const double next = located.tau - value / slope;
    if (value == 0.0 || !(std::abs(next - located.tau) <= parting_error * located.tau) || next == located.tau) break;
    located.tau = next;
    at(next);
  }
  std::copy_n(whole_y_.begin(), ny, event_.begin());
  located.y = event_.data();
}

}  // namespace pwlsim::engine
