/// What controls do beside their thresholds, for messages.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/arithmetic.hpp"
#include "engine/sparse/part_run.hpp"
#include "engine/sparse/tolerances.hpp"

namespace pwlsim::engine::sparse {

/// At the point that has been reached: what controls do, and which switches have changed since the last one.
void PartRun::watch_controls() {
  const auto first = static_cast<std::size_t>(descriptor_.first_switch());
  const bool begins = watched_on_.empty();
  watched_on_.resize(part_.watched.size());
  const auto note = [&](std::size_t port, bool is_on) {
    const std::size_t number = port - first;
    if (!begins && (watched_on_[number] != 0) != is_on) thresholds_.changed(static_cast<int>(number));
    watched_on_[number] = static_cast<char>(is_on);
  };
  for (const Gate& gate : gates_) note(gate.port(), gate.clock().is_on());
  const double unknown = largest(point_.z);
  for (WatchedControl& control : controls_) {
    note(control.port, control.holds(point_.on));
    const auto number = static_cast<int>(control.port - first);
    const double value = control.value.value(point_.z.data(), point_.w.data());
    if (thresholds_.asks_range(number)) thresholds_.see(number, value);
    if (thresholds_.asks_rest(number)) watch_rest(control, number, value, rest_noise(control, unknown));
  }
}

double PartRun::rest_noise(const WatchedControl& control, double unknown) const {
  return std::max(tolerance::guard_sign * std::max(control.level_size(), control.largest), control.rounding(unknown));
}

/// On the way to τ in a segment, which may go from one threshold to the other or back to the same: a control that leaves the one it was at does not rest there.
void PartRun::watch_inside(double tau) {
  if (!thresholds_.asks_anything()) return;
  const auto first = static_cast<std::size_t>(descriptor_.first_switch());
  const double unknown = largest(point_.z);
  for (const double share : inner_points) {
    const std::vector<double>& y = segment_->at(segment_tau_ + share * (tau - segment_tau_));
    for (std::size_t i = 0; i < controls_.size(); ++i) {
      WatchedControl& control = controls_[i];
      const auto number = static_cast<int>(control.port - first);
      const double margin = segment_->guard(static_cast<int>(first + i), y);
      const double value = control.holds(point_.on) ? control.off_level + margin : control.on_level - margin;
      if (thresholds_.asks_range(number)) thresholds_.see(number, value);
      if (!std::isnan(control.at_threshold_since) && !thresholds_.threshold_at(number, value, rest_noise(control, unknown)))
        control.at_threshold_since = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

void PartRun::watch_rest(WatchedControl& control, int number, double value, double noise) {
  const auto threshold = thresholds_.threshold_at(number, value, noise);
  if (!threshold)
    control.at_threshold_since = std::numeric_limits<double>::quiet_NaN();
  else if (std::isnan(control.at_threshold_since))
    control.at_threshold_since = point_.time;
  else if (point_.time - control.at_threshold_since > tolerance::brief_rest * request_.stop)
    thresholds_.rests(number, *threshold, control.at_threshold_since);
}

std::vector<Remark> PartRun::threshold_remarks() {
  const auto first = static_cast<std::size_t>(descriptor_.first_switch());
  for (const Gate& gate : gates_) thresholds_.trace(gate.clock(), static_cast<int>(gate.port() - first));
  return thresholds_.remarks(watched_on_, failure_.outcome == Outcome::completed && finished_);
}

}  // namespace pwlsim::engine::sparse
