/// PartRun: where guards pass zero in a step.
#include <algorithm>
#include <cmath>

#include "base/arithmetic.hpp"
#include "engine/sparse/part_run.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// A margin that is below zero only inside the step must be so by this part of the tolerance: the parabola is not better.
constexpr double dip_share = 0.1;
constexpr int most_locations = 60;
constexpr int most_idle_located = 20;  ///< passages in a row that changed nothing: the next need not be met to rounding

/// The first x in (0, reach] at which the parabola through (0, a), (first_stage, b), (1, c) passes zero downwards; negative: nowhere. At `reach` it must
/// be below −tolerance, inside below −dip.
double first_passage(double a, double b, double c, double reach, double tolerance, double dip) {
  constexpr double s = first_stage;
  const double rise = (b - a) / s;
  const double curvature = (c - b) / (1.0 - s) - rise;
  const double slope = rise - curvature * s;
  if (a > 0.0 && c > 0.0 && a + 0.5 * slope > 0.0) return -1.0;  // the triangle around it lies above zero
  const auto value = [&](double x) { return a + x * (slope + x * curvature); };
  double below = reach;
  if (!(value(reach) < -tolerance)) {
    const double bottom = curvature > 0.0 ? -slope / (2.0 * curvature) : -1.0;
    if (!(bottom > 0.0 && bottom < reach && value(bottom) < -dip)) return -1.0;
    below = bottom;
  }
  if (a <= 0.0) return slope < 0.0 || below < reach ? 0.0 : below;
  const double root = std::sqrt(std::max(0.0, slope * slope - 4.0 * curvature * a));
  return root > slope ? std::min(2.0 * a / (root - slope), below) : below;
}

}  // namespace

double PartRun::margin(std::size_t index, bool is_control, const Point& at) const {
  if (!is_control) return descriptor_.ports()[index].free_variable(point_.on[index] != 0, at.z.data(), at.w.data());
  return controls_[index].margin(point_.on, controls_[index].value.value(at.z.data(), at.w.data()));
}

double PartRun::margin_size(std::size_t index, bool is_control) const {
  if (is_control) return std::max(controls_[index].level_size(), controls_[index].largest);
  return point_.on[index] != 0 ? ports_.input_size(index, point_.on, 0.0, ports_.largest_voltage(point_.z)) : ports_.scale().slack;
}

double PartRun::largest_input(const Point& at) const {
  double most = 0.0;
  for (const DescriptorPort& port : descriptor_.ports()) most = std::max(most, std::abs(at.z[static_cast<std::size_t>(port.row)]));
  return most;
}

/// What passes its zero in the part `reach` of a step of length h (trial_), the first to do so first.
std::vector<PartRun::Crossing> PartRun::crossings(double h, double reach) {
  std::vector<Crossing> result;
  const double input = largest_input(trial_.end), shift = 1.0 / (diagonal * h), unknown = largest(point_.z);
  const double voltage = std::max(ports_.largest_voltage(point_.z), ports_.largest_voltage(trial_.end.z));
  const auto examine = [&](std::size_t i, bool is_control) {
    const bool is_input = !is_control && point_.on[i] != 0;
    const double size = is_input ? ports_.input_size(i, point_.on, input, voltage) : margin_size(i, is_control);
    double tolerance = (is_control || !passive_ ? tolerance::guard_sign : tolerance::passive_guard_sign) * size;
    if (is_control) tolerance = std::max(tolerance, controls_[i].rounding(unknown));
    const double start = margin(i, is_control, point_), stage = margin(i, is_control, trial_.stage),
                 end = margin(i, is_control, trial_.end);
    const auto passage = [&] {
      return first_passage(start, stage, end, reach, tolerance, std::max(tolerance, dip_share * reltol_ * size));
    };
    const bool overdue = is_control && start < -2.0 * tolerance;  // it jumped there in the last Euler step
    double at = overdue ? 0.0 : passage();
    if (at >= 0.0 && is_input) {
      tolerance += ports_.rounding_of_input(shift, point_.on, i, voltage);
      at = passage();
    }
    if (at >= 0.0) result.push_back({i, is_control, at});
  };
  for (std::size_t i = 0; i < controls_.size(); ++i) examine(i, true);
  for (std::size_t i = 0; i < static_cast<std::size_t>(descriptor_.first_switch()); ++i)
    if (!descriptor_.ports()[i].blocks(point_.on)) examine(i, false);
  std::stable_sort(result.begin(), result.end(), [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
  return result;
}

/// Goes to the first of the crossings; what passes there may change sides next.
bool PartRun::cut(double h, const std::vector<Crossing>& list, double reach) {
  const Crossing& first = list.front();
  position_before_ = point_.on;
  if (first.at > 0.0 && !passive_ && stall_.idle_passages() < most_idle_located) {
    if (!locate(h, first)) return false;
  } else if (first.at > 0.0) {
    accept(trial_, std::min(first.at, reach));
  }
  for (const Crossing& crossing : list)  // where the Euler steps begin to look
    if (!crossing.is_control && crossing.at <= first.at + tolerance::same_passage) point_.on[crossing.index] ^= 1;
  restart_due_ = true;
  return true;
}

/// Steps taken anew until one ends where a margin is zero to rounding.
bool PartRun::locate(double h, Crossing crossing) {
  double low = 0.0, high = 1.0, low_value = margin(crossing.index, crossing.is_control, point_);
  double high_value = margin(crossing.index, crossing.is_control, trial_.end);
  const double tolerance = tolerance::guard_sign * margin_size(crossing.index, crossing.is_control);
  double next = crossing.at;
  for (int round = 0; round < most_locations; ++round) {
    stepper_.tr_bdf2(point_, next * h, scale_, trial_);
    if (trial_.solved != Solved::yes) return fail_step(trial_.solved, trial_.error);
    const double value = margin(crossing.index, crossing.is_control, trial_.end);
    (value > 0.0 ? low : high) = next;
    (value > 0.0 ? low_value : high_value) = value;
    if (std::abs(value) <= tolerance || (high - low) * h <= tolerance_) break;
    const bool straight = round % 3 != 2 && low_value > 0.0 && high_value < 0.0;
    next = straight ? low + (high - low) * low_value / (low_value - high_value) : 0.5 * (low + high);
  }
  accept(trial_, 1.0);
  return true;
}

}  // namespace pwlsim::engine::sparse
