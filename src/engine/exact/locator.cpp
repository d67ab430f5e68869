#include "engine/exact/locator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

namespace {

using model::Mode;

constexpr double share_of_norm = 0.1;
constexpr int most_iterations = 80;
constexpr int most_series_intervals = 40;
/// ‖A‖·step of the tests of low order below which the series goes farther, for so many intervals; and where it did not, how long to wait.
constexpr double short_step = 0.02;
constexpr int series_in_turn = 16, bounds_in_turn = 64;
/// So many intervals in, a segment that would need more than `most_intervals` has its guards sampled instead (and the run says so),
/// and how finely. A lossless ring that is followed for 10⁵ periods takes some 10⁶.
constexpr std::uint64_t intervals_before_sampling = 20000;
constexpr double most_intervals = 1e8;
constexpr std::uint64_t intervals_of_patience = 30'000'000;  ///< then that is done in any case: some seconds
constexpr std::uint64_t patience_while_brief = 20'000;       ///< the same of a segment that is as long as fast decays last
constexpr double sampled_intervals = 1024.0;
/// Beside decays, whose time constants are decades apart: the next interval, and what remains of one that is not decided.
constexpr double growth_beside_decays = 4.0, share_beside_decays = 0.25;

bool has_to_sample(const Segment& s, double end) {
  if (s.begins_sampled) return true;
  if (s.intervals > (s.is_brief ? patience_while_brief : intervals_of_patience)) return true;
  return s.intervals > intervals_before_sampling && static_cast<double>(s.intervals) * end > most_intervals * s.tau;
}

/// Of the entries of x whose bits are set, 0: of all; `entry(i)`: x_i, or what a scale makes of it.
template <class Entry>
double norm_of(int n, std::uint64_t bits, Entry entry) {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    if (bits != 0 && ((bits >> static_cast<unsigned>(i)) & 1U) == 0) continue;
    const double value = entry(i);
    sum += value * value;
  }
  return std::sqrt(sum);
}

/// They do not describe the segment's guards.
void leave_decays(Segment& s) {
  s.decays.clear();
  s.decays_fail = true;
  s.is_enclosed = false;
}

double growth_over(double rate, double h) { return rate > 0.0 ? std::exp(std::min(rate * h, 500.0)) : 1.0; }

}  // namespace

/// What rounding leaves of a guard at the interval's start: from the terms of its own sum, and from a share of the state's norm.
double Locator::noise_of(const Segment& s, int row) const {
  const double size = model::guard_size(*s.mode, row, s.y.data(), share_of_norm);
  if (s.mode->guard_error.size() == 0) return std::max(s.least_noise, s.mode->guard_noise[row]) * size;
  return model::guard_rounding(*s.mode, row, s.y.data(), size, tolerance::graze);
}

/// The same of a guard at rest: one that the mode was accepted with below zero falls where it is twice as far below.
double Locator::noise_at_rest(const Segment& s, std::size_t i) const {
  const model::Departure& start = s.departures[i];
  const double noise = noise_of(s, s.rows[i]);
  if (start.order > 0) return noise;
  const double value = start.order == 0 ? start.value : linalg::row_times(s.mode->guards, s.rows[i], s.y0.data());
  return std::max(noise, -fallen_further * value);
}

/// Zero at the segment's start to every order that rounding lets through, and not visibly positive since. Or negative where no event was found.
bool Locator::is_at_rest(const Segment& s, std::size_t i) const {
  if (g_[i] <= 0.0 && (s.tau > 0.0 || s.departures[i].order == 0)) return true;
  return s.departures[i].order < 0 && (s.tau == 0.0 || g_[i] <= noise_of(s, s.rows[i]));
}

void Locator::prepare(Segment& s) {
  const auto ny = static_cast<std::size_t>(s.mode->ny);
  const std::size_t rows = s.rows.size();
  if (ny > size_) {
    size_ = ny;
    for (auto* v : {&ye_, &at_, &a1_, &a2_, &event_}) v->resize(ny);
    work_.resize(2 * ny);
    derivatives_.resize((series_order + 2) * ny);
  }
  if (rows <= g_.size()) return;
  for (auto* v : {&g_, &gd_, &g2_, &k2_, &least_bend_, &most_bend_, &slope_doubt_, &slow_g_, &slow_gd_, &slow_doubt_, &slow_k2_, &slow_g2_,
                  &guard_noise_})
    v->resize(rows);
  guard_derivatives_.resize(rows * (series_order + 1));
}

/// ‖c^{(order)}‖ and the blocks' part of the bound K_order, for an interval of length h.
Locator::Bound Locator::bound_of(const Segment& s, int order, const double* derivative, double h) {
  if (!s.decays.empty()) bound_decays(s, order, h);
  return bound_in(*s.mode, *s.system->exosystem, order, derivative, s.y.data() + s.mode->n1, h);
}

Locator::Bound Locator::bound_in(const Mode& m, const model::Exosystem& sources, int order, const double* derivative, const double* zeta,
                                 double h) {
  const auto& blocks = sources.blocks();
  Bound b;
  block_bound_.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const double value = blocks[i].derivative_bound(zeta, order, h);
    block_bound_[i] = value;
    b.sources |= value != 0.0;
    b.inputs += h * value * m.input_block_norm[static_cast<Eigen::Index>(i)];
    if (m.scale.size() > 0) b.scaled_inputs += h * value * m.scaled_input_block_norm[static_cast<Eigen::Index>(i)];
  }
  b.derivative = derivative;
  b.growth = growth_over(m.growth, h);
  b.scaled_growth = growth_over(m.scaled_growth, h);
  bound_state(m, b);
  return b;
}

void Locator::bound_state(const Mode& m, Bound& b) {
  b.state = b.growth * (norm_of(m.n1, b.reads, [&](int i) { return b.derivative[i]; }) + b.inputs);
  if (m.scale.size() == 0) return;
  b.scaled_state = b.scaled_growth * (norm_of(m.n1, b.reads, [&](int i) { return b.derivative[i] / m.scale[i]; }) + b.scaled_inputs);
}

double Locator::bound_in_at(const Mode& m, Bound& b, int row) const {
  if (!m.guard_reads.empty() && m.guard_reads[static_cast<std::size_t>(row)] != b.reads) {
    b.reads = m.guard_reads[static_cast<std::size_t>(row)];
    bound_state(m, b);
  }
  double value = m.guard_c_norm[row] * b.state;
  if (m.scale.size() > 0) value = std::min(value, m.scaled_guard_c_norm[row] * b.scaled_state);
  if (b.sources)
    for (std::size_t i = 0; i < block_bound_.size(); ++i) value += m.guard_block_norm(row, static_cast<Eigen::Index>(i)) * block_bound_[i];
  return value;
}

double Locator::bound_at(const Segment& s, Bound& b, int row) {
  const double value = bound_in_at(*s.mode, b, row);
  if (s.decays.empty()) return value;
  double by_decays = bound_in_at(*s.mode->slow, slow_bound_, row);
  const model::Matrix& weights = s.mode->slow->decays->guards;
  const model::Matrix& doubt = s.mode->slow->decays->guard_doubt;
  for (std::size_t k = 0; k < decay_bound_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    by_decays += (std::abs(weights(row, column)) + doubt(row, column)) * decay_bound_[k];
  }
  return std::min(value, by_decays);
}

/// y, A y and A² y at the interval's start.
void Locator::differentiate_state(const Segment& s) {
  linalg::copy(s.y.data(), s.mode->ny, derivatives_.data());
  linalg::multiply_repeatedly(s.mode->flow.a(), 2, derivatives_.data());
  has_third_ = false;
}

/// The guards with their first and second derivatives at the interval's start.
void Locator::derive(const Segment& s) {
  const Mode& m = *s.mode;
  if (is_sharp(s)) {
    for (std::size_t i = 0; i < s.rows.size(); ++i) g_[i] = linalg::row_times(m.guards, s.rows[i], s.y.data());
    return derive_with_decays(s);
  }
  const auto ny = static_cast<std::size_t>(m.ny);
  const double* d = derivatives_.data();
  differentiate_state(s);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const auto [value, slope, bend] = linalg::row_times_each<3>(m.guards, s.rows[i], d, ny);
    g_[i] = value;
    gd_[i] = slope;
    g2_[i] = bend;
  }
  if (!s.decays.empty()) derive_with_decays(s);
}

/// K_2 of every guard for length h.
void Locator::bound_second(const Segment& s, double h) {
  Bound b = bound_of(s, 2, derivatives_.data() + 2 * s.mode->ny, h);
  for (std::size_t i = 0; i < s.rows.size(); ++i) k2_[i] = bound_at(s, b, s.rows[i]);
}

void Locator::state_at(const Segment& s, double step, double* out) {
  linalg::copy(s.y.data(), s.mode->ny, out);
  s.mode->flow.apply_once(step, out, work_.data());
}

/// A³ y at the interval's start.
const double* Locator::third_derivative(const Segment& s) {
  double* second = derivatives_.data() + 2 * s.mode->ny;
  if (!std::exchange(has_third_, true)) linalg::multiply(s.mode->flow.a(), second, second + s.mode->ny);
  return second + s.mode->ny;
}

/// Guard i at the interval's end, whose state ye_ holds.
double Locator::end_value(const Segment& s, std::size_t i) const { return linalg::row_times(s.mode->guards, s.rows[i], ye_.data()); }

/// Its slope there.
double Locator::end_slope(const Segment& s, std::size_t i) {
  linalg::multiply(s.mode->flow.a(), ye_.data(), a1_.data());
  return linalg::row_times(s.mode->guards, s.rows[i], a1_.data());
}

Locator::Root Locator::examine(const Segment& s, std::size_t i, double h) {
  const model::Departure& start = s.departures[i];
  if (is_at_rest(s, i)) {
    const double noise = noise_at_rest(s, i);
    const double ge = end_value(s, i);
    if (ge < -noise) return {Verdict::one_root, h, noise};
    return {ge <= leaving_zero * noise ? Verdict::excluded : Verdict::undecided, 0.0};
  }
  if (!s.decays.empty() && enclosed_[i].until > 0.0) return {verdict_at_end(s, i, h), h, 0.0, enclosed_[i].from};
  if (s.tau == 0.0 && start.order != 0) {
    // Leaves zero upwards at this order: positive as long as the next derivative cannot have undone it.
    const Mode& m = *s.mode;
    std::copy(s.y.begin(), s.y.begin() + m.ny, a1_.begin());
    for (int order = 0; order <= start.order; ++order) {
      linalg::multiply(m.flow.a(), a1_.data(), a2_.data());
      std::swap(a1_, a2_);
    }
    Bound bound = bound_of(s, start.order + 1, a1_.data(), h);
    const double k = bound_at(s, bound, s.rows[i]);
    return {start.value - k * h / (start.order + 1) > 0.0 ? Verdict::excluded : Verdict::undecided, 0.0};
  }
  const double k2 = k2_[i];
  const double g = g_[i];
  const double doubt = s.decays.empty() ? 0.0 : slope_doubt_[i];
  if (g > 0.0 && g + std::min(gd_[i] - doubt, 0.0) * h - 0.5 * k2 * h * h > 0.0) return {Verdict::excluded, 0.0};
  const double ge = end_value(s, i);
  if (g > 0.0 && ge > 0.0 && std::min(g, ge) - 0.125 * k2 * h * h > 0.0) return {Verdict::excluded, 0.0};
  if (g > 0.0 && ge <= 0.0 && gd_[i] + doubt < -k2 * h) return {Verdict::one_root, h};
  if (!s.decays.empty()) return {Verdict::undecided, 0.0};
  Bound third = bound_of(s, 3, third_derivative(s), h);
  const double k3 = bound_at(s, third, s.rows[i]);
  const double noise = noise_of(s, s.rows[i]);
  if (std::abs(g2_[i]) > k3 * h) {
    if (g2_[i] >= 0.0) return convex(s, i, h, ge, noise);
    if (g >= 0.0 && ge >= 0.0) return {Verdict::excluded, 0.0};
    if (g > 0.0 && ge < 0.0) return {Verdict::one_root, h};
  }
  return {Verdict::undecided, 0.0};
}

Locator::Root Locator::convex(const Segment& s, std::size_t i, double h, double ge, double noise) {
  const double g = g_[i];
  if (g >= -noise && gd_[i] >= 0.0) return {Verdict::excluded, 0.0};
  if (!(g > 0.0)) return {Verdict::undecided, 0.0};
  const double gde = end_slope(s, i);
  if (gde <= 0.0) {
    if (ge > 0.0) return {Verdict::excluded, 0.0};
    if (ge < 0.0) return {Verdict::one_root, h};
    return {Verdict::undecided, 0.0};
  }
  // The minimum lies inside: Newton on g' between the bracketing ends.
  const Mode& m = *s.mode;
  const int row = s.rows[i];
  double low = 0.0;
  double high = h;
  double at = h * gd_[i] / (gd_[i] - gde);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    state_at(s, at, at_.data());
    linalg::multiply(m.flow.a(), at_.data(), a1_.data());
    linalg::multiply(m.flow.a(), a1_.data(), a2_.data());
    const double slope = linalg::row_times(m.guards, row, a1_.data());
    const double curvature = linalg::row_times(m.guards, row, a2_.data());
    (slope < 0.0 ? low : high) = at;
    double next = curvature > 0.0 ? at - slope / curvature : 0.5 * (low + high);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool done = std::abs(next - at) <= tolerance::minimum_step * h ||
                      std::abs(slope) <= tolerance::minimum_slope * m.guard_norm[row] * m.norm_a * linalg::norm(s.y.data(), m.ny);
    if (done) break;
    at = next;
  }
  const double minimum = linalg::row_times(m.guards, row, at_.data());
  if (minimum >= -noise) return {Verdict::excluded, 0.0};
  return {Verdict::one_root, at};
}

/// The segment ends at the event whose state event_ holds, or at `end` where that is sooner.
void Locator::end_at_event(Segment& s, std::size_t i, double tau, double end, Located& located) {
  s.certified = std::min(tau, end);
  if (tau <= end) located = {true, tau, s.rows[i], event_.data()};
}

/// Decides [tau, tau+h]: `decided` false asks for a shorter one. True when an event was found before `end`.
bool Locator::try_interval(Segment& s, double h, double end, Located& located, bool& decided) {
  ++intervals_;
  ++s.intervals;
  state_at(s, h, ye_.data());
  decided = true;
  if (!s.decays.empty() && !decays_hold(s, h)) {
    leave_decays(s);
    derive(s);
    decided = false;
    return false;
  }
  FirstFall first;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const Root root = examine(s, i, h);
    if (root.verdict == Verdict::undecided) {
      decided = false;
      return false;
    }
    if (root.verdict == Verdict::one_root) take_earlier(s, i, root, first);
  }
  if (!(first.at < INFINITY)) return false;
  double tau = s.tau + first.at;
  if (first.below == 0.0 && s.decays.empty()) polish(s, s.rows[first.index], tau);
  end_at_event(s, first.index, tau, end, located);
  return true;
}

/// Guard i's one root, where it comes before the first so far, whose state event_ holds.
void Locator::take_earlier(const Segment& s, std::size_t i, const Root& root, FirstFall& first) {
  // Still positive at the earliest root so far: its only root lies behind that.
  if (first.at < root.upper && linalg::row_times(s.mode->guards, s.rows[i], event_.data()) > 0.0) return;
  if (first.at <= root.lower) return;
  const double at = find_root(s, i, root.lower, std::min(root.upper, first.at), parabola_root(i), root.below);
  if (at >= first.at) return;
  first = {at, root.below, i};
  std::copy(at_.begin(), at_.begin() + s.mode->ny, event_.begin());
}

/// One interval by the tests of low order; true when it ended at an event (or at `end`, or undecided at the shortest interval).
bool Locator::march_by_bounds(Segment& s, double end, double shortest, Located& located) {
  const double rest = end - s.tau;
  // Beyond the radius of the series only powers of two have their exponential at hand; they may reach past the end.
  double h = s.step > 0.0 && !s.is_enclosed ? std::min((s.decays.empty() ? 2.0 : growth_beside_decays) * s.step, rest) : rest;
  const bool sampled = has_to_sample(s, end);
  if (sampled) h = std::max(h, rest / sampled_intervals);
  if (!is_sharp(s) && s.mode->flow.rate() * h > 1.0) h = std::ldexp(1.0, std::ilogb(h) + (h < rest ? 0 : 1));
  for (bool decided = false; !decided;) {
    if (s.decays.empty())
      bound_second(s, h);
    else
      h = enclose_guards(s, h);
    if (s.is_enclosed && is_sharp(s)) return decide_by_enclosures(s, h, end, located);
    if (try_interval(s, h, end, located, decided)) return true;
    if (decided) break;
    if (sampled) {
      s.begins_sampled = false;
      if (sample_interval(s, h, end, located)) return true;
      break;
    }
    h *= s.decays.empty() ? 0.5 : share_beside_decays;
    if (h >= shortest) continue;
    // Cannot be decided: let the selection look at the state a hair further on.
    state_at(s, h, event_.data());
    located = {true, std::min(s.tau + h, end), -1, event_.data()};
    s.certified = located.tau;
    return true;
  }
  accept(s, h, end);
  return false;
}

/// The last resort where fast parts at rounding level keep the bounds from closing: signs at the interval's end decide.
bool Locator::sample_interval(Segment& s, double h, double end, Located& located) {
  if (!s.sampled) ++sampled_;
  s.sampled = true;
  state_at(s, h, ye_.data());
  double first = INFINITY;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    if (end_value(s, i) >= -noise_of(s, s.rows[i]) || end_slope(s, i) > 0.0) continue;
    const double at = g_[i] > 0.0 ? find_root(s, i, 0.0, h, parabola_root(i), 0.0) : 0.5 * h;
    if (at >= first) continue;
    first = at;
    state_at(s, at, event_.data());
    double tau = s.tau + at;
    if (g_[i] > 0.0) polish(s, s.rows[i], tau);
    located = {true, tau, s.rows[i], event_.data()};
  }
  if (!(first < INFINITY) || located.tau > end) {
    located = {};
    return false;
  }
  s.certified = located.tau;
  return true;
}

void Locator::accept(Segment& s, double h, double end) {
  s.tau += h;
  s.step = h;
  std::copy(ye_.begin(), ye_.begin() + s.mode->ny, s.y.begin());
  s.certified = std::min(s.tau, end);
}

/// Gate drives: g(τ) = g + g'τ, so the crossing is at −g/g' and nothing needs to be searched.
void Locator::straight_lines(Segment& s, double end, Located& located) {
  const Mode& m = *s.mode;
  linalg::multiply(m.flow.a(), s.y.data(), a1_.data());
  double first = INFINITY;
  int row = -1;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const double slope = linalg::row_times(m.guards, s.rows[i], a1_.data());
    if (!(slope < -model::threshold_noise * linalg::absolute_row_times(m.guards, s.rows[i], a1_.data()))) continue;
    const double at = -linalg::row_times(m.guards, s.rows[i], s.y.data()) / slope;
    if (at < 0.0 || at >= first) continue;
    first = at;
    row = s.rows[i];
  }
  if (!(s.tau + first <= end)) {
    s.certified = end;
    return;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.ny); ++i) event_[i] = s.y[i] + first * a1_[i];
  s.certified = s.tau + first;
  located = {true, s.certified, row, event_.data()};
}

void Locator::locate(Segment& s, double end, Located& located) {
  located = {};
  if (s.certified >= end) return;
  if (s.rows.empty() || s.tau >= end) {  // an interval of a power of two has reached past this end
    s.certified = end;
    return;
  }
  prepare(s);
  if (s.is_brief && s.decays.empty()) take_decays(s);
  march(s, end, located);
}

void Locator::march(Segment& s, double end, Located& located) {
  if (s.mode->piecewise_linear) return straight_lines(s, end, located);
  const double shortest =
      std::max(tolerance::smallest_interval * end, s.is_brief ? 0.0 : 4.0 * tolerance::unit_rounding * (s.anchor + end));
  int series_intervals = 0;
  while (s.certified < end) {
    if (is_interrupted()) {
      linalg::copy(s.y.data(), s.mode->ny, event_.data());
      located = {true, s.tau, -1, event_.data()};
      return;
    }
    derive(s);
    if (!s.decays.empty() && !decays_agree_) {
      leave_decays(s);
      continue;
    }
    if (!s.decays.empty()) {
      if (march_by_bounds(s, end, shortest, located)) return;
      continue;
    }
    if (look_ahead(s, end, located)) return;
    const Progress progress = has_to_sample(s, end) ? Progress::none : search_modal_form(s, end, shortest, located);
    if (progress == Progress::to_end) return;
    if (progress == Progress::some) continue;
    if (!s.mode->stiff || s.turns > 0) {
      if (s.turns > 0) --s.turns;
      if (march_by_series(s, end, located)) {
        ++s.intervals;
        // A segment that long in the mode's own time means fast parts that do not matter: low orders step over those.
        if (++series_intervals > most_series_intervals) s.mode->stiff = true;
        if (located.found) return;
        continue;
      }
      s.turns = -bounds_in_turn;
    }
    if (march_by_bounds(s, end, shortest, located)) return;
    if (++s.turns > 0) s.turns = s.mode->stiff && s.mode->flow.rate() * s.step < short_step ? series_in_turn : 0;
  }
}

}  // namespace pwlsim::engine
