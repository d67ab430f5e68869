#include "engine/sparse/interior_point.hpp"

#include <algorithm>
#include <cmath>

#include "base/arithmetic.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr int most_iterations = 60;
constexpr double to_boundary = 0.995;
/// Of what u, or s, was before the iteration: one of a port stays, the other goes.
constexpr double stays = 0.5, goes = 0.1;

double size_of(const std::vector<double>& values) {
  const double most = largest(values);
  return most > 0.0 ? most : 1.0;
}

}  // namespace

/// All diodes half open, then away from the boundary.
void InteriorPoint::start(const Stage& stage, const Position& on) {
  const auto diodes = static_cast<std::size_t>(descriptor_.first_switch());
  for (auto* v : {&u_, &s_}) v->assign(diodes, 1.0);
  for (auto* v : {&du_, &ds_, &miss_u_, &miss_s_}) v->assign(diodes, 0.0);
  is_free_.resize(diodes);
  for (std::size_t i = 0; i < diodes; ++i) is_free_[i] = stage.may_change(i, descriptor_.ports()[i], on);
  step_.assign(static_cast<std::size_t>(descriptor_.size()), 0.0);
  if (!factor(stage, on)) return;
  take_residuals(stage, on);
  for (std::size_t i = 0; i < diodes; ++i) {  // u + s = 0: any diode conducts both ways
    if (is_free_[i] != 0) {
      miss_u_[i] += 1.0;
      miss_s_[i] += 1.0;
    }
    u_[i] = s_[i] = 0.0;
  }
  direction(0.0, false);
  for (std::size_t i = 0; i < step_.size(); ++i) step_[i] += move_[i];
  take_residuals(stage, on);
  const double most_u = size_of(miss_u_), most_s = size_of(miss_s_);
  for (std::size_t i = 0; i < diodes; ++i) {
    if (is_free_[i] == 0) continue;
    const double u = miss_u_[i], s = miss_s_[i];
    u_[i] = std::max(std::abs(u), tolerance::interior_start * most_u);
    s_[i] = std::max(std::abs(s), tolerance::interior_start * most_s);
    miss_u_[i] = u - u_[i];
    miss_s_[i] = s - s_[i];
  }
}

bool InteriorPoint::factor(const Stage& stage, const Position& on) {
  closing_.of_slack.resize(on.size());
  closing_.of_input.resize(on.size());
  for (std::size_t i = 0; i < on.size(); ++i) {
    const bool diode = is_free(i);
    closing_.of_slack[i] = diode ? u_[i] / (u_[i] + s_[i]) : (on[i] != 0 ? 1.0 : 0.0);
    closing_.of_input[i] = 1.0 - closing_.of_slack[i];
  }
  unit_ = descriptor_.mean_admittance(stage.shift);
  descriptor_.matrix(stage.shift, closing_, unit_, values_);
  const auto factored = factored_ ? factor_.refactor(values_) : factor_.factor(values_);
  factored_ = factored == linalg::Factored::good;
  return factored_;
}

/// What is missed by the equations, and by u and s as forms of z.
void InteriorPoint::take_residuals(const Stage& stage, const Position& on) {
  const std::size_t n = step_.size();
  residual_.resize(n);
  z_.resize(n);
  for (std::size_t i = 0; i < n; ++i) z_[i] = stage.from[i] + step_[i];
  std::fill(closing_.of_slack.begin(), closing_.of_slack.end(), 0.0);
  std::fill(closing_.of_input.begin(), closing_.of_input.end(), 0.0);
  descriptor_.matrix(stage.shift, closing_, 1.0, values_);
  linalg::multiply(descriptor_.pattern(), values_, step_.data(), residual_.data());
  for (std::size_t i = 0; i < n; ++i) residual_[i] = stage.right[i] - residual_[i];
  for (std::size_t i = 0; i < on.size(); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    const auto row = static_cast<std::size_t>(port.row);
    residual_[row] = is_free(i) ? 0.0 : -stage.free_variable(port, on[i] == 0, z_.data());
    if (!is_free(i)) continue;
    miss_u_[i] = z_[row] - u_[i];
    miss_s_[i] = stage.free_variable(port, false, z_.data()) - s_[i];
  }
}

/// Towards u s = target; `corrected`: with the product of the last direction in it.
void InteriorPoint::direction(double target, bool corrected) {
  move_ = residual_;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    if (is_free_[i] == 0) continue;
    const double product = target - u_[i] * s_[i] - (corrected ? du_[i] * ds_[i] : 0.0);
    const double sum = u_[i] + s_[i] > 0.0 ? u_[i] + s_[i] : 1.0;
    const double share = u_[i] + s_[i] > 0.0 ? u_[i] / sum : 0.5;
    move_[static_cast<std::size_t>(descriptor_.ports()[i].row)] = product / sum - (1.0 - share) * miss_u_[i] - share * miss_s_[i];
  }
  factor_.solve(move_.data());
  for (std::size_t i = static_cast<std::size_t>(descriptor_.nodes()); i < move_.size(); ++i) move_[i] *= unit_;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    if (is_free_[i] == 0) continue;
    const DescriptorPort& port = descriptor_.ports()[i];
    du_[i] = port.response(true, move_.data()) + miss_u_[i];
    ds_[i] = port.response(false, move_.data()) + miss_s_[i];
  }
}

double InteriorPoint::longest() const {
  double length = 1.0;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    if (du_[i] < 0.0) length = std::min(length, -u_[i] / du_[i]);
    if (ds_[i] < 0.0) length = std::min(length, -s_[i] / ds_[i]);
  }
  return length;
}

/// Mean of u s after a step of that length.
double InteriorPoint::gap(double length) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < u_.size(); ++i) sum += (u_[i] + length * du_[i]) * (s_[i] + length * ds_[i]);
  return sum / static_cast<double>(u_.size());
}

/// Whether each diode shows on which side it ends, whatever the sizes of u and s are: of two that are both on their way to zero or not the ratios to what they were
/// tell (El-Bakry, Tapia and Zhang, SIAM Review 36, 1994).
bool InteriorPoint::is_decided() const {
  for (std::size_t i = 0; i < u_.size(); ++i) {
    if (is_free_[i] == 0) continue;
    const double u = u_[i] / last_u_[i], s = s_[i] / last_s_[i];
    if (!(std::max(u, s) >= stays && std::min(u, s) <= goes)) return false;
  }
  return true;
}

void InteriorPoint::take_position(const Stage& stage, const std::vector<double>& of_u, const std::vector<double>& of_s,
                                  Position& on) const {
  for (std::size_t i = 0; i < u_.size(); ++i)
    on[i] = is_free_[i] != 0 ? u_[i] / of_u[i] > s_[i] / of_s[i] : stage.disputed != nullptr && on[i] != 0;
}

bool InteriorPoint::solve(const Stage& stage, const PortScale& scale, Position& on) {
  start(stage, on);
  if (!factored_) return false;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    take_residuals(stage, on);
    const double most_u = std::max(size_of(u_), scale.input), most_s = std::max(size_of(s_), scale.slack), mean = gap(0.0);
    if (!std::isfinite(mean)) return false;
    if (mean <= tolerance::interior_gap * most_u * most_s && size_of(miss_u_) <= tolerance::interior_residual * most_u &&
        size_of(miss_s_) <= tolerance::interior_residual * most_s) {
      take_position(stage, std::vector(u_.size(), most_u), std::vector(s_.size(), most_s), on);
      return true;
    }
    if (stage.disputed != nullptr && iteration > 1 && is_decided()) {  // a change has no sizes that u and s could be judged against
      take_position(stage, last_u_, last_s_, on);
      return true;
    }
    last_u_ = u_;
    last_s_ = s_;
    if (!factor(stage, on)) return false;
    direction(0.0, false);
    const double affine = gap(longest());
    const double share = std::pow(std::clamp(affine / mean, 0.0, 1.0), 3);
    direction(share * mean, true);
    const double length = std::min(1.0, to_boundary * longest());
    for (std::size_t i = 0; i < step_.size(); ++i) step_[i] += length * move_[i];
    for (std::size_t i = 0; i < u_.size(); ++i) {
      u_[i] += length * du_[i];
      s_[i] += length * ds_[i];
    }
  }
  return false;
}

}  // namespace pwlsim::engine::sparse
