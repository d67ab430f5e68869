#include "engine/exact/continuity_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/exact/guard_watch.hpp"

namespace pwlsim::engine {

ContinuityWatch::ContinuityWatch(const model::System& system) : system_(system) {
  const auto n = static_cast<std::size_t>(system.n);
  for (auto* v : {&largest_, &unexplained_, &time_}) v->assign(n, 0.0);
  for (auto* v : {&before_, &x_}) v->resize(static_cast<std::size_t>(system.size()));
}

void ContinuityWatch::begin(const double* x) {
  is_open_ = true;
  linalg::copy(x, system_.size(), before_.data());
  is_moved_ = false;
}

void ContinuityWatch::jumped(const model::Details& details) {
  if (details.higher_order) return excuse();
  if (!std::exchange(is_moved_, true)) moved_.setZero(system_.n);
  moved_ += system_.b.topRows(system_.n) * details.impulse;
}

void ContinuityWatch::end(const Side& before, const Side& after, double time) {
  if (!std::exchange(is_open_, false) || system_.n == 0) return;
  model::from_mode(system_, *after.mode, after.y, x_.data());
  if (is_moved_)
    for (int i = 0; i < system_.n; ++i) before_[static_cast<std::size_t>(i)] += moved_[i];
  double most = 0.0;
  for (std::size_t i = 0; i < largest_.size(); ++i) {
    largest_[i] = std::max(largest_[i], std::abs(x_[i]));
    most = std::max(most, std::abs(x_[i] - before_[i]));
  }
  const double level = after.mode->noise * linalg::norm(x_.data(), system_.size());
  if (most > rounding_levels * level) examine(before, after, time);
}

/// What seems to have changed more than the mode's rounding.
void ContinuityWatch::examine(const Side& before, const Side& after, double time) {
  double size = linalg::norm(x_.data(), system_.size()) + linalg::norm(before_.data(), system_.size());
  if (is_moved_) size += moved_.norm();
  const model::Vector drift = tolerance_ * (rate(before) + rate(after));
  for (std::size_t i = 0; i < largest_.size(); ++i) {
    const double level = after.mode->noise * size + drift[static_cast<Eigen::Index>(i)];
    const double unexplained = std::abs(x_[i] - before_[i]) - rounding_levels * level;
    largest_[i] = std::max(largest_[i], std::abs(before_[i]));
    if (!(unexplained > unexplained_[i])) continue;
    unexplained_[i] = unexplained;
    time_[i] = time;
    is_broken_ |= unexplained > broken_share * largest_[i] && unexplained > broken_levels * level;
  }
}

/// |ξ'|
model::Vector ContinuityWatch::rate(const Side& side) const {
  if (!side.mode) return model::Vector::Zero(system_.n);
  const model::Vector slope = side.mode->absolute_a * Eigen::Map<const model::Vector>(side.y, side.mode->ny).cwiseAbs();
  const model::Vector own = slope.head(side.mode->n1);
  model::Vector rate = side.mode->constrained ? model::Vector(side.mode->basis.cwiseAbs() * own) : own;
  if (side.mode->constrained) rate += side.mode->lift.cwiseAbs() * slope.tail(side.mode->ny - side.mode->n1);
  return rate;
}

ContinuityWatch::Break ContinuityWatch::worst() const {
  Break found;
  for (std::size_t i = 0; i < unexplained_.size(); ++i)
    if (unexplained_[i] > found.share * largest_[i]) found = {static_cast<int>(i), unexplained_[i] / largest_[i], time_[i]};
  return found;
}

}  // namespace pwlsim::engine
