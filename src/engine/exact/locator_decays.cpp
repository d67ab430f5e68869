/// Derivatives, and bounds of them, where a segment follows fast decays. A guard is a sum of the slow motion and of each decay (model::Decays), and so are its derivatives:
///
///     g^{(j)}(τ) = (slow mode's) + Σ_k w_k ψ_k (−1/T_k)^j e^{−τ/T_k}.
///
/// The weights w are rounded against the row's terms, which may be far larger (Decays::guard_doubt), and count with that error. A^j y in the mode itself is mostly rounding, times the fastest rate, and a bound by norms multiplies that rate with whatever there is, also where the guard does not read that decay, or it is over.

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/zero_between.hpp"
#include "engine/exact/locator.hpp"
#include "engine/exact/tolerances.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::engine {

using model::Mode;

namespace {

constexpr int most_values = 200;  ///< of a guard in the search for its root
constexpr int slow_series_order = 4;
constexpr int most_newton = 6;
constexpr double unknown = -1.0;   ///< of what is left of a decay
constexpr int most_halvings = 40;  ///< of an interval, to the length of its fastest decay

/// e^{−τ/T}; what has no time constant is over at once.
double left_of(double constant, double tau) { return constant > 0.0 ? std::exp(-tau / constant) : 0.0; }

/// What rounding of ψ_k and of its weight may add to the guard. `coordinates`: Segment::decays.
double doubt_of(const model::Decays& decays, int row, std::size_t k, const std::vector<double>& coordinates) {
  const auto column = static_cast<Eigen::Index>(k);
  const auto count = static_cast<std::size_t>(decays.time_constants.size());
  return std::abs(decays.guards(row, column)) * coordinates[count + k] + decays.guard_doubt(row, column) * std::abs(coordinates[k]);
}

}  // namespace

/// ψ at the anchor. What the mode holds at zero (a time constant of 0) is rounding there, and is left out. None where nothing else is known of the fast motion.
void Locator::take_decays(Segment& s) {
  const model::Decays& decays = *s.mode->slow->decays;
  const Eigen::Index count = decays.time_constants.size();
  if (s.decays_fail || count == 0 || !(decays.time_constants.maxCoeff() > 0.0)) return;
  whole_state_.resize(static_cast<std::size_t>(s.system->size()));
  model::from_mode(*s.system, *s.mode, s.y0.data(), whole_state_.data());
  s.decays.resize(static_cast<std::size_t>(2 * count));
  for (Eigen::Index k = 0; k < count; ++k) {
    s.decays[static_cast<std::size_t>(k)] = linalg::row_times(decays.coordinates, k, whole_state_.data());
    s.decays[static_cast<std::size_t>(count + k)] =
        model::tolerance::state_rounding * linalg::absolute_row_times(decays.coordinates, k, whole_state_.data());
  }
}

/// The slow motion's own coordinates of a state of the mode, in slow_state_: along the decays, which are not orthogonal to it.
void Locator::take_slow_state(const Segment& s, const double* y) {
  const Mode& slow = *s.mode->slow;
  slow_state_.resize(static_cast<std::size_t>(slow.ny));
  model::from_mode(*s.system, *s.mode, y, whole_state_.data());
  linalg::multiply(slow.decays->slow, whole_state_.data(), slow_state_.data());
  linalg::copy(whole_state_.data() + s.system->n, s.system->n_zeta, slow_state_.data() + slow.n1);
}

void Locator::derive_with_decays(const Segment& s) {
  const Mode& slow = *s.mode->slow;
  const model::Decays& decays = *slow.decays;
  take_slow_state(s, s.y.data());
  slow_slope_.resize(slow_state_.size());
  slow_bend_.resize(slow_state_.size());
  linalg::multiply(slow.flow.a(), slow_state_.data(), slow_slope_.data());
  linalg::multiply(slow.flow.a(), slow_slope_.data(), slow_bend_.data());
  decay_left_.resize(static_cast<std::size_t>(decays.time_constants.size()));
  for (std::size_t k = 0; k < decay_left_.size(); ++k) decay_left_[k] = left_of(decays.time_constants[static_cast<Eigen::Index>(k)], s.tau);
  const double rate_noise = tolerance::unit_rounding * s.mode->norm_a * linalg::norm(s.y.data(), s.mode->ny);
  decays_agree_ = true;
  for (std::size_t i = 0; i < s.rows.size(); ++i) decays_agree_ = derive_sum(s, i, rate_noise) && decays_agree_;
}

/// Guard i with its derivatives as sums, and what rounding may make of them. False where they are not what the state itself says.
bool Locator::derive_sum(const Segment& s, std::size_t i, double rate_noise) {
  const Mode& slow = *s.mode->slow;
  const model::Decays& decays = *slow.decays;
  const int row = s.rows[i];
  guard_noise_[i] = noise_of(s, row);
  slow_g_[i] = linalg::row_times(slow.guards, row, slow_state_.data());
  slow_gd_[i] = linalg::row_times(slow.guards, row, slow_slope_.data());
  const double slow_size = linalg::absolute_row_times(slow.guards, row, slow_slope_.data());
  slow_doubt_[i] = tolerance::graze * slow_size;
  slope_doubt_[i] = 0.0;
  double value = slow_g_[i], size = linalg::absolute_row_times(slow.guards, row, slow_state_.data()) + std::abs(g_[i]);
  double slope = slow_gd_[i], slope_size = slow_size, doubt = 0.0, doubt_of_slope = 0.0;
  g2_[i] = slow_g2_[i] = linalg::row_times(slow.guards, row, slow_bend_.data());
  for (std::size_t k = 0; k < decay_left_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double constant = decays.time_constants[column];
    if (constant == 0.0) continue;
    const double left = s.decays[k] * decay_left_[k], term = decays.guards(row, column) * left;
    value += term;
    size += std::abs(term);
    slope -= term / constant;
    slope_size += std::abs(term) / constant;
    g2_[i] += term / (constant * constant);
    slope_doubt_[i] += decays.guard_doubt(row, column) * std::abs(left) / constant;
    const double of_term = doubt_of(decays, row, k, s.decays) * decay_left_[k];
    doubt += of_term;
    doubt_of_slope += of_term / constant;
  }
  const double slope_error = std::abs(slope - std::exchange(gd_[i], slope));
  if (!(std::abs(value - g_[i]) <= tolerance::decay_mismatch * size + guard_noise_[i] + doubt)) return false;
  return decays.are_sharp || slope_error <= tolerance::decay_mismatch * slope_size + rate_noise * s.mode->guard_norm[row] + doubt_of_slope;
}

/// Whether the guards at the interval's end, whose state ye_ holds, are those sums, and the slow motion's part what it was bound to be: eigenvectors of decays that are nearly parallel can be far off.
bool Locator::decays_hold(const Segment& s, double h) {
  const Mode& slow = *s.mode->slow;
  const model::Decays& decays = *slow.decays;
  take_slow_state(s, ye_.data());
  end_left_.resize(decay_left_.size());
  for (std::size_t k = 0; k < end_left_.size(); ++k) end_left_[k] = left_of(decays.time_constants[static_cast<Eigen::Index>(k)], s.tau + h);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const int row = s.rows[i];
    const double slow_end = linalg::row_times(slow.guards, row, slow_state_.data());
    const double slow_size = linalg::absolute_row_times(slow.guards, row, slow_state_.data());
    const double whole = end_value(s, i);
    double sum = slow_end, size = slow_size + std::abs(whole), at_first = 0.0;
    for (std::size_t k = 0; k < end_left_.size(); ++k) {
      const double term = decays.guards(row, static_cast<Eigen::Index>(k)) * s.decays[k];
      sum += term * end_left_[k];
      size += std::abs(term * end_left_[k]);
      at_first += std::abs(term);
    }
    const double rounding = tolerance::decay_rounding * at_first + guard_noise_[i];
    if (std::abs(sum - whole) > tolerance::decay_mismatch * size + rounding) return false;
    // The slow motion that begins where the decays leave the state, too.
    const double bend = 0.5 * slow_k2_[i] * h * h;
    if (std::abs(slow_g_[i] + h * slow_gd_[i] - slow_end) > bend + tolerance::decay_mismatch * slow_size + rounding) return false;
  }
  return true;
}

/// Guard i and its slope as sums, `at` s from the interval's start; the slow motion to second order.
Locator::Line Locator::sum_at(const Segment& s, std::size_t i, double at) const {
  const model::Decays& decays = *s.mode->slow->decays;
  Line line{slow_g_[i] + at * (slow_gd_[i] + 0.5 * at * slow_g2_[i]), slow_gd_[i] + at * slow_g2_[i]};
  for (std::size_t k = 0; k < decay_left_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double constant = decays.time_constants[column];
    if (constant == 0.0) continue;
    const double term = decays.guards(s.rows[i], column) * s.decays[k] * left_of(constant, s.tau + at);
    line.value += term;
    line.slope -= term / constant;
  }
  return line;
}

/// The one root of guard i (where it is −`below`) in (lower, upper), where it falls: Newton's method from the sums' root with the sums' slopes, else by values alone. Leaves the state there in
/// at_.
double Locator::root_by_values(const Segment& s, std::size_t i, double lower, double upper, double below) {
  const auto value_at = [&](double at) {
    state_at(s, at, at_.data());
    const double value = linalg::row_times(s.mode->guards, s.rows[i], at_.data()) + below;
    return std::abs(value) <= tolerance::root * linalg::absolute_row_times(s.mode->guards, s.rows[i], at_.data()) ? 0.0 : value;
  };
  double at = zero_between(lower, upper, tolerance::unit_rounding, most_values, [&](double t) { return sum_at(s, i, t).value + below; });
  for (int k = 0; k < most_newton && at > lower && at < upper; ++k) {
    const double value = value_at(at);
    if (value == 0.0) return at;
    const double step = -value / sum_at(s, i, at).slope;
    if (std::abs(step) <= tolerance::unit_rounding * (s.tau + at)) return at;
    (value > 0.0 ? lower : upper) = at;
    at += step;
  }
  if (!(value_at(lower) > 0.0)) return lower;
  return zero_between(lower, upper, tolerance::unit_rounding, most_values, value_at);
}

/// Of the slow motion's second derivative or a later one, from what `derive_with_decays` left.
void Locator::bound_slow(const Segment& s, int order, double h) {
  const Mode& slow = *s.mode->slow;
  const std::vector<double>* derivative = &slow_bend_;
  for (int j = 2; j < order; ++j) {
    linalg::multiply(slow.flow.a(), derivative->data(), slow_slope_.data());
    std::swap(slow_state_, slow_slope_);
    derivative = &slow_state_;
  }
  slow_bound_ = bound_in(slow, *s.system->exosystem, order, derivative->data(), s.y.data() + s.mode->n1, h);
}

/// The same of the slow motion and of each decay.
void Locator::bound_decays(const Segment& s, int order, double h) {
  const Mode& slow = *s.mode->slow;
  bound_slow(s, order, h);
  decay_bound_.resize(decay_left_.size());
  for (std::size_t k = 0; k < decay_left_.size(); ++k) {
    const double constant = slow.decays->time_constants[static_cast<Eigen::Index>(k)];
    decay_bound_[k] =
        constant > 0.0 ? (std::abs(s.decays[k]) + s.decays[decay_left_.size() + k]) * decay_left_[k] / std::pow(constant, order) : 0.0;
  }
}

/// Ends of the interval's parts.
void Locator::take_parts(double h, int halvings) {
  parts_.assign(1, 0.0);
  for (int j = halvings; j >= 0; --j) parts_.push_back(std::ldexp(h, -j));
  part_left_.assign(parts_.size() * decay_left_.size(), unknown);
}

/// What is left of each decay at the end of a part, found where it is first asked for.
const double* Locator::left_at(const Segment& s, std::size_t part) {
  double* left = part_left_.data() + part * decay_left_.size();
  const model::Vector& constants = s.mode->slow->decays->time_constants;
  if (*left == unknown)
    for (Eigen::Index k = 0; k < constants.size(); ++k) left[k] = left_of(constants[k], s.tau + parts_[part]);
  return left;
}

/// Parts [0, h/2^n], …, [h/4, h/2], [h/2, h], the first as short as the fastest decay that is not over.
void Locator::split_at_decays(const Segment& s, double h) {
  const model::Vector& constants = s.mode->slow->decays->time_constants;
  double shortest = h;
  for (std::size_t k = 0; k < decay_left_.size(); ++k)
    if (const double constant = constants[static_cast<Eigen::Index>(k)]; constant > 0.0 && decay_left_[k] > tolerance::unit_rounding)
      shortest = std::min(shortest, constant);
  take_parts(h, std::min(1 + std::max(0, std::ilogb(h / shortest)), most_halvings));
}

/// Guard i, above zero at the part's start, on parts `first` … `last` − 1 of the interval: itself, or its slope, from the slow motion's bounds and each decay
/// between its values at both ends.
Locator::Verdict Locator::enclose(const Segment& s, std::size_t i, std::size_t first, std::size_t last) {
  const model::Decays& decays = *s.mode->slow->decays;
  const double begin = parts_[first], end = parts_[last];
  const double bend = 0.5 * slow_k2_[i] * end * end, slope_bend = slow_doubt_[i] + slow_k2_[i] * end;
  double least = slow_g_[i] + std::min(slow_gd_[i] * begin, slow_gd_[i] * end) - bend;
  double most_at_end = slow_g_[i] + slow_gd_[i] * end + bend;
  double lowest_slope = slow_gd_[i] - slope_bend, highest_slope = slow_gd_[i] + slope_bend;
  const double *left_first = left_at(s, first), *left_last = left_at(s, last);
  for (std::size_t k = 0; k < decay_left_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double constant = decays.time_constants[column];
    if (constant == 0.0) continue;
    const double weight = decays.guards(s.rows[i], column) * s.decays[k];
    const double now = weight * left_first[k], then = weight * left_last[k];
    const double doubt = doubt_of(decays, s.rows[i], k, s.decays) * left_first[k];
    least += std::min(now, then) - doubt;
    most_at_end += then + doubt;
    lowest_slope += (std::min(-now, -then) - doubt) / constant;
    highest_slope += (std::max(-now, -then) + doubt) / constant;
  }
  const bool is_above = first > 0 || g_[i] > 0.0;  // not only about to be
  if (lowest_slope > 0.0) return Verdict::excluded;
  if (is_above && least > guard_noise_[i]) return Verdict::excluded;
  if (is_above && highest_slope < 0.0 && most_at_end < -guard_noise_[i]) return Verdict::one_root;
  return Verdict::undecided;
}

/// The same part by part, from the interval's start as far as it can be decided.
Locator::Enclosed Locator::enclose_in_parts(const Segment& s, std::size_t i) {
  const std::size_t last = parts_.size() - 1;
  const bool starts_above = g_[i] > 0.0 || (s.tau == 0.0 && s.departures[i].order > 0 && s.departures[i].value > 0.0);
  if (!starts_above) return {};
  if (const Verdict whole = enclose(s, i, 0, last); whole != Verdict::undecided) return {parts_[last], whole == Verdict::one_root};
  for (std::size_t j = 0; j < last; ++j) {
    const Verdict verdict = enclose(s, i, j, j + 1);
    if (verdict == Verdict::undecided) return {parts_[j], false};
    if (verdict == Verdict::one_root) return {parts_[j + 1], true, parts_[j]};
  }
  return {parts_[last], false};
}

/// Bounds of the slow motion's second derivatives, by its Taylor series instead of by norms alone: parts of it that a guard does not read, or that cancel there, may be
/// far larger.
void Locator::bound_slow_by_series(const Segment& s, double h) {
  const Mode& slow = *s.mode->slow;
  const auto ny = static_cast<std::size_t>(slow.ny);
  slow_series_.resize((slow_series_order + 1) * ny);
  linalg::copy(slow_bend_.data(), slow.ny, slow_series_.data());
  linalg::multiply_repeatedly(slow.flow.a(), slow_series_order, slow_series_.data());
  const double* last = slow_series_.data() + slow_series_order * ny;
  Bound rest = bound_in(slow, *s.system->exosystem, 2 + slow_series_order, last, s.y.data() + s.mode->n1, h);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const int row = s.rows[i];
    double bound = 0.0, power = 1.0;  // h^j / j!
    for (int j = 0; j < slow_series_order; ++j) {
      const double* derivative = slow_series_.data() + static_cast<std::size_t>(j) * ny;
      bound += power * (std::abs(linalg::row_times(slow.guards, row, derivative)) +
                        tolerance::graze * linalg::absolute_row_times(slow.guards, row, derivative));
      power *= h / (j + 1);
    }
    slow_k2_[i] = std::min(slow_k2_[i], bound + power * bound_in_at(slow, rest, row));
  }
}

/// The guards that are not enclosed on all of the interval yet; true if they are then.
bool Locator::enclose_rest(const Segment& s, double h) {
  bool all = true;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    if (enclosed_[i].until < h && !enclosed_[i].falls) enclosed_[i] = enclose_in_parts(s, i);
    all = all && (enclosed_[i].until == h || enclosed_[i].falls);
  }
  return all;
}

/// Each guard in `enclosed_`, as far as the interval of length h, and then no farther than the result. Guards at rest, and those of which nothing is known from
/// their sums, count for nothing.
double Locator::enclose_guards(Segment& s, double h) {
  bound_slow(s, 2, h);
  enclosed_.assign(s.rows.size(), {});
  for (std::size_t i = 0; i < s.rows.size(); ++i) slow_k2_[i] = bound_in_at(*s.mode->slow, slow_bound_, s.rows[i]);
  take_parts(h, 0);
  if (!enclose_rest(s, h)) {
    split_at_decays(s, h);
    if (!enclose_rest(s, h)) {
      bound_slow_by_series(s, h);
      enclose_rest(s, h);
    }
  }
  double length = h;
  s.is_enclosed = true;
  for (const Enclosed& enclosed : enclosed_) {
    if (enclosed.until > 0.0)
      length = std::min(length, enclosed.until);
    else
      s.is_enclosed = false;
  }
  if (s.is_enclosed) return length;
  if (is_sharp(s)) differentiate_state(s);
  bound_second(s, length);
  return length;
}

/// Decides an interval of length h whose guards are all enclosed, without the state at its end. True when an event was found before `end`.
bool Locator::decide_by_enclosures(Segment& s, double h, double end, Located& located) {
  ++intervals_;
  ++s.intervals;
  FirstFall first;
  for (std::size_t i = 0; i < s.rows.size(); ++i)
    if (const Enclosed& enclosed = enclosed_[i]; enclosed.falls && enclosed.from < h)
      take_earlier(s, i, {Verdict::one_root, enclosed.until, 0.0, enclosed.from}, first);
  if (first.at <= h) {
    end_at_event(s, first.index, s.tau + first.at, end, located);
    return true;
  }
  if (s.tau + h < end) {
    state_at(s, h, ye_.data());
    accept(s, h, end);
  } else {
    s.certified = end;
  }
  return false;
}

/// Of a guard that is enclosed, on the whole interval of length h.
Locator::Verdict Locator::verdict_at_end(const Segment& s, std::size_t i, double h) const {
  if (!enclosed_[i].falls) return Verdict::excluded;
  if (end_value(s, i) < 0.0) return Verdict::one_root;
  return enclosed_[i].until > h ? Verdict::excluded : Verdict::undecided;
}

}  // namespace pwlsim::engine
