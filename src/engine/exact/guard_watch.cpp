#include "engine/exact/guard_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

namespace {

/// Segments that are looked into; of those behind them one in so many.
constexpr std::uint64_t first_segments = 256, selection = 32;
/// Points inside: one for each unit of rate·length, up to so many. Where that is below one, a guard is nearly a parabola, which cannot dip between two looks. Beside fast decays the
/// rate is that of the slow motion, and one point is for them.
constexpr double most_points = 8.0;
constexpr double pi = 3.14159265358979323846;
constexpr int few_ports = 4;  ///< whose rows by themselves cost less than all rows together

}  // namespace

GuardWatch::GuardWatch(const model::System& system) : system_(system) {
  const auto ports = static_cast<std::size_t>(system.diodes);
  values_.resize(ports + 2 * system.controls.size());
  for (auto* v : {&largest_, &below_, &time_}) v->assign(2 * ports, 0.0);
}

void GuardWatch::look(const model::Mode& mode, const double* y, double time) {
  if (system_.diodes == 0 || mode.ny == 0) return;
  const bool are_few = system_.diodes <= few_ports;
  if (!are_few) linalg::multiply(mode.guards, y, values_.data());
  for (int i = 0; i < system_.diodes; ++i) {
    const double value = are_few ? linalg::row_times(mode.guards, i, y) : values_[static_cast<std::size_t>(i)];
    double& largest = largest_[2 * static_cast<std::size_t>(i) + static_cast<std::size_t>(mode.active.contains(i))];
    largest = std::max(largest, std::abs(value));
    if (value < 0.0) find_violation(mode, y, i, value, time);
  }
}

void GuardWatch::look_inside(const model::Mode& mode, const double* y0, double begin, double length) {
  if (system_.diodes == 0 || (++segments_ > first_segments && segments_ % selection != 0)) return;
  const double units = mode.slow ? 1.0 + mode.slow->flow.rate() * length : mode.flow.rate() * length;
  const double points = std::min(most_points, std::floor(units));
  if (!(points >= 1.0)) return;
  const auto ny = static_cast<std::size_t>(mode.ny);
  y_.resize(std::max(y_.size(), ny));
  work_.resize(2 * y_.size());
  for (double k = 0.5; k < points; ++k) {
    const double tau = 0.5 * length * (1.0 - std::cos(pi * k / points));
    std::copy_n(y0, ny, y_.begin());
    mode.flow.apply_once(tau, y_.data(), work_.data());
    look(mode, y_.data(), begin + tau);
  }
}

void GuardWatch::find_violation(const model::Mode& mode, const double* y, int port, double value, double time) {
  const double own_level = model::guard_rounding(mode, port, y, mode.guard_norm[port] * linalg::norm(y, mode.ny), 0.0);
  const double level = std::max(own_level, tolerance::remainder * *std::max_element(largest_.begin(), largest_.end()));
  const double below = -value - rounding_levels * level;
  const std::size_t quantity = 2 * static_cast<std::size_t>(port) + static_cast<std::size_t>(mode.active.contains(port));
  if (!(below > below_[quantity])) return;
  below_[quantity] = below;
  time_[quantity] = time;
  is_broken_ |= below > broken_share * largest_[quantity] && below > broken_levels * level;
}

GuardWatch::Violation GuardWatch::worst() const {
  Violation found;
  for (std::size_t q = 0; q < below_.size(); ++q) {
    if (!(below_[q] > 0.0) || below_[q] <= found.share() * largest_[q]) continue;
    const model::Port& port = system_.port[q / 2];
    const bool is_input = q % 2 == 1;
    const double unit = is_input ? port.u_unit : port.y_unit;
    found = {static_cast<int>(q / 2), is_input, below_[q] * unit, largest_[q] * unit, time_[q]};
  }
  return found;
}

std::string violation_text(const model::System& system, const GuardWatch::Violation& v) {
  const model::Port& port = system.port[static_cast<std::size_t>(v.port)];
  const bool is_current = v.is_input == port.input_is_current;
  return fmt::format("{} {} by {:.3g} {} (its largest is {:.3g}) at t = {} s", port.name,
                     is_current ? "conducts backwards" : "blocks forwards", v.value, is_current ? "A" : "V", v.largest, v.time);
}

}  // namespace pwlsim::engine
