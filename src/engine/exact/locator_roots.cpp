/// Where a guard that has one root in an interval is zero, and the state there.

#include <cmath>

#include "engine/exact/bent_step.hpp"
#include "engine/exact/locator.hpp"
#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

namespace {

using model::Mode;

constexpr int most_root_steps = 80;

}  // namespace

/// Root of the parabola through the interval's first derivatives; −1: none.
double Locator::parabola_root(std::size_t i) const {
  const double discriminant = gd_[i] * gd_[i] - 2.0 * g2_[i] * g_[i];
  return discriminant >= 0.0 ? 2.0 * g_[i] / (-gd_[i] + std::sqrt(discriminant)) : -1.0;
}

/// The one root of guard i (where it is −`below`) in (lower, upper). Leaves the state there in at_.
double Locator::find_root(const Segment& s, std::size_t i, double lower, double upper, double guess, double below) {
  if (!s.decays.empty()) return root_by_values(s, i, lower, upper, below);
  double at = guess;
  if (!(at > lower && at < upper)) at = 0.5 * (lower + upper);
  state_at(s, at, at_.data());
  return approach_root(s, i, lower, upper, at, below);
}

/// The same from `at`, whose state at_ holds: Chebyshev's method kept inside its bracket.
double Locator::approach_root(const Segment& s, std::size_t i, double lower, double upper, double at, double below) {
  const Mode& m = *s.mode;
  const int row = s.rows[i];
  double low = lower;
  double high = upper;
  for (int iteration = 0; iteration < most_root_steps; ++iteration) {
    linalg::multiply(m.flow.a(), at_.data(), a1_.data());
    const double value = linalg::row_times(m.guards, row, at_.data()) + below;
    const double slope = linalg::row_times(m.guards, row, a1_.data());
    (value > 0.0 ? low : high) = at;
    // Against the terms of this very sum: a large part of the state that the row does not read says nothing here.
    if (std::abs(value) <= tolerance::root * linalg::absolute_row_times(m.guards, row, at_.data())) break;
    linalg::multiply(m.flow.a(), a1_.data(), a2_.data());
    const double newton = -value / slope;
    const double bend = 0.5 * newton * linalg::row_times(m.guards, row, a2_.data()) / slope;
    const double chebyshev = slope < 0.0 ? at + newton * bend_factor(bend) : low;
    const bool inside = iteration < most_bent_steps && chebyshev > low && chebyshev < high;
    const double next = inside ? chebyshev : 0.5 * (low + high);
    const double step = next - at;
    if (std::abs(step) <= tolerance::unit_rounding * (s.tau + at)) break;
    if (!m.flow.shift(step, at_.data(), work_.data())) state_at(s, next, at_.data());
    at = next;
    // What the bend and a third derivative of ‖A‖² times the first leave for the next step is so short that `polish` makes it exactly.
    const double reach = std::abs(newton) * m.norm_a;
    if (inside && reach * (2.0 * bend * bend + reach * reach / 6.0) <= tolerance::left_to_polish) break;
  }
  return at;
}

/// Moves the event's time, and the state with it along its own flow, until the guard is rounding: re-evaluating e^{Aτ} would leave more.
/// False where it is too far from zero for that.
bool Locator::polish(const Segment& s, int row, double& tau) {
  const Mode& m = *s.mode;
  for (int round = 0; round < 3; ++round) {
    const double value = linalg::row_times(m.guards, row, event_.data());
    linalg::multiply(m.flow.a(), event_.data(), a1_.data());
    const double slope = linalg::row_times(m.guards, row, a1_.data());
    if (value == 0.0 || slope == 0.0) return value == 0.0;
    const double shift = -value / slope;
    if (std::abs(shift) * m.norm_a > tolerance::longest_polish) return false;
    linalg::multiply(m.flow.a(), a1_.data(), a2_.data());
    for (int i = 0; i < m.ny; ++i)
      event_[static_cast<std::size_t>(i)] += shift * (a1_[static_cast<std::size_t>(i)] + 0.5 * shift * a2_[static_cast<std::size_t>(i)]);
    tau += shift;
    // What is left is the third power of ‖A‖·shift, or the square of its curvature: nothing after a step this short.
    if (std::abs(shift) * m.norm_a <= tolerance::last_polish || std::abs(shift) <= tolerance::unit_rounding * tau) return true;
  }
  return true;
}

/// The root of `find_root`, with the state there in event_.
double Locator::go_to_root(const Segment& s, std::size_t i, double lower, double upper, double guess, double below) {
  const double at = find_root(s, i, lower, upper, guess, below);
  linalg::copy(at_.data(), s.mode->ny, event_.data());
  return at;
}

/// The time of the one root of guard i in (lower, upper), near `at`, whose state event_ holds; on return the state at the root.
double Locator::polish_or_search(const Segment& s, std::size_t i, double lower, double upper, double at) {
  double tau = s.tau + at;
  if (polish(s, s.rows[i], tau)) return tau;
  const double moved = tau - s.tau;
  if (moved > lower && moved < upper) {
    linalg::copy(event_.data(), s.mode->ny, at_.data());
    tau = s.tau + approach_root(s, i, lower, upper, moved, 0.0);
    linalg::copy(at_.data(), s.mode->ny, event_.data());
  } else {
    tau = s.tau + go_to_root(s, i, lower, upper, at, 0.0);
  }
  polish(s, s.rows[i], tau);
  return tau;
}

}  // namespace pwlsim::engine
