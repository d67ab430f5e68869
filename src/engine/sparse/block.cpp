#include "engine/sparse/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace pwlsim::engine::sparse {

namespace {

constexpr double most_steps_of_run = 1.0 / 64.0;     ///< the largest step, of the run
constexpr double most_steps_of_period = 1.0 / 16.0;  ///< and of a sinusoid's period
/// Likewise, times √reltol: currents of capacitors in a loop with a source are known to the order of h, so that the instants at which they pass
/// zero are, and the states after them to that of h².
constexpr double most_for_loops = 3.2;
constexpr int first_level = 6;
/// Growth waits until the error of the doubled step is this part of the tolerance.
constexpr double growth_share = 0.5;
constexpr double merge_fraction = 1e-14;  ///< of the run: instants closer than this are one
constexpr double break_fraction = 1e-11;  ///< and breakpoints of sources closer than this
/// What a change of sides may do to a saved signal, in tolerances, before it is located: as much as the polynomial between steps errs.
constexpr double signal_tolerances = 20.0;
constexpr std::size_t most_positions = 1u << 20;

}  // namespace

Block::Block(const model::Network& network, const Request& request, double reltol)
    : request_(request),
      reltol_(reltol),
      descriptor_(network),
      factors_(descriptor_, reltol),
      ports_(descriptor_, factors_, largest_held_voltage(network)),
      sources_(network),
      stepper_(descriptor_, ports_, sources_),
      scale_(descriptor_, largest_held_voltage(network)),
      controls_(controls_of(network, descriptor_)),
      certificate_(descriptor_) {
  for (const auto& signal : network.signals) {
    signals_.push_back(descriptor_.form(signal.form));
    signals_read_sources_ |= !signals_.back().w.empty();
  }
  signal_scale_.assign(signals_.size(), 0.0);
  signals_before_.assign(signals_.size(), 0.0);
  const double of_period = std::min(most_steps_of_period, most_for_loops * std::sqrt(reltol));
  h_max_ = std::min(most_steps_of_run * request.stop, of_period * sources_.shortest_period());
  level_ = first_level;
  tolerance_ = merge_fraction * request.stop;
  break_tolerance_ = break_fraction * request.stop;
  passive_ = descriptor_.passive();
}

void Block::signals(double time, double* values) {
  const auto weights = history_.weights(time);
  if (signals_read_sources_) sources_.evaluate(time, w_);
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    values[i] = history_.interpolate(signals_[i], weights);
    for (const auto& part : signals_[i].w) values[i] += part.coefficient * w_[static_cast<std::size_t>(part.index)];
  }
}

void Block::note_signals() {
  for (Control& control : controls_)
    control.largest = std::max(control.largest, std::abs(control.value.value(point_.z.data(), point_.w.data())));
  for (std::size_t i = 0; i < signals_.size(); ++i)
    signal_scale_[i] = std::max(signal_scale_[i], std::abs(signals_[i].value(point_.z.data(), point_.w.data())));
}

/// Until the step behind it is taken, a step's rows are not as good as they will be.
double Block::known() const { return stands_before_instant() || finished_ || history_.size() < 2 ? point_.time : history_.sample(1).time; }

bool Block::stands_before_instant() const {
  return restart_due_ || sources_.next_break() <= point_.time + break_tolerance_ || point_.time >= request_.stop - tolerance_;
}

bool Block::advance() {
  instant_.reset();
  const bool at_break = sources_.next_break() <= point_.time + break_tolerance_;
  if (restart_due_ || at_break) return restart(point_.time);
  if (point_.time >= request_.stop - tolerance_) {
    finished_ = true;
    return true;
  }
  return step();
}

/// The step of the ladder, unless a breakpoint or the end is nearer than two of them.
double Block::step_size() const {
  const double remaining = std::min(sources_.next_break(), request_.stop) - point_.time;
  const double h = ladder(level_);
  if (remaining <= h * (1.0 + 1e-9)) return remaining;
  return remaining < 2.0 * h ? 0.5 * remaining : h;
}

bool Block::step() {
  rejected_ = false;
  while (true) {
    const double h = step_size();
    stepper_.sdirk2(point_, h, false, scale_, trial_);
    if (trial_.solved == Solved::singular) return fail_step(trial_);
    if (trial_.solved != Solved::yes) {
      if (!reduce(model::forever)) return fail_step(trial_);
      continue;
    }
    if (trial_.end.on == point_.on && trial_.error > reltol_) {
      if (!reduce(trial_.error)) return fail_step(trial_);
      continue;
    }
    bool accepted = true;
    if (!settle_changes(h, trial_, accepted)) return false;
    if (!accepted) continue;
    return true;
  }
}

/// What changed sides in the step: left where it is, located, or the step is taken anew (`accepted` false).
bool Block::settle_changes(double h, Trial& trial, bool& accepted) {
  std::vector<Crossing> candidates = crossings(point_.on, trial.end, false);
  const bool changed = trial.end.on != point_.on;
  if (!changed && candidates.empty()) {
    accept(trial, h);
    control_size(trial.error);
    return true;
  }
  stepper_.sdirk2(point_, h, true, scale_, frozen_);
  if (frozen_.solved == Solved::singular) return fail_step(frozen_);
  const bool within = trial.error <= reltol_ && !request_.events && !matters(trial.end, frozen_.end);
  if (candidates.empty() && within) {
    ++events_;
    accept(trial, h);
    control_size(trial.error);
    return true;
  }
  accepted = false;
  if (frozen_.error > reltol_) return reduce(frozen_.error) || fail_step(frozen_);
  candidates = crossings(point_.on, frozen_.end, true);
  if (candidates.empty()) {
    // Changed sides on the way and is back, or stands on the edge.
    if (trial.error > reltol_) return reduce(trial.error) || fail_step(trial);
    accept(trial, h);
    accepted = true;
    return true;
  }
  accepted = true;
  return locate(h, frozen_) || fail_step(frozen_);
}

/// Whether two ends of a step differ in a saved signal by more than rows are good for.
bool Block::matters(const Point& a, const Point& b) const {
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const double x = signals_[i].value(a.z.data(), a.w.data());
    const double y = signals_[i].value(b.z.data(), b.w.data());
    if (std::abs(x - y) > signal_tolerances * reltol_ * std::max({signal_scale_[i], std::abs(x), std::abs(y)})) return true;
  }
  return false;
}

void Block::accept(Trial& trial, double h) {
  const bool kink = trial.end.on != point_.on;
  certificate_.add(point_, trial, h, ports_);
  std::swap(point_, trial.end);
  const double next = std::min(sources_.next_break(), request_.stop);
  if (std::abs(point_.time - next) <= 1e-9 * h) point_.time = next;
  scale_.note(point_.z);
  ports_.note_scale(point_.z, point_.w);
  note_signals();
  history_.add(point_.time, point_.z, point_.w, kink);
  ++steps_;
  if (positions_.size() < most_positions) positions_.insert(std::hash<std::string_view>()({point_.on.data(), point_.on.size()}));
}

void Block::control_size(double error) {
  if (rejected_) return;
  const double eighth = growth_share * reltol_ / 8.0;
  if (level_ > 0 && error < eighth) --level_;
  if (level_ > 0 && error < eighth / 64.0) --level_;
}

/// Down the ladder by what the error asks for. False: the end of the ladder.
bool Block::reduce(double error) {
  rejected_ = true;
  const double h = step_size();
  const double factor = error < model::forever ? std::cbrt(0.5 * reltol_ / error) : 0.25;
  while (ladder(level_) >= h) ++level_;
  while (ladder(level_) > 1.4 * factor * h) ++level_;
  return level_ <= last_level && ladder(level_) > tolerance_;
}

std::vector<std::string> Block::names(const std::vector<int>& ports) const {
  constexpr std::size_t most_names = 12;
  std::vector<std::string> result;
  for (const int i : ports)
    if (result.size() < most_names) result.push_back(descriptor_.ports()[static_cast<std::size_t>(i)].name);
  return result;
}

void Block::fail(Outcome outcome, std::string id, std::string text, std::vector<std::string> elements) {
  failure_.outcome = outcome;
  failure_.id = std::move(id);
  failure_.message = std::move(text);
  failure_.elements = std::move(elements);
}

bool Block::fail_step(const Trial& trial) {
  if (!failure_.id.empty()) return false;
  const double time = point_.time;
  if (trial.solved == Solved::singular) {
    const int unknown = factors_.singular_unknown();
    const std::string what = unknown >= 0 ? descriptor_.unknown_name(unknown) : "some unknown";
    if (factors_.out_of_memory()) {
      fail(Outcome::no_solution, "E-out-of-memory", fmt::format("no memory is left for the factors at t = {} s", time), {});
    } else {
      fail(Outcome::no_solution, "E-singular",
           fmt::format("the equations leave {} open at t = {} s; try a resistor to ground, or one in its loop of sources", what, time),
           {what});
    }
  } else if (trial.solved == Solved::no_position) {
    const auto elements = names(ports_.disputed());
    fail(Outcome::no_solution, "E-no-solution",
         fmt::format("no solution continues at t = {} s: no position of {} satisfies the circuit; try a small resistor in their loops",
                     time, fmt::join(elements, ", ")),
         elements);
  } else {
    fail(Outcome::no_solution, "E-step",
         fmt::format("no step from t = {} s meets the tolerance: its error is {:.1e} at the smallest step; try a larger --reltol", time,
                     trial.error),
         {});
  }
  return false;
}

void Block::add_statistics(Statistics& s) const {
  s.states += descriptor_.states().size();
  s.ports += static_cast<std::uint64_t>(descriptor_.first_switch());
  s.switches += descriptor_.ports().size() - static_cast<std::uint64_t>(descriptor_.first_switch());
  s.modes_visited += positions_.size();
  s.events += events_;
  s.jumps += jumps_;
  s.lcp_pivots += ports_.pivots();
  s.klu_factorizations += factors_.counts().factorizations + factors_.counts().refactorizations;
  s.klu_solves += factors_.counts().solves;
  s.steps += steps_;
}

}  // namespace pwlsim::engine::sparse
