#include "engine/exact/island_controls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/exact/tolerances.hpp"

namespace pwlsim::engine {

namespace {

/// A switch without hysteresis is off where its control rests at the threshold.
bool is_off_at_rest(const model::Control& control) { return control.on_level == control.off_level; }

std::span<const double> entries(const linalg::Vector& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

}  // namespace

IslandControls::IslandControls(const model::System& system, model::Selector& selector)
    : system_(system), selector_(selector), source_departure_(*system.exosystem) {
  rows_.resize(system_.controls.size());
  departures_.resize(system_.controls.size());
  passed_.resize(system_.controls.size());
  work_.resize(2 * static_cast<std::size_t>(system.size()));
  for (const auto& control : system_.controls) {
    const double noise = tolerance::row_entry * std::max(largest(entries(control.value.state)), 1e-300);
    const bool reads_ports = largest(entries(control.value.input)) > noise;
    const bool reads_state = largest(entries(control.value.state).first(static_cast<std::size_t>(system_.n))) > noise;
    reads_.push_back(reads_ports ? Reads::ports : reads_state ? Reads::state : Reads::sources);
    alike_.push_back(first_alike(alike_.size()));
  }
  source_departures_.resize(2 * system_.controls.size());
}

void IslandControls::set_tolerance(double tolerance) {
  tolerance_ = tolerance;
  source_departure_.set_tolerance(tolerance);
}

void IslandControls::begin_instant() { std::fill(passed_.begin(), passed_.end(), 0); }

bool IslandControls::sense_state() const {
  return std::any_of(reads_.begin(), reads_.end(), [](Reads reads) { return reads != Reads::sources; });
}

IslandControls::Alike IslandControls::first_alike(std::size_t control) const {
  const model::Control& c = system_.controls[control];
  if (reads_[control] != Reads::sources) return {control, false};
  for (std::size_t i = 0; i < control; ++i) {
    const model::Control& other = system_.controls[i];
    if (reads_[i] != Reads::sources) continue;
    if (c.value.state == other.value.state && c.on_level == other.on_level && c.off_level == other.off_level) return {i, false};
    if (c.value.state == -other.value.state && c.on_level == -other.off_level && c.off_level == -other.on_level) return {i, true};
  }
  return {control, false};
}

int IslandControls::row(std::size_t i, const std::vector<char>& on) const {
  const bool is_on = on[static_cast<std::size_t>(system_.controls[i].driven)] != 0;
  return system_.diodes + 2 * static_cast<int>(i) + (is_on ? 0 : 1);
}

void IslandControls::take_slope_at_threshold(const model::Mode& mode, int row, const double* y, model::Departure& departure) {
  const double value = departure.value;
  linalg::multiply(mode.flow.a(), y, work_.data());
  const double slope = linalg::row_times(mode.guards, row, work_.data());
  if (std::abs(value) > tolerance_ * std::abs(slope) || (value > 0.0) == (slope > 0.0)) return;
  // What moves faster than that has its say, too.
  ahead_.assign(y, y + mode.ny);
  mode.flow.apply(tolerance_, ahead_.data(), work_.data());
  if ((linalg::row_times(mode.guards, row, ahead_.data()) > 0.0) != (value > 0.0)) departure = {1, slope};
}

/// Of the controls that read the state or a port, in the mode at y: numbers_, rows_, departures_; false: none.
bool IslandControls::find_departures(const model::Mode& mode, const double* y, const std::vector<char>& on) {
  rows_.clear();
  numbers_.clear();
  for (std::size_t i = 0; i < system_.controls.size(); ++i) {
    if (reads_[i] == Reads::sources) continue;
    rows_.push_back(row(i, on));
    numbers_.push_back(static_cast<int>(i));
  }
  if (rows_.empty()) return false;
  selector_.verifier().departures(mode, y, rows_, departures_.data());
  const double reach =
      tolerance_ * mode.norm_a * linalg::norm(y, mode.ny);  // the farthest that a guard of norm 1 moves within the tolerance
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    model::Departure& departure = departures_[i];
    if (departure.order != 0 || std::abs(departure.value) > reach * mode.guard_norm[rows_[i]]) continue;
    // One that has changed already at this instant does not come back before its time.
    if (departure.value > 0.0 && passed_[static_cast<std::size_t>(numbers_[i])] != 0) continue;
    take_slope_at_threshold(mode, rows_[i], y, departure);
  }
  return true;
}

const std::vector<int>& IslandControls::violated(const model::Mode& mode, const double* y, const std::vector<char>& on) {
  violated_.clear();
  if (!find_departures(mode, y, on)) return violated_;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!(departures_[i].value < 0.0)) continue;
    violated_.push_back(numbers_[i]);
    passed_[static_cast<std::size_t>(numbers_[i])] = 1;
  }
  return violated_;
}

const std::vector<int>& IslandControls::at_rest(const std::vector<char>& on) {
  violated_.clear();
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const model::Control& control = system_.controls[static_cast<std::size_t>(numbers_[i])];
    if (departures_[i].order < 0 && is_off_at_rest(control) && on[static_cast<std::size_t>(control.driven)] != 0)
      violated_.push_back(numbers_[i]);
  }
  return violated_;
}

/// Of a control that reads sources, as they are taken: negative where its switch must change.
double IslandControls::source_departure_of(std::size_t i, bool is_on) {
  const Alike alike = alike_[i];
  const bool other_is_on = is_on != alike.is_mirrored;
  double& departure = source_departures_[2 * alike.control + (other_is_on ? 1 : 0)];
  if (!std::isnan(departure)) return departure;
  const model::Control& other = system_.controls[alike.control];
  const double value = source_departure_.of(other.value.state.data() + system_.n, other_is_on ? other.off_level : other.on_level);
  return departure = other_is_on ? value : -value;
}

const std::vector<int>& IslandControls::violated_without_mode(const model::Exosystem::Phase& phase, double time,
                                                              const std::vector<double>& x, const std::vector<char>& on, bool by_state) {
  violated_.clear();
  bool taken = false;
  for (std::size_t i = 0; i < system_.controls.size(); ++i) {
    const model::Control& control = system_.controls[i];
    const bool is_on = on[static_cast<std::size_t>(control.driven)] != 0;
    double departure = 0.0;
    bool rests = false;
    if (reads_[i] == Reads::sources) {
      if (!std::exchange(taken, true) && source_departure_.take(phase, time, x.data() + system_.n))
        std::fill(source_departures_.begin(), source_departures_.end(), std::numeric_limits<double>::quiet_NaN());
      departure = source_departure_of(i, is_on);
      rests = departure == 0.0 && is_on && is_off_at_rest(control);
    }
    if (reads_[i] == Reads::state && by_state) {
      const double value = control.value.state.dot(Eigen::Map<const model::Vector>(x.data(), system_.size()));
      departure = is_on ? value - control.off_level : control.on_level - value;
    }
    if (departure < 0.0 || rests) violated_.push_back(static_cast<int>(i));
  }
  return violated_;
}

}  // namespace pwlsim::engine
