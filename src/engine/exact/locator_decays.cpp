/// Derivatives, and bounds of them, where a segment follows fast decays. A guard is a sum of the slow motion and of each decay (model::Decays), and so are its derivatives:
///
///     g^{(j)}(τ) = (slow mode's) + Σ_k w_k ψ_k (−1/T_k)^j e^{−τ/T_k}.
///
/// The weights w are rounded against the row's terms, which may be far larger (Decays::guard_doubt), and count with that error. A^j y in the mode itself is mostly rounding, times the fastest rate, and a bound by norms multiplies that rate with whatever there is, also where the guard does not read that decay, or it is over.

#include <algorithm>
#include <cmath>

#include "base/zero_between.hpp"
#include "engine/exact/locator.hpp"
#include "engine/exact/tolerances.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::engine {

using model::Mode;

namespace {

constexpr int most_values = 200;  ///< of a guard in the search for its root

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
  const Eigen::Map<const model::Vector> x(whole_state_.data(), s.system->size());
  s.decays.resize(static_cast<std::size_t>(2 * count));
  Eigen::Map<model::Vector>(s.decays.data(), count) = decays.coordinates * x;
  Eigen::Map<model::Vector>(s.decays.data() + count, count) =
      model::tolerance::state_rounding * (decays.coordinates.cwiseAbs() * x.cwiseAbs());
}

/// The slow motion's own coordinates of a state of the mode, in slow_state_.
void Locator::take_slow_state(const Segment& s, const double* y) {
  slow_state_.resize(static_cast<std::size_t>(s.mode->slow->ny));
  model::from_mode(*s.system, *s.mode, y, whole_state_.data());
  model::to_mode(*s.system, *s.mode->slow, whole_state_.data(), slow_state_.data());
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
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const int row = s.rows[i];
    slow_g_[i] = linalg::row_times(slow.guards, row, slow_state_.data());
    slow_gd_[i] = linalg::row_times(slow.guards, row, slow_slope_.data());
    const double slow_size = linalg::absolute_row_times(slow.guards, row, slow_slope_.data());
    slow_doubt_[i] = tolerance::graze * slow_size;
    slope_doubt_[i] = 0.0;
    double value = slow_g_[i], size = linalg::absolute_row_times(slow.guards, row, slow_state_.data()) + std::abs(g_[i]);
    double slope = slow_gd_[i], slope_size = slow_size, doubt = 0.0, doubt_of_slope = 0.0;
    g2_[i] = linalg::row_times(slow.guards, row, slow_bend_.data());
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
    decays_agree_ =
        decays_agree_ && std::abs(value - g_[i]) <= tolerance::decay_mismatch * size + noise_of(s, row) + doubt &&
        std::abs(slope - gd_[i]) <= tolerance::decay_mismatch * slope_size + rate_noise * s.mode->guard_norm[row] + doubt_of_slope;
    gd_[i] = slope;
  }
}

/// Whether the guards at the interval's end, which is in ye_ and ge_, are those sums: eigenvectors of decays that are nearly parallel can be far off.
bool Locator::decays_hold(const Segment& s, double h) {
  const Mode& slow = *s.mode->slow;
  const model::Decays& decays = *slow.decays;
  take_slow_state(s, ye_.data());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const int row = s.rows[i];
    double sum = linalg::row_times(slow.guards, row, slow_state_.data());
    double size = linalg::absolute_row_times(slow.guards, row, slow_state_.data()) + std::abs(ge_[i]);
    for (Eigen::Index k = 0; k < decays.time_constants.size(); ++k) {
      const double term = decays.guards(row, k) * s.decays[static_cast<std::size_t>(k)];
      sum += term * left_of(decays.time_constants[k], s.tau + h);
      size += std::abs(term);
    }
    if (std::abs(sum - ge_[i]) > tolerance::decay_mismatch * size + noise_of(s, row)) return false;
  }
  return true;
}

/// The one root of guard i (where it is −`below`) in (lower, upper), where it falls, without slopes. Leaves the state there in at_.
double Locator::root_by_values(const Segment& s, std::size_t i, double lower, double upper, double below) {
  const auto value_at = [&](double at) {
    state_at(s, at, at_.data());
    const double value = linalg::row_times(s.mode->guards, s.rows[i], at_.data()) + below;
    return std::abs(value) <= tolerance::root * linalg::absolute_row_times(s.mode->guards, s.rows[i], at_.data()) ? 0.0 : value;
  };
  if (!(value_at(lower) > 0.0)) return lower;
  return zero_between(lower, upper, tolerance::unit_rounding, most_values, value_at);
}

/// Of the second derivative or a later one, from what `derive_with_decays` left.
void Locator::bound_decays(const Segment& s, int order, double h) {
  const Mode& slow = *s.mode->slow;
  const std::vector<double>* derivative = &slow_bend_;
  for (int j = 2; j < order; ++j) {
    linalg::multiply(slow.flow.a(), derivative->data(), slow_slope_.data());
    std::swap(slow_state_, slow_slope_);
    derivative = &slow_state_;
  }
  slow_bound_ = bound_in(slow, *s.system->exosystem, order, derivative->data(), s.y.data() + s.mode->n1, h);
  decay_bound_.resize(decay_left_.size());
  for (std::size_t k = 0; k < decay_left_.size(); ++k) {
    const double constant = slow.decays->time_constants[static_cast<Eigen::Index>(k)];
    decay_bound_[k] =
        constant > 0.0 ? (std::abs(s.decays[k]) + s.decays[decay_left_.size() + k]) * decay_left_[k] / std::pow(constant, order) : 0.0;
  }
}

/// A guard on the whole interval: itself, or its slope, from the slow motion's bounds and each decay between its values at both ends. A decay that only adds to a
/// guard, or only to its slope, needs no interval shorter than the slow motion's.
Locator::Verdict Locator::enclose(const Segment& s, std::size_t i, double h) const {
  const model::Decays& decays = *s.mode->slow->decays;
  double least = slow_g_[i] + std::min(slow_gd_[i], 0.0) * h - 0.5 * slow_k2_[i] * h * h;
  double lowest_slope = slow_gd_[i] - slow_doubt_[i] - slow_k2_[i] * h, highest_slope = slow_gd_[i] + slow_doubt_[i] + slow_k2_[i] * h;
  for (std::size_t k = 0; k < decay_left_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double constant = decays.time_constants[column];
    if (constant == 0.0) continue;
    const double weight = decays.guards(s.rows[i], column);
    const double now = weight * s.decays[k] * decay_left_[k], then = now * std::exp(-h / constant);
    const double doubt = doubt_of(decays, s.rows[i], k, s.decays) * decay_left_[k];
    least += std::min(now, then) - doubt;
    lowest_slope += (std::min(-now, -then) - doubt) / constant;
    highest_slope += (std::max(-now, -then) + doubt) / constant;
  }
  const bool starts_above = g_[i] > 0.0 || (s.tau == 0.0 && s.departures[i].order > 0 && s.departures[i].value > 0.0);
  if (starts_above && lowest_slope > 0.0) return Verdict::excluded;
  if (g_[i] > 0.0 && least > noise_of(s, s.rows[i])) return Verdict::excluded;
  if (g_[i] > 0.0 && ge_[i] < 0.0 && highest_slope < 0.0) return Verdict::one_root;
  return Verdict::undecided;
}

}  // namespace pwlsim::engine
