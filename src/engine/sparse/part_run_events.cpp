/// PartRun: what happens at an instant.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/arithmetic.hpp"
#include "engine/sparse/jumps.hpp"
#include "engine/sparse/part_run.hpp"
#include "engine/sparse/tolerances.hpp"
#include "engine/switch_rounds.hpp"

namespace pwlsim::engine::sparse {

namespace {

constexpr double room_share = 1.0 / 16.0;
/// A state that moves at an instant by more than the tolerance jumps, or there is a motion shorter than the Euler steps: which of the two, steps tell that
/// are so much shorter, and shorter than any time constant.
constexpr int deeper = 6;
constexpr double small_motion = 0.01;
/// Levels by which the Euler steps may shrink for the sake of a motion, or where they end in two positions, or in none.
constexpr int most_refinement = 16, refinement = 4;

constexpr double unsettled_jump = 0.05;  ///< of the jump: difference between two steps that take it, in a network that is not passive
constexpr double most_strain = 1e-3;     ///< of a control's margin: what the contradiction of a position may change of it
constexpr double shrinking = 0.25;       ///< of what longer steps saw: what shorter ones see of a motion is less
/// A signal that delivers no more in the step of a jump than it does in so many others has no impulse.
constexpr double least_impulse = 100.0;

/// Euler steps are shorter than the others: their local error is ½ (h λ)² where that of the others is of the third order.
int restart_levels(double reltol) { return 3 - static_cast<int>(std::floor(std::log2(std::pow(reltol, 1.0 / 6.0)))); }

}  // namespace

/// Where the position of the last solution contradicts the network, as two switches across a source do while the logic between them is on its way, those change whose controls
/// the contradiction does not reach.
bool PartRun::flip(const Point& at, bool by_sources, double time, Instant& instant, Position& on) {
  const std::vector<double>* strain = by_sources ? nullptr : ports_.strain();
  const double unknown = largest(point_.z);
  std::vector<const WatchedControl*> violated;
  if (by_sources) sources_.evaluate(time, w_);
  for (const WatchedControl& control : controls_) {
    if (control.by_sources() != by_sources) continue;
    const double value = control.value.value(at.z.data(), by_sources ? w_.data() : at.w.data());
    const double margin = control.margin(on, value);
    if (margin >= -control.noise(value, unknown)) continue;
    if (!by_sources && waits_for_jump(control, on)) continue;
    if (strain != nullptr && std::abs(Form::sum(control.value.z, strain->data())) > most_strain * -margin) continue;
    violated.push_back(&control);
  }
  keep_first_turn(violated);
  for (const WatchedControl* control : violated) on[control->port] ^= 1;
  instant.mode_change |= !violated.empty();
  return !violated.empty();
}

/// By segments: whether only a jump of states could take a control beyond its threshold, or a motion within the step: all that answers to the states as they are settles first. So a switch that
/// empties the capacitor which closed it has done so before it opens. (Euler steps take time for that, which would be lost.)
bool PartRun::waits_for_jump(const WatchedControl& control, const Position& on) const {
  if (!segment_ || !control.reads_states || !start_memory_.empty()) return false;
  const double value = control.value.value(point_.z.data(), point_.w.data());
  return control.margin(on, value) > control.noise(value, largest(point_.z));
}

/// Switches whose control is at a threshold that counts as passed where it rests there, once each. Impulses make the unknowns of a first step large,
/// and no rounding of a control: that is taken before the instant.
bool PartRun::flip_at_rest(const Point& at, Instant& instant) {
  bool flipped = false;
  const double unknown = largest(point_.z);
  for (WatchedControl& control : controls_) {
    if (control.has_rested || !control.passes_at_rest(point_.on)) continue;
    const double value = control.value.value(at.z.data(), at.w.data());
    if (control.margin(point_.on, value) > control.noise(value, unknown)) continue;
    point_.on[control.port] ^= 1;
    control.has_rested = flipped = instant.mode_change = true;
  }
  return flipped;
}

/// All switches of one turn whose control has passed at this instant change together, those that only sources drive first; states stay as they are
/// until none moves. False: no position (trial_.solved); `failure_` names the switches that keep toggling.
bool PartRun::settle(double h, Instant& instant, Point& first) {
  for (WatchedControl& control : controls_) control.has_rested = false;
  InstantRounds rounds;
  Position before;
  while (rounds.next()) {
    if (rounds.is_late()) {
      for (std::size_t i = 0; i < before.size(); ++i)
        if (point_.on[i] != before[i] && descriptor_.ports()[i].is_switch) rounds.note_late(i);
      before = point_.on;
    }
    if (flip(point_, true, instant.time + h, instant, point_.on)) continue;
    descriptor_.hold_blocked(point_.on);
    trial_.solved = stepper_.euler(point_, h, first, start_memory_);
    if (trial_.solved == Solved::no_position && ports_.strain() && flip(first, false, instant.time + h, instant, point_.on)) continue;
    if (trial_.solved != Solved::yes) return false;
    if (!flip(first, false, instant.time + h, instant, point_.on) && !flip_at_rest(first, instant)) return true;
  }
  std::vector<std::string> restless;
  for (const std::size_t i : rounds.restless()) restless.push_back(descriptor_.ports()[i].name);
  fail(keeps_toggling(instant.time, std::move(restless)));
  trial_.solved = Solved::no_position;
  return false;
}

/// max over the states of their distance from those before the instant, relative to their size. Segments have no tolerance in which the rounding of what nodes
/// have at the moment disappears.
double PartRun::difference(const std::vector<double>& states, const std::vector<double>& z) const {
  const double rounding = segment_ ? tolerance::node_share * ports_.largest_voltage(z) : 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const State& state = descriptor_.states()[i];
    const double size = std::max(scale_.size(i, z), state.is_current ? 0.0 : rounding);
    worst = std::max(worst, std::abs(state.measure(z.data()) - states[i]) / size);
  }
  return worst;
}

/// Switches and three Euler steps.
Solved PartRun::euler_steps(double h, Instant& instant) {
  if (!settle(h, instant, first_)) return trial_.solved;
  const Solved solved = stepper_.euler(first_, h, second_);
  return solved == Solved::yes ? stepper_.euler(second_, h, third_) : solved;
}

/// Whether the Euler steps of length h lead where much shorter ones do, and on: states that move there at the instant itself have jumped, and what moves in
/// h and not there is to be followed in shorter steps, as diodes that conduct on the way may send charges elsewhere. So is what changes sides
/// on the way, unless nothing moves by the tolerance.
bool PartRun::settled(double h, Instant& instant) {
  const bool is_expected = first_.on == point_.on && second_.on == point_.on && third_.on == point_.on;
  const double motion = difference(states_, drawn_back(first_, second_));
  instant.jump = motion > reltol_;
  if (is_expected && !instant.jump) return true;
  const double shorter = h * std::ldexp(1.0, -deeper);
  if (!passive_ && instant.jump && !repeats(shorter, motion)) return false;
  Point first, second;
  if (stepper_.euler(point_, std::min(shorter, shortest_), first, start_memory_) != Solved::yes) return true;
  if (stepper_.euler(first, std::min(shorter, shortest_), second) != Solved::yes) second = first;
  std::vector<double> states;
  descriptor_.measure_states(drawn_back(first, second).data(), states);
  const double jump = difference(states_, w_);
  if (!passive_) return jump >= (1.0 - unsettled_jump) * motion - reltol_;
  instant.jump = jump > reltol_;
  motion_left_ = difference(states, drawn_back(first_, second_));
  if (motion_left_ > reltol_) return false;
  const bool is_position_kept = first_.on == second.on && second_.on == second.on && third_.on == second.on;
  return is_position_kept || difference(states, third_.z) <= reltol_;
}

/// In a network that is not passive, where a jump may be of higher order, and a state two integrations away be held back from rounding in ever shorter steps:
/// whether it is much the same in a shorter step.
bool PartRun::repeats(double shorter, double motion) {
  Point first, second;
  if (stepper_.euler(point_, shorter, first, start_memory_) != Solved::yes) return true;
  // What h draws back of a motion, (h/τ)², is what the shorter step moves, h/64τ, where h/τ is 1/64: from that the instant is drawn, too.
  if (motion > small_motion || stepper_.euler(first, shorter, second) != Solved::yes) second = first;
  std::vector<double> states;
  descriptor_.measure_states(drawn_back(first, second).data(), states);
  return difference(states, drawn_back(first_, second_)) <= std::max(unsettled_jump * motion, reltol_);
}

/// The unknowns at the instant: those of the ends of two Euler steps from there, extrapolated.
const std::vector<double>& PartRun::drawn_back(const Point& first, const Point& second) {
  w_ = first.z;
  for (std::size_t i = 0; i < w_.size(); ++i) w_[i] += first.z[i] - second.z[i];
  return w_;
}

/// Before the states of the instant are forgotten.
void PartRun::note_jump(double time, double h) {
  if (!request_.jumps || jump_details_.size() >= most_jumps_kept) return;
  std::vector<double> after;
  descriptor_.measure_states(drawn_back(first_, second_).data(), after);
  jump_details_.push_back(describe_jump(part_, {time, states_, after}, {h, first_, second_}, reltol_));
}

/// What the three Euler steps deliver, without what the line through the ends of the last two does, which stands for the signal from the instant on:
/// states and their integrals go together.
void PartRun::note_impulses(double h) {
  impulses_.resize(signals_.size());
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const double first = signals_[i].value(first_.z.data(), first_.w.data());
    const double second = signals_[i].value(second_.z.data(), second_.w.data());
    const double third = signals_[i].value(third_.z.data(), third_.w.data());
    const double largest = std::max({std::abs(second), std::abs(third), std::abs(signals_before_[i])});
    impulses_[i] = std::abs(first - second) > least_impulse * largest ? h * (first - 3.5 * second + 2.5 * third) : 0.0;
  }
}

void PartRun::find_next_gate() {
  next_gate_ = model::forever;
  for (const Gate& gate : gates_) next_gate_ = std::min(next_gate_, gate.next());
}

/// Whether any changes sides until then.
bool PartRun::take_gates(double until) {
  if (next_gate_ > until) return false;
  for (Gate& gate : gates_) {
    while (gate.next() <= until) gate.pass();
    point_.on[gate.port()] = gate.closed();
  }
  descriptor_.hold_blocked(point_.on);
  find_next_gate();
  return true;
}

/// Of sources and gates whose time has come.
PartRun::Instant PartRun::begin_instant() {
  restart_due_ = false;
  Instant instant;
  instant.time = point_.time;
  if (position_before_.empty()) position_before_ = point_.on;
  if (request_.events || request_.probes.sink != nullptr)
    for (std::size_t i = 0; i < signals_.size(); ++i) signals_before_[i] = signals_[i].value(point_.z.data(), point_.w.data());
  if (sources_.next_break() <= instant.time + break_tolerance_) instant.source_edge = sources_.advance(instant.time, break_tolerance_);
  instant.mode_change = take_gates(instant.time + break_tolerance_);
  return instant;
}

bool PartRun::restart() {
  const double time = point_.time;
  Instant instant = begin_instant();
  if (!starting_) descriptor_.measure_states(point_.z.data(), states_);
  const double room = std::min(next_break(), request_.stop > time + tolerance_ ? request_.stop : model::forever) - time;
  int level = level_ + restart_levels(reltol_);
  while (diagonal * ladder(level) > room_share * room) ++level;
  const int usual = level;
  const Beginning beginning{point_.on, instant};
  if (!find_position(beginning, instant, level)) return false;
  level_ += level - usual;
  end_before_passage(beginning, instant, level);
  if (instant.jump) note_jump(time, diagonal * ladder(level));
  const bool has_impulses = instant.jump && request_.probes.sink != nullptr;
  instant.mode_change |= third_.on != position_before_;
  start_memory_.clear();
  starting_ = false;
  if (has_impulses) note_impulses(diagonal * ladder(level));
  stretch_.set(second_, third_);  // the first holds the impulses, be they no larger than the error of the instant
  certificate_.add_point(third_, ports_);
  settle_in(third_);
  if (time > 0.0 && instant.happened()) {
    ++events_;
    jumps_ += instant.jump ? 1 : 0;
    instant_ = instant;
  }
  stall_.note_instant(instant.happened());
  if (time == 0.0) start_projected_ = instant.jump;
  const bool goes_on = watch_crowd(time);
  position_before_.clear();
  return goes_on;
}

/// Euler steps so short that the states either stay where they are or jump. False: failed.
bool PartRun::find_position(const Beginning& beginning, Instant& instant, int& level) {
  const int usual = level;
  int deepest = std::min(std::max(level + most_refinement, shortest_level()), last_level);
  while (deepest > level && diagonal * ladder(deepest) < tolerance::shortest_euler_step * instant.time) --deepest;
  double before = 0.0;
  bool tentative = false;  // failure_ is that of the longest steps, unless shorter ones do better
  int found = -1;          // the deepest level with a position, if one that moves what it should not
  while (true) {
    const double h = diagonal * ladder(level);
    const bool end = level >= deepest;
    point_.on = beginning.on;
    instant = beginning.instant;
    trial_.solved = euler_steps(h, instant);
    if (!failure_.id.empty() && !tentative) return false;
    if (trial_.solved == Solved::yes) {
      scale_.note(second_.z);
      const bool is_settled = settled(h, instant);
      const double motion = instant.jump ? difference(states_, drawn_back(first_, second_)) : 0.0;
      if (is_settled || (end && (passive_ || motion <= shrinking * before))) {
        if (!is_settled && passive_ && !decays(beginning, instant, level, usual)) damped_ = std::max(damped_, motion_left_);
        failure_ = {};
        return true;
      }
      if (end) {
        fail(Outcome::no_solution, "E-jump-order",
             fmt::format("the state jumps at t = {} s by impulses of higher order, which this engine cannot follow; try --engine exact",
                         instant.time),
             {});
        return false;
      }
      before = motion;
      found = level;
    } else if (!tentative) {
      tentative = !fail_step(trial_.solved, 0.0);
    }
    if (end && (!passive_ || found < 0)) return false;
    if (end) return go_back(beginning, instant, level = found);
    level = std::min(level + refinement, deepest);
  }
}

/// Of what is too fast for the digits of time: whether it decays in the longest steps without a change of sides, so that nothing depends on its way. Then
/// these are taken.
bool PartRun::decays(const Beginning& beginning, Instant& instant, int& level, int usual) {
  const Found deep = found(instant);
  point_.on = beginning.on;
  instant = beginning.instant;
  const double h = diagonal * ladder(usual);
  const bool taken = euler_steps(h, instant) == Solved::yes && first_.on == point_.on && second_.on == point_.on &&
                     third_.on == point_.on && repeats(h * std::ldexp(1.0, -deeper), 0.0);
  instant.jump = taken || deep.instant.jump;
  if (taken) level = usual;
  if (!taken) put_back(deep, instant);
  return taken;
}

PartRun::Found PartRun::found(const Instant& instant) const { return {{point_.on, instant}, first_, second_, third_}; }

void PartRun::put_back(const Found& found, Instant& instant) {
  failure_ = {};
  first_ = found.first;
  second_ = found.second;
  third_ = found.third;
  point_.on = found.on;
  instant = found.instant;
}

/// To steps that are longer than what moves in them, as shorter ones find no position: told, not followed.
bool PartRun::go_back(const Beginning& beginning, Instant& instant, int level) {
  point_.on = beginning.on;
  instant = beginning.instant;
  const double h = diagonal * ladder(level);
  trial_.solved = euler_steps(h, instant);
  if (trial_.solved != Solved::yes) return false;
  if (!settled(h, instant)) damped_ = std::max(damped_, motion_left_);
  failure_ = {};
  return true;
}

/// Levels (two at most) by which three Euler steps are too long: a control that passes behind the first of them would change sides late.
int PartRun::levels_too_long(double h) const {
  double soonest = 3.0 * h;
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const double first = margin(i, true, first_), fall = first - margin(i, true, second_);
    if (fall > 0.0 && first > tolerance::guard_sign * margin_size(i, true)) soonest = std::min(soonest, h * (1.0 + first / fall));
  }
  return static_cast<int>(std::ceil(std::log2(3.0 * h / soonest)));
}

/// The Euler steps anew where they are too long for that; those at hand stay where shorter ones find no position.
void PartRun::end_before_passage(const Beginning& beginning, Instant& instant, int& level) {
  const int more = levels_too_long(diagonal * ladder(level));
  if (more == 0 || level + more > last_level) return;
  const Found usual = found(instant);
  int shorter = level + more;
  if (find_position(beginning, instant, shorter))
    level = shorter;
  else
    put_back(usual, instant);
}

/// Names of the ports that have changed sides at the instant.
std::vector<std::string> PartRun::changed_ports() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < position_before_.size(); ++i) {
    const std::string& name = descriptor_.ports()[i].name;
    if (point_.on[i] != position_before_[i] && (names.empty() || names.back() != name)) names.push_back(name);
  }
  return names;
}

bool PartRun::watch_crowd(double time) {
  if (!crowd_.note(time, tolerance::crowd * request_.stop)) return true;
  fail(accumulation(time, crowd_, changed_ports(), {}));
  return false;
}

bool PartRun::begin(const PartStart& start) {
  point_.time = 0.0;
  point_.on = start.on;
  for (Gate& gate : gates_) {
    gate.begin(point_.on[gate.port()] != 0, request_.stop);
    point_.on[gate.port()] = gate.closed();
  }
  find_next_gate();
  Instant none;
  flip(point_, true, 0.0, none, point_.on);
  sources_.evaluate(0.0, point_.w);
  if (!start.unknowns.empty()) return begin_on_the_way(start);
  if (!descriptor_.unknowns_of_states(start.states, point_.w, point_.on, point_.z, start_memory_)) start_memory_.clear();
  point_.k.assign(point_.z.size(), 0.0);
  for (std::size_t i = 0; i < start.states.size(); ++i) {
    const State& state = descriptor_.states()[i];
    states_.push_back(state.is_current ? state.measure(point_.z.data()) : start.states[i]);
    if (!state.is_current) ports_.note_voltage(std::abs(start.states[i]));
  }
  scale_.note_values(start.states);
  starting_ = true;
  if (!segment_) return restart();
  note_least_voltage();
  return begin_segment();
}

/// As a segment that goes on from another.
bool PartRun::begin_on_the_way(const PartStart& start) {
  point_.z = start.unknowns;
  point_.k.assign(point_.z.size(), 0.0);
  descriptor_.measure_states(point_.z.data(), states_);
  ports_.note_voltage(ports_.largest_voltage(point_.z));
  scale_.note(point_.z);
  ports_.note_scale(point_.z, point_.w);
  note_least_voltage();
  return begin_segment();
}

}  // namespace pwlsim::engine::sparse
