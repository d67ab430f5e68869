/// What an instant makes of a parameter's derivative: the members of Sensitivity that follow it across events.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "steady/sensitivity.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using engine::Change;
using model::Mode;
using model::System;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// Of a function of time, just before a time, where it is piecewise linear.
struct ValueBefore {
  double time;

  double operator()(const model::Dc& dc) const { return dc.value; }
  double operator()(const model::Pulse& pulse) const { return model::make_track(pulse).before(time).at(time); }
  double operator()(const model::Pwl& pwl) const { return model::make_track(pwl).before(time).at(time); }
  template <class Other>
  double operator()(const Other&) const {
    return not_known;
  }
};

void add_changes(const model::System& system, const engine::Change& change, std::vector<std::string>& events) {
  if (change.before == nullptr) return;
  for (int i = 0; i < system.ports; ++i) {
    if (change.before->active.contains(i) == change.after->active.contains(i)) continue;
    const model::Port& port = system.port[static_cast<std::size_t>(i)];
    const bool is_switch = i >= system.diodes;
    bool on = change.after->active.contains(i) == port.input_is_current;
    if (is_switch && system.switch_inverted[static_cast<std::size_t>(i - system.diodes)] != 0) on = !on;
    events.push_back(fmt::format("{} {}", port.name, is_switch ? (on ? "closes" : "opens") : (on ? "conducts" : "blocks")));
  }
}

}  // namespace

std::optional<double> Sensitivity::edge_shift_of(std::size_t parameter, double time, Followed& followed) const {
  std::optional<double> shift;
  const double near = tolerance::same_instant * (length_ + time);
  for (const Wave& wave : inputs_.parameters[parameter].waves) {
    const std::optional<double> own = edge_shift(wave, time, near, is_settled_);
    if (!own) continue;
    if (shift && std::abs(*own - *shift) > tolerance::same_shift * (std::abs(*own) + std::abs(*shift)))
      followed.fail(fmt::format("edges of {} at t = {} s move differently", wave.name, time), true);
    if (!shift) shift = own;
  }
  return shift;
}

/// An edge that moves must be alone at its instant.
void Sensitivity::check_others(std::size_t parameter, const LinearInstant& instant, Followed& followed) const {
  const auto& waves = inputs_.parameters[parameter].waves;
  if (instant.island >= 0)
    followed.fail(fmt::format("a moving edge meets another event, {}, at t = {} s", name_of(instant), instant.time), true);
  for (const Wave& other : jumping_) {
    const bool is_own = std::any_of(waves.begin(), waves.end(), [&](const Wave& wave) { return wave.name == other.name; });
    if (is_own || !edge_shift(other, instant.time, tolerance::same_instant * (length_ + instant.time), is_settled_)) continue;
    followed.fail(fmt::format("a moving edge meets a fixed one of {} at t = {} s", other.name, instant.time), true);
  }
}

/// The diode or switch behind a guard.
std::string Sensitivity::name_of(const LinearGuard& guard) const {
  if (guard.level_switch >= 0) return model_.switches[static_cast<std::size_t>(guard.level_switch)].name;
  return orbit_.stacking().system(static_cast<std::size_t>(guard.island)).port[static_cast<std::size_t>(guard.row)].name;
}

/// Of an instant that a clock decides, or nothing that moves.
double Sensitivity::clock_shift_of(std::size_t parameter, const LinearGuard& guard, double at) const {
  double shift = 0.0;
  if (guard.on_w.empty()) return shift;
  const double time = at > 0.0 ? at : length_;
  for (const Wave& wave : inputs_.parameters[parameter].waves) {
    const double on_w = guard.on_w[static_cast<std::size_t>(wave.input)];
    if (on_w == 0.0) continue;
    const double left = time - tolerance::same_instant * (length_ + time);
    shift += on_w * wave_row(wave).dot(wave_state(wave, time, left, is_settled_));
  }
  for (const Drive& drive : inputs_.parameters[parameter].drives) {
    const double on_w = guard.on_w[static_cast<std::size_t>(drive.input)];
    if (on_w != 0.0) shift += on_w * drive.weight * driven_by(drive, time);
  }
  return shift;
}

/// What an input is a multiple of, just before a time.
double Sensitivity::driven_by(const Drive& drive, double time) const {
  if (!drive.held) return drive.signal >= 0 ? signals_at({drive.signal}, time, Side::left).front().value : not_known;
  double sum = drive.held->constant;
  for (const auto& [name, coefficient] : drive.held->sources) {
    const model::SourceFunction* function = nullptr;
    for (const engine::IslandModel& island : model_.islands)
      for (const model::Source& source : island.island.network.sources)
        if (source.label.name == name) function = &source.function;
    sum += coefficient * (function != nullptr ? std::visit(ValueBefore{time}, *function) : not_known);
  }
  return sum;
}

double Sensitivity::shift_of(std::size_t parameter, std::size_t number, const Vector& xi, Followed& followed) const {
  const LinearInstant& instant = orbit_.instants()[number];
  if (const auto edge = edge_shift_of(parameter, instant.time, followed)) {
    if (*edge != 0.0) check_others(parameter, instant, followed);
    return *edge;
  }
  const double level = level_shift_of(parameter, instant);
  return level + (instant.island < 0 ? clock_shift_of(parameter, instant, instant.time) : passage_of(parameter, number, instant, xi));
}

double Sensitivity::corner_shift_of(std::size_t parameter, const LinearInstant& instant) const {
  if (instant.island >= 0 || instant.level_switch >= 0) return 0.0;
  for (const Wave& wave : inputs_.parameters[parameter].waves)
    if (const auto shift = corner_shift(wave, instant.time, tolerance::same_instant * (length_ + instant.time), is_settled_)) return *shift;
  return 0.0;
}

double Sensitivity::level_shift_of(std::size_t parameter, const LinearGuard& guard) const {
  double shift = 0.0;
  for (const LevelMove& level : inputs_.parameters[parameter].levels)
    if (level.number == guard.level_switch) shift += (guard.is_off_level ? level.off : level.on) / guard.level_rate;
  return shift;
}

double Sensitivity::passage_of(std::size_t parameter, std::size_t number, const LinearGuard& guard, const Vector& xi) const {
  const auto island = static_cast<std::size_t>(guard.island);
  const Stacking& stacking = orbit_.stacking();
  const double time = orbit_.instants()[number].time;
  double shift = guard.on_state * xi.segment(stacking.first(island), stacking.count(island));
  const bool is_wrap = number == 0 && is_settled_;
  for (const Change& change : is_wrap ? wrap_.changes : trace_.steps[number].changes) {
    if (change.island != island || change.before == nullptr) continue;
    const Flow& flow = flow_of(parameter, island, *change.before);
    Vector yz(flow.ny + flow.nz);
    yz << seen(island, *change.before, change.y_before.data()),
        waves_at(flow, parameter, time, time - tolerance::same_instant * (length_ + time));
    shift += inputs_on(guard, flow, yz);
    break;
  }
  return shift;
}

/// What inputs move of a passage.
double Sensitivity::inputs_on(const LinearGuard& guard, const Flow& flow, const Vector& yz) const {
  double shift = 0.0;
  Derivatives derivative(flow.source, yz);
  for (std::size_t k = 0; k < flow.rows.size(); ++k)
    for (int order = 0; order < guard.derivatives() && flow.rows[k].size() > 0; ++order)
      if (const double on = guard.on_derivative(k, order); on != 0.0) shift += on * flow.rows[k].dot(derivative(order));
  return shift;
}

/// What is passed at the same time by chance is passed apart for other values of the parameter, in one order or the other.
void Sensitivity::check_beside(std::size_t parameter, std::size_t number, double shift, const Vector& xi, Followed& followed) const {
  const double value = std::abs(inputs_.parameters[parameter].value), least = tolerance::no_shift * length_;
  const double time = orbit_.instants()[number].time;
  for (const LinearGuard& guard : orbit_.instants()[number].beside) {
    const double passage = guard.island < 0 ? clock_shift_of(parameter, guard, time) : passage_of(parameter, number, guard, xi);
    const double own = level_shift_of(parameter, guard) + passage, apart = std::abs(own - shift);
    if (apart * value <= least || apart <= tolerance::same_shift * (std::abs(own) + std::abs(shift))) continue;
    followed.fail(fmt::format("{} changes at t = {} s together with another event, and the parameter separates them", name_of(guard), time),
                  true);
  }
}

/// y in each mode that a change goes by way of, where it is constrained. Where one is entered for no time, its sources are those of the mode after.
std::vector<Vector> Sensitivity::states_by_way(const Change& change) const {
  const System& system = orbit_.stacking().system(change.island);
  std::vector<Vector> states(change.by_way_of.size());
  Vector x(system.size());
  model::from_mode(system, *change.after, change.y_after.data(), x.data());
  for (std::size_t k = 0; k < states.size(); ++k) {
    const Mode& mode = *change.by_way_of[k];
    if (!mode.constrained) continue;
    states[k].resize(mode.ny);
    if (&mode == change.after)
      states[k] = Eigen::Map<const Vector>(change.y_after.data(), static_cast<Eigen::Index>(change.y_after.size()));
    else
      model::to_mode(system, mode, x.data(), states[k].data());
  }
  return states;
}

void Sensitivity::pass_change(std::size_t parameter, const Change& change, const LinearChange& linear, double time, double shift,
                              Vector& xi) const {
  const Stacking& stacking = orbit_.stacking();
  const int n = stacking.count(change.island);
  if (n == 0) return;
  auto block = xi.segment(stacking.first(change.island), n);
  const std::vector<Vector> states = states_by_way(change);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const Mode& mode = *change.by_way_of[k];
    if (!mode.constrained) continue;
    const Flow& flow = flow_of(parameter, change.island, mode);
    Vector yz(flow.ny + flow.nz);
    yz << seen(change.island, mode, states[k].data()), waves_at(flow, parameter, time, time + tolerance::same_instant * (length_ + time));
    block = mode.projector.topLeftCorner(n, n) * Vector(block) + inputs_of(flow, change.island, mode.projector, n, yz).head(n);
  }
  if (linear.d.size() > 0) block += linear.d * shift;
}

void Sensitivity::check_changes(std::size_t number, Followed& followed) const {
  const double time = orbit_.instants()[number].time;
  for (const Change& change : trace_.steps[number].changes) {
    if (change.cause == engine::Cause::accumulation) followed.fail(fmt::format("events accumulate at t = {} s", time), false);
    if (change.cause == engine::Cause::undecided && change.before != change.after)
      followed.fail(fmt::format("the event at t = {} s could not be distinguished from others", time), false);
  }
}

void Sensitivity::pass_instant(std::size_t parameter, std::size_t number, Vector& xi, Followed& followed) const {
  const LinearInstant& instant = orbit_.instants()[number];
  const double shift = shift_of(parameter, number, xi, followed);
  if (std::isnan(shift))
    followed.fail(fmt::format("when the event at t = {} s comes depends on it in a way that is not followed", instant.time), false);
  followed.shifts[number] = shift != 0.0 ? shift : corner_shift_of(parameter, instant);
  check_changes(number, followed);
  check_beside(parameter, number, shift, xi, followed);
  const auto& changes = trace_.steps[number].changes;
  for (std::size_t k = 0; k < changes.size(); ++k) pass_change(parameter, changes[k], instant.changes[k], instant.time, shift, xi);
}

std::string Sensitivity::instant_text(std::size_t instant) const {
  const double time = orbit_.instants()[instant].time;
  const TraceStep& step = instant == 0 && is_settled_ ? wrap_ : trace_.steps[instant];
  std::vector<std::string> events;
  for (const engine::Change& change : step.changes) add_changes(orbit_.stacking().system(change.island), change, events);
  if (events.empty())
    for (const Wave& wave : jumping_)
      if (edge_shift(wave, time, tolerance::same_instant * (length_ + time), is_settled_)) events.push_back(wave.name + " has an edge");
  return fmt::format("{} at t = {} s", events.empty() ? "an event lies" : fmt::format("{}", fmt::join(events, ", ")), time);
}

}  // namespace pwlsim::steady
