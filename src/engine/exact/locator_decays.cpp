/// Derivatives, and bounds of them, where a segment follows fast decays. A guard is a sum of the slow motion and of each decay (model::Decays), and so are its derivatives:
///
///     g^{(j)}(τ) = (slow mode's) + Σ_k w_k ψ_k (−1/T_k)^j e^{−τ/T_k}.
///
/// The weights w are rounded against the row's terms, which may be far larger (Decays::guard_doubt), and count with that error. A^j y in the mode itself is mostly rounding, times the fastest rate, and a bound by norms multiplies that rate with whatever there is, also where the guard does not read that decay, or it is over.

#include <algorithm>
#include <cmath>

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

/// The slow motion's own coordinates of a state of the mode, in slow_derivative_.
void Locator::take_slow_state(const Segment& s, const double* y) {
  const Mode& slow = *s.mode->slow;
  slow_derivative_.resize(static_cast<std::size_t>(slow.ny));
  slow_next_.resize(static_cast<std::size_t>(slow.ny));
  model::from_mode(*s.system, *s.mode, y, whole_state_.data());
  model::to_mode(*s.system, slow, whole_state_.data(), slow_derivative_.data());
}

void Locator::derive_with_decays(const Segment& s) {
  const Mode& slow = *s.mode->slow;
  const model::Decays& decays = *slow.decays;
  take_slow_state(s, s.y.data());
  linalg::multiply(slow.flow.a(), slow_derivative_.data(), slow_next_.data());
  linalg::multiply(slow.flow.a(), slow_next_.data(), slow_derivative_.data());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    gd_[i] = linalg::row_times(slow.guards, s.rows[i], slow_next_.data());
    g2_[i] = linalg::row_times(slow.guards, s.rows[i], slow_derivative_.data());
    slope_doubt_[i] = 0.0;
    for (Eigen::Index k = 0; k < decays.time_constants.size(); ++k) {
      const double constant = decays.time_constants[k];
      const double fall = s.decays[static_cast<std::size_t>(k)] * std::exp(-s.tau / constant) / constant;
      const double rate_of_change = -decays.guards(s.rows[i], k) * fall;
      gd_[i] += rate_of_change;
      g2_[i] -= rate_of_change / constant;
      slope_doubt_[i] += decays.guard_doubt(s.rows[i], k) * std::abs(fall);
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
    double sum = linalg::row_times(slow.guards, row, slow_derivative_.data());
    double size = linalg::absolute_row_times(slow.guards, row, slow_derivative_.data()) + std::abs(ge_[i]);
    for (Eigen::Index k = 0; k < decays.time_constants.size(); ++k) {
      const double term = decays.guards(row, k) * s.decays[static_cast<std::size_t>(k)];
      sum += term * std::exp(-(s.tau + h) / decays.time_constants[k]);
      size += std::abs(term);
    }
    if (std::abs(sum - ge_[i]) > tolerance::decay_mismatch * size + noise_of(s, row)) return false;
  }
  return true;
}

/// The one root of guard i (where it is −`below`) in (lower, upper), where it falls, without slopes: false position, with the end that stays weighed down (Dowell and Jarratt, BIT 11 (1971)).
/// Leaves the state there in at_.
double Locator::root_by_values(const Segment& s, std::size_t i, double lower, double upper, double below) {
  const auto value_at = [&](double at) {
    state_at(s, at, at_.data());
    return linalg::row_times(s.mode->guards, s.rows[i], at_.data()) + below;
  };
  double at_lower = value_at(lower), at_upper = value_at(upper), at = upper;
  bool was_above = false;
  for (int iteration = 0; iteration < most_values; ++iteration) {
    const double part = at_lower > at_upper ? at_lower / (at_lower - at_upper) : 0.5;
    at = lower + std::clamp(part, 0.0, 1.0) * (upper - lower);
    const double value = value_at(at);
    if (std::abs(value) <= tolerance::root * linalg::absolute_row_times(s.mode->guards, s.rows[i], at_.data()) ||
        upper - lower <= tolerance::unit_rounding * upper)
      break;
    const bool is_above = value > 0.0;
    (is_above ? lower : upper) = at;
    (is_above ? at_lower : at_upper) = value;
    double& kept = is_above ? at_upper : at_lower;
    if (iteration > 0 && was_above == is_above) kept *= 0.5;
    was_above = is_above;
  }
  return at;
}

void Locator::bound_decays(const Segment& s, int order, double h) {
  const Mode& slow = *s.mode->slow;
  take_slow_state(s, s.y.data());
  for (int j = 0; j < order; ++j) {
    linalg::multiply(slow.flow.a(), slow_derivative_.data(), slow_next_.data());
    std::swap(slow_derivative_, slow_next_);
  }
  slow_bound_ = bound_in(slow, *s.system->exosystem, order, slow_derivative_.data(), s.y.data() + s.mode->n1, h);
  const model::Vector& time_constants = slow.decays->time_constants;
  const auto count = static_cast<std::size_t>(time_constants.size());
  decay_bound_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double constant = time_constants[static_cast<Eigen::Index>(k)];
    decay_bound_[k] = (std::abs(s.decays[k]) + s.decays[count + k]) * std::exp(-s.tau / constant) / std::pow(constant, order);
  }
}

}  // namespace pwlsim::engine
