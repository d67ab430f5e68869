/// Block: where events lie, and what happens there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/sparse/block.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// Of the margin at the ends of the step: how near to its zero an event is stepped to, in tolerances.
constexpr double location_share = 0.25;
/// Where a constraint may hold back a state two integrations away, what is left of its margin is divided by the length of the Euler step.
constexpr double active_location_share = 1e-6;
constexpr double sign_tolerance = 1e-12, port_sign_tolerance = 1e-9;
constexpr double shortest_share = 1e-7;  ///< of the step at hand: an event so near is at hand already
constexpr int most_locations = 24;
constexpr int most_rounds = 12;  ///< of switches answering switches at one instant
/// Levels by which the Euler steps shrink where the first ends in another position than the last: a fast motion, if it is no jump.
constexpr int most_refinement = 8;
constexpr double euler_share = 0.1;  ///< of the tolerance, for the Euler steps after an event
constexpr double room_share = 1.0 / 16.0;
/// A state has jumped when the first Euler step moves it by so many times what the second does, and by more than this part of its size.
constexpr double jump_ratio = 20.0, least_jump = 1e-6;
constexpr double unsettled_jump = 0.05;  ///< of a state's size: difference between the same jump by two steps
constexpr int crowd_limit = 400;
constexpr double crowd_fraction = 1e-9;

/// Lagrange interpolation of (t, g) at `time`.
double polynomial(const std::vector<std::pair<double, double>>& points, double time) {
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double weight = points[i].second;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i) weight *= (time - points[j].first) / (points[i].first - points[j].first);
    sum += weight;
  }
  return sum;
}

/// The zero of the polynomial through `points` less `target` between low and high, where it is positive and negative.
double zero(const std::vector<std::pair<double, double>>& points, double target, double low, double high) {
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (polynomial(points, middle) > target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Euler steps are shorter than the others: their local error is ½ (h λ)² where that of SDIRK2 is C (h λ)³.
int restart_levels(double reltol) { return 3 - static_cast<int>(std::floor(std::log2(std::pow(reltol, 1.0 / 6.0)))); }

}  // namespace

double Block::margin(const Crossing& crossing, const Position& on, const std::vector<double>& z, const std::vector<double>& w) const {
  if (!crossing.is_control) return ports_.free_variable(crossing.index, on[crossing.index] != 0, z, w);
  const Control& control = controls_[crossing.index];
  return control.margin(on, control.value.value(z.data(), w.data()));
}

double Block::margin_size(const Crossing& crossing) const {
  if (crossing.is_control) return std::max(controls_[crossing.index].level_size(), controls_[crossing.index].largest);
  return point_.on[crossing.index] != 0 ? ports_.scale().input : ports_.scale().slack;
}

double Block::sign_tolerance_of(const Crossing& crossing) const {
  return crossing.is_control || !passive_ ? sign_tolerance : port_sign_tolerance;
}

std::vector<Block::Crossing> Block::crossings(const Position& on, const Point& end, bool ports_too) const {
  std::vector<Crossing> result;
  const auto add = [&](const Crossing& crossing) {
    if (margin(crossing, on, end.z, end.w) < -sign_tolerance_of(crossing) * margin_size(crossing)) result.push_back(crossing);
  };
  for (std::size_t i = 0; i < controls_.size(); ++i) add({i, true});
  if (ports_too)
    for (std::size_t i = 0; i < static_cast<std::size_t>(descriptor_.first_switch()); ++i) add({i, false});
  return result;
}

/// Takes up a crossing that a step ends beyond. False: it was on its way before the step.
bool Block::take_up(const Crossing& crossing, const Trial& trial, std::vector<Candidate>& list) const {
  const double now = margin(crossing, point_.on, point_.z, point_.w);
  const double then = margin(crossing, point_.on, trial.end.z, trial.end.w);
  if (now <= 0.0) return false;
  Candidate candidate{crossing, 0.0, {}};
  const double share = (passive_ ? location_share : active_location_share) * reltol_;
  candidate.tolerance = std::max(share * std::max(now, -then), 4.0 * sign_tolerance_of(crossing) * margin_size(crossing));
  for (std::size_t back = 0; back < std::min<std::size_t>(history_.size(), 3); ++back) {
    const auto& sample = history_.sample(back);
    candidate.points.emplace_back(sample.time, margin(crossing, point_.on, sample.z, sample.w));
  }
  list.push_back(std::move(candidate));
  return true;
}

/// Steps to the first of the crossings that `trial`, a step of h with all ports frozen, ends beyond, a hair past it.
bool Block::locate(double h, Trial& trial) {
  std::vector<Candidate> list;
  double low = point_.time, high = trial.end.time;
  for (int round = 0; round < most_locations; ++round) {
    for (const Crossing& crossing : crossings(point_.on, trial.end, true)) {
      const bool known = std::any_of(list.begin(), list.end(), [&](const Candidate& c) {
        return c.crossing.index == crossing.index && c.crossing.is_control == crossing.is_control;
      });
      if (known || take_up(crossing, trial, list)) continue;
      restart_due_ = true;
      return true;
    }
    bool near = true;
    double next = high;
    for (const Candidate& c : list) {
      const double value = margin(c.crossing, point_.on, trial.end.z, trial.end.w);
      if (value >= 0.0) continue;
      near &= -value <= c.tolerance;
      auto points = c.points;
      points.emplace_back(high, value);
      next = std::min(next, zero(points, -0.5 * c.tolerance, low, high));
    }
    if (near || high - low <= tolerance_) break;
    if (round % 4 == 3) next = 0.5 * (low + high);
    if (next - point_.time < shortest_share * ladder(level_)) {
      restart_due_ = true;
      return true;
    }
    stepper_.sdirk2(point_, next - point_.time, true, scale_, trial_);
    if (trial_.solved != Solved::yes) return false;
    const bool beyond = !crossings(point_.on, trial_.end, true).empty();
    const Point& other = beyond ? trial.end : trial_.end;  // the end that is not the new high
    for (Candidate& c : list) {
      c.points.emplace_back(other.time, margin(c.crossing, point_.on, other.z, other.w));
      if (c.points.size() > 3) c.points.erase(c.points.begin());
    }
    (beyond ? high : low) = next;
    if (beyond) std::swap(trial, trial_);
    h = high - point_.time;
  }
  accept(trial, h);
  restart_due_ = true;
  located_ = true;
  frozen_position_ = point_.on;
  for (const Crossing& crossing : crossings(point_.on, point_, true))
    if (!crossing.is_control) point_.on[crossing.index] ^= 1;  // where the Euler steps begin to look
  return true;
}

bool Block::flip(const Point& at, bool by_sources, double time, Instant& instant, Position& on) {
  bool flipped = false;
  if (by_sources) sources_.evaluate(time, w_);
  for (const Control& control : controls_) {
    if (control.by_sources != by_sources) continue;
    const double value = by_sources ? control.of_sources.value(nullptr, w_.data()) : control.value.value(at.z.data(), at.w.data());
    const double size = std::max({control.level_size(), control.largest, std::abs(value)});
    if (control.margin(on, value) >= -sign_tolerance * size) continue;
    on[control.port] ^= 1;
    flipped = true;
    instant.mode_change = true;
  }
  return flipped;
}

/// All switches whose control has passed at this instant change together, those that only sources drive first; states stay as they are
/// until none moves.
bool Block::settle(double h, Instant& instant, Point& first) {
  for (int round = 0; round < most_rounds; ++round) {
    if (flip(point_, true, instant.time + h, instant, point_.on)) continue;
    trial_.solved = stepper_.euler(point_, h, first);
    if (trial_.solved != Solved::yes) return fail_step(trial_);
    if (!flip(first, false, instant.time + h, instant, point_.on)) return true;
  }
  fail(Outcome::no_solution, "E-no-settle",
       fmt::format("the switches find no rest at t = {} s: each position undoes its own condition; try a hysteresis Vh", instant.time), {});
  return false;
}

/// Of inductors the flux counts: currents of perfectly coupled ones may hand it to each other.
bool Block::jumped(const Point& before, const Point& first, const Point& second) const {
  const auto& states = descriptor_.states();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i].is_current) {
      const auto row = static_cast<std::size_t>(states[i].plus);
      const double size = states[i].storage / descriptor_.r0() * scale_.size(i, first.z);
      if (std::abs(first.y[row] - before.y[row]) > jump_ratio * std::abs(second.y[row] - first.y[row]) + least_jump * std::abs(size))
        return true;
      continue;
    }
    const double a = start_states_.empty() ? states[i].value(before.z.data()) : start_states_[i], b = states[i].value(first.z.data()),
                 c = states[i].value(second.z.data());
    if (std::abs(b - a) > jump_ratio * std::abs(c - b) + least_jump * scale_.size(i, first.z)) return true;
  }
  return false;
}

/// Two more Euler steps in one position, however many it takes.
bool Block::start_rates(double h) {
  for (int round = 0; round < most_rounds; ++round) {
    trial_.solved = stepper_.euler(euler_[round == 0 ? 0 : 2], h, euler_[1]);
    if (trial_.solved == Solved::yes) trial_.solved = stepper_.euler(euler_[1], h, euler_[2]);
    if (trial_.solved != Solved::yes) return false;
    if (euler_[1].on == euler_[2].on) break;
  }
  return true;
}

/// Where a jump is of first order, a shorter Euler step ends in the same place. In an active network it need not be, and then no step would do.
bool Block::jump_settles(double h) {
  Point shorter;
  trial_.solved = stepper_.euler(point_, 0.25 * h, shorter);
  if (trial_.solved != Solved::yes) return fail_step(trial_);
  const auto& states = descriptor_.states();
  double difference = 0.0, motion = 0.0, largest = 0.0;
  for (const State& state : states) {
    const double first = state.measure(euler_[0].z.data());
    difference = std::max(difference, std::abs(state.measure(shorter.z.data()) - first));
    motion = std::max(motion, std::abs(state.measure(euler_[1].z.data()) - first));
    largest = std::max(largest, std::abs(first));
  }
  if (difference <= std::max(unsettled_jump * largest, 2.0 * motion)) return true;
  fail(Outcome::no_solution, "E-jump-order",
       fmt::format("the state jumps at t = {} s by impulses of higher order, which this engine cannot step over; try --engine exact",
                   point_.time),
       {});
  return false;
}

bool Block::restart(double time) {
  restart_due_ = false;
  Instant instant;
  instant.time = time;
  if (request_.events)
    for (std::size_t i = 0; i < signals_.size(); ++i) signals_before_[i] = signals_[i].value(point_.z.data(), point_.w.data());
  if (sources_.next_break() <= time + break_tolerance_) instant.source_edge = sources_.advance(time, break_tolerance_);
  const Position before = located_ ? frozen_position_ : point_.on;
  located_ = false;
  const int levels = restart_levels(reltol_);
  const double room = std::min(sources_.next_break(), request_.stop > time + tolerance_ ? request_.stop : model::forever) - time;
  int level = level_ + levels;
  while (gamma_sdirk * ladder(level) > room_share * room) ++level;
  int refined = 0, shortened = 0;
  while (true) {
    const double h = gamma_sdirk * ladder(level + refined + shortened);
    if (!settle(h, instant, euler_[0])) return false;
    if (!start_rates(h)) return fail_step(trial_);
    scale_.note(euler_[2].z);
    const bool end = level + refined + shortened >= last_level;
    if (!end && euler_[0].on != euler_[2].on && refined < most_refinement) {
      refined += 2;
    } else if (!end && stepper_.euler_error(euler_[1], euler_[2], h, scale_) > euler_share * reltol_) {
      shortened += 2;
    } else {
      break;
    }
  }
  level += refined + shortened;
  level_ += refined + shortened;
  instant.mode_change |= euler_[2].on != before;
  instant.jump = jumped(point_, euler_[0], euler_[1]);
  if (!passive_ && !jump_settles(gamma_sdirk * ladder(level))) return false;
  start_states_.clear();
  history_.clear();
  for (int i = 1; i < 3; ++i) history_.add(euler_[i].time, euler_[i].z, euler_[i].w, false);
  std::swap(point_, euler_[2]);
  scale_.note(point_.z);
  ports_.note_scale(point_.z, point_.w);
  note_signals();
  steps_ += 3;
  if (time > 0.0 && instant.happened()) {
    ++events_;
    jumps_ += instant.jump ? 1 : 0;
    instant_ = instant;
  }
  if (time == 0.0) start_projected_ = instant.jump;
  return watch_crowd(time);
}

bool Block::watch_crowd(double time) {
  if (time - crowd_start_ > crowd_fraction * request_.stop) {
    crowd_start_ = time;
    crowd_ = 0;
  }
  if (++crowd_ < crowd_limit) return true;
  fail(Outcome::accumulation, "E-accumulation",
       fmt::format("events accumulate at t = {} s ({} of them within {} s); try a resistor, capacitor or hysteresis that separates them",
                   time, crowd_, time - crowd_start_),
       {});
  return false;
}

bool Block::begin(const Start& start) {
  const auto n = static_cast<std::size_t>(descriptor_.size());
  point_.time = 0.0;
  point_.on = start.on;
  point_.z.assign(n, 0.0);
  point_.y.resize(n);
  point_.k.assign(n, 0.0);
  sources_.evaluate(0.0, point_.w);
  descriptor_.memory_of_states(start.states, point_.y.data());
  start_states_ = start.states;
  scale_.note_values(start.states);
  for (std::size_t i = 0; i < start.states.size(); ++i)
    if (!descriptor_.states()[i].is_current) ports_.note_voltage(std::abs(start.states[i]));
  return restart(0.0);
}

}  // namespace pwlsim::engine::sparse
