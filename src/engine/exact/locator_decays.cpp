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

}  // namespace

/// ψ at the anchor. None where the mode jumps beside its decays.
void Locator::take_decays(Segment& s) {
  const model::Decays& decays = *s.mode->slow->decays;
  const Eigen::Index count = decays.time_constants.size();
  if (s.decays_fail || count == 0 || !(decays.time_constants.minCoeff() > 0.0)) return;
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
  for (std::size_t k = 0; k < decay_left_.size(); ++k)
    decay_left_[k] = std::exp(-s.tau / decays.time_constants[static_cast<Eigen::Index>(k)]);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    gd_[i] = linalg::row_times(slow.guards, s.rows[i], slow_slope_.data());
    g2_[i] = linalg::row_times(slow.guards, s.rows[i], slow_bend_.data());
    slope_doubt_[i] = 0.0;
    for (std::size_t k = 0; k < decay_left_.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const double constant = decays.time_constants[column];
      const double fall = s.decays[k] * decay_left_[k] / constant;
      const double rate_of_change = -decays.guards(s.rows[i], column) * fall;
      gd_[i] += rate_of_change;
      g2_[i] -= rate_of_change / constant;
      slope_doubt_[i] += decays.guard_doubt(s.rows[i], column) * std::abs(fall);
    }
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
      sum += term * std::exp(-(s.tau + h) / decays.time_constants[k]);
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
    decay_bound_[k] = (std::abs(s.decays[k]) + s.decays[decay_left_.size() + k]) * decay_left_[k] / std::pow(constant, order);
  }
}

}  // namespace pwlsim::engine
