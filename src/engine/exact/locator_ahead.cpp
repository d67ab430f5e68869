/// What two derivatives at its start tell of the rest of a segment: whether every guard stays positive, or some of them fall throughout, so that the
/// first root is the root of nearly a parabola.

#include <algorithm>
#include <cmath>

#include "engine/exact/locator.hpp"

namespace pwlsim::engine {

namespace {

constexpr double worth_narrowing = 1.5;  ///< rate·h up to which K_3 may tell what K_2 does not
constexpr double beyond_root = 2.0;      ///< of the time to a parabola's root: how far the guard's own is looked for. There K_2 tells most

}  // namespace

/// Bounds of every guard's second derivative over length h: ±K_2.
void Locator::bound_bends(const Segment& s, double h) {
  bound_second(s, h);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    least_bend_[i] = -k2_[i];
    most_bend_[i] = k2_[i];
  }
}

/// Where what it is at the start, and K_3, tell more. Needs the third derivative.
void Locator::narrow_bends(const Segment& s, double h) {
  bound_bends(s, h);
  Bound b = bound_of(s, 3, derivatives_.data() + 3 * s.mode->ny, h);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const double spread = bound_at(s, b, s.rows[i]) * h;
    least_bend_[i] = std::max(least_bend_[i], g2_[i] - spread);
    most_bend_[i] = std::min(most_bend_[i], g2_[i] + spread);
  }
}

/// Above a parabola that is positive over [0, h].
bool Locator::stays_positive(std::size_t i, double h) const {
  const double bend = least_bend_[i];
  if (!(g_[i] > 0.0)) return false;
  if (gd_[i] < 0.0 && gd_[i] + bend * h > 0.0) return g_[i] > 0.5 * gd_[i] * gd_[i] / bend;
  return g_[i] + (gd_[i] + 0.5 * bend * h) * h > 0.0;
}

/// Positive at the interval's start, negative at its end, and falling all the way.
bool Locator::falls_throughout(const Segment& s, std::size_t i, double h) const {
  const double bend = most_bend_[i] * h;
  return gd_[i] < 0.0 && gd_[i] + bend < 0.0 && g_[i] + (gd_[i] + 0.5 * bend) * h < 0.0 && g_[i] > noise_of(s, s.rows[i]);
}

/// What these bounds tell of all guards: whether each stays positive, or falls throughout.
Locator::Outlook Locator::outlook(const Segment& s, double h) {
  Outlook found{Verdict::excluded};
  double first = INFINITY;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    if (s.departures[i].order < 0) return {};
    if (s.tau == 0.0 && s.departures[i].order != 0) {
      if (examine(s, i, h).verdict != Verdict::excluded) return {};
      continue;
    }
    if (stays_positive(i, h)) continue;
    if (!falls_throughout(s, i, h)) return {};
    const double root = parabola_root(i);
    if (found.verdict != Verdict::excluded && root >= first) continue;
    found = {Verdict::one_root, i};
    first = root;
  }
  return found;
}

/// A length that holds the first root of a guard's parabola; `longest` where there is none before that.
double Locator::length_to_first_root(const Segment& s, double longest) const {
  double length = longest;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const double root = g_[i] > 0.0 && gd_[i] < 0.0 ? parabola_root(i) : -1.0;
    if (root > 0.0) length = std::min(length, beyond_root * root);
  }
  return length;
}

/// Near the root of the cubic through the interval's first derivatives.
double Locator::cubic_root(const Segment& s, std::size_t i) const {
  const double at = parabola_root(i);
  const double third = linalg::row_times(s.mode->guards, s.rows[i], derivatives_.data() + 3 * s.mode->ny);
  return at - third * at * at * at / (6.0 * (gd_[i] + at * (g2_[i] + 0.5 * third * at)));
}

/// The event within h, where guard i falls throughout and so do others, or none; false where another one comes before it.
bool Locator::falling(Segment& s, std::size_t i, double h, double end, Located& located) {
  double at = cubic_root(s, i);
  if (!(at > 0.0 && at < h)) at = 0.5 * h;
  if (!s.mode->flow.continue_series(derivatives_.data(), 3, at, event_.data())) state_at(s, at, event_.data());
  const double tau = polish_or_search(s, i, 0.0, h, at);
  for (std::size_t k = 0; k < s.rows.size(); ++k) {
    if (k == i || (s.tau == 0.0 && s.departures[k].order != 0) || stays_positive(k, h)) continue;
    if (linalg::row_times(s.mode->guards, s.rows[k], event_.data()) <= noise_of(s, s.rows[k])) return false;
  }
  ++intervals_;
  ++s.intervals;
  end_at_event(s, i, tau, end, located);
  return true;
}

/// True where that decides the segment up to `end`, or finds the first event before it.
bool Locator::look_ahead(Segment& s, double end, Located& located) {
  const double rest = end - s.tau;
  double length = rest;
  bound_bends(s, length);
  Outlook found = outlook(s, length);
  if (found.verdict != Verdict::excluded) {
    const bool narrows = found.verdict == Verdict::undecided;
    if (narrows) {
      length = length_to_first_root(s, rest);
      if (s.mode->flow.rate() * length > worth_narrowing) return false;
    }
    third_derivative(s);
    if (narrows) {
      narrow_bends(s, length);
      found = outlook(s, length);
    }
  }
  if (found.verdict == Verdict::one_root) return falling(s, found.row, length, end, located);
  if (found.verdict != Verdict::excluded || length != rest) return false;
  s.certified = end;
  return true;
}

}  // namespace pwlsim::engine
