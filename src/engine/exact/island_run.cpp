#include "engine/exact/island_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/arithmetic.hpp"
#include "engine/exact/tolerances.hpp"
#include "model/clock.hpp"
#include "model/valves.hpp"

namespace pwlsim::engine {

namespace {

constexpr int settled = -2;  ///< in the place of a guard's row: no guard ends the segment, but the end of its fast decays

}  // namespace

IslandRun::IslandRun(const IslandModel& island_model, model::Selector& selector)
    : model_(island_model),
      system_(island_model.extraction.system),
      selector_(selector),
      controls_(system_, selector),
      guard_watch_(system_),
      continuity_watch_(system_),
      row_state_(system_) {
  const auto size = static_cast<std::size_t>(system_.size());
  x.assign(size, 0.0);
  scratch_.resize(size);
  work_.resize(2 * size);
  wanted = model::IndexSet(system_.ports);
  segment_.system = &system_;
  outputs_.resize(system_.outputs.size());
}

void IslandRun::set_switch(int port, bool closed) {
  const auto index = static_cast<std::size_t>(port - system_.diodes);
  if (system_.switch_inverted[index] != 0) closed = !closed;
  // Closed means zero voltage; whether that is u = 0 (inactive) or y = 0 (active) is the port's causality.
  wanted.set(port, closed == system_.port[static_cast<std::size_t>(port)].input_is_current);
  model::hold_blocked(system_, wanted);
  is_set_ = true;
}

double IslandRun::certify(double end) {
  if (event_.found && event_time_ <= end) return event_time_;
  if (event_.found) return end;
  if (segment_.anchor + segment_.certified >= end) return end;
  const double length = end - segment_.anchor;
  locate(std::min(length, time_to_settle_));
  if (!event_.found && time_to_settle_ <= length) settle();
  if (!event_.found) return end;
  take_event(end);
  return event_time_;
}

void IslandRun::locate(double length) {
  locator_.locate(segment_, length, event_);
  if (faults_.dropped_event == 0) return;
  if (!event_.found || event_.row < 0 || event_.row >= system_.diodes || ++port_events_ != faults_.dropped_event) return;
  const auto place = std::find(segment_.rows.begin(), segment_.rows.end(), event_.row) - segment_.rows.begin();
  segment_.rows.erase(segment_.rows.begin() + place);
  segment_.departures.erase(segment_.departures.begin() + place);
  segment_.certified = segment_.tau;
  locator_.locate(segment_, length, event_);
}

/// The fast decays are over: the segment ends, and the slow motion goes on.
void IslandRun::settle() {
  settled_y_.assign(segment_.y0.begin(), segment_.y0.end());
  mode->flow.apply_once(time_to_settle_, settled_y_.data(), work_.data());
  event_ = {true, time_to_settle_, settled, settled_y_.data()};
}

/// The time of the event that was found before `end`.
void IslandRun::take_event(double end) {
  const double tau = event_.tau + segment_.late;
  const double sum = segment_.anchor + tau;
  event_time_ = std::min(end, sum);
  event_late_ = event_time_ == sum ? rounding_of_sum(segment_.anchor, tau) : 0.0;
}

void IslandRun::open(double time, double late) {
  if (open_) return;
  open_ = true;
  trigger = passed_row = -1;
  undecided_ = is_set_ = false;
  is_as_before_ = true;
  late_ = late;
  length_before_ = 0.0;
  controls_.begin_instant();
  const model::Mode& m = *mode;
  auto& y = segment_.y;
  wanted = m.active;
  opened_at_limit_ = is_at_limit(time);
  if (opened_at_limit_) {
    at_limit_ = is_as_before_ = false;
    take_limit(time, x.data());
    return;
  }
  at_limit_ = false;
  if (is_static() && next_break() <= time) return;  // nothing but sources, and they are about to be set
  length_before_ = length_until(time, late);
  has_event_at(time) ? go_to_event(time) : go_to_time();
  if (system_.exosystem->has_curved()) system_.exosystem->evaluate_curved(phase_, time, late_, y.data() + m.n1);
  guard_watch_.look_inside(m, segment_.y0.data(), segment_.anchor, length_before_);
  guard_watch_.look(m, y.data(), time);
  model::from_mode(system_, m, y.data(), x.data());
  continuity_watch_.begin(x.data());
}

/// The state at the event that belongs to the instant `time`.
void IslandRun::go_to_event(double time) {
  late_ = (event_time_ - time) + event_late_;
  linalg::copy(event_.y, mode->ny, segment_.y.data());
  passed_row = event_.row;
  if (event_.row >= 0 && event_.row < system_.diodes) trigger = event_.row;
  is_settled_ = event_.row == settled;
  undecided_ = event_.row < 0 && !is_settled_;
}

/// The state at a time at which the island itself has no event.
void IslandRun::go_to_time() {
  const double tau = length_before_;
  // The march may have stepped past this instant; then the anchor is the place to start from.
  const bool from_anchor = tau < segment_.tau;
  if (from_anchor) linalg::copy(segment_.y0.data(), mode->ny, segment_.y.data());
  mode->flow.apply(from_anchor ? tau : tau - segment_.tau, segment_.y.data(), work_.data());
}

void IslandRun::look_at_end(double time) {
  const double tau = (time - segment_.anchor) - segment_.late;
  if (system_.diodes == 0 || !(tau > 0.0)) return;
  guard_watch_.look_inside(*mode, segment_.y0.data(), segment_.anchor, tau);
  scratch_ = segment_.y0;
  mode->flow.apply_once(tau, scratch_.data(), work_.data());
  guard_watch_.look(*mode, scratch_.data(), time);
}

model::Vector IslandRun::state_before() const {
  model::Vector before(system_.size());
  model::from_mode(system_, *segment_.mode, segment_.y.data(), before.data());
  return before;
}

void IslandRun::go_to_limit(const AccumulationWatch::Limit& limit) {
  event_ = {};
  event_.found = at_limit_ = true;
  event_time_ = limit.time;
  event_late_ = 0.0;
  limit_ = limit.xi;
}

void IslandRun::take_limit(double time, double* out) const {
  std::copy(limit_.begin(), limit_.end(), out);
  system_.exosystem->evaluate(phase_, time, out + system_.n);
}

bool IslandRun::take_breakpoints(double time) {
  // Between breakpoints ζ has come along with the state, and a located guard is zero at it; evaluating it anew at the rounded time
  // would move a steep ramp off its threshold.
  if (phase_.next > time + tolerance_) return false;
  const bool jumped = system_.exosystem->advance(phase_, time, tolerance_);
  system_.exosystem->evaluate(phase_, time, x.data() + system_.n);
  return jumped;
}

const model::Selected& IslandRun::select() {
  is_as_before_ = false;
  if (system_.ports == 0 && mode) return selector_.stay_in(*mode);
  const model::Mode* before = mode;
  selector_.set_settled(is_settled_ ? mode : nullptr);
  const model::Selected& result = selector_.select(x.data(), wanted, trigger);
  if (result.relaxation >= model::coarsest_relaxation) [[unlikely]]
    is_coarse_ = true;
  is_settled_ = false;
  const bool same = result.mode == before && result.jumps == 0;
  rests_ = same ? trigger : -1;
  all_rest_ = same && undecided_;
  trigger = -1;
  if (result.jumps > 0) continuity_watch_.jumped(*result.details);
  if (result.mode) {
    mode = result.mode;
    // Decays that are not followed have no impulse: the state lies where they end, whatever mode another switch then leads to.
    if (mode->decays || result.settles) continuity_watch_.excuse();
    wanted = mode->active;
  }
  return result;
}

const std::vector<int>& IslandRun::violated_controls(const std::vector<char>& on) {
  model::to_mode(system_, *mode, x.data(), scratch_.data());
  return controls_.violated(*mode, scratch_.data(), on);
}

const std::vector<int>& IslandRun::passing_controls(const std::vector<char>& on) {
  static const std::vector<int> none;
  // A current that a diode stops at zero does not pass it.
  if (!is_as_before_ || !std::exchange(is_set_, false) || trigger >= 0) return none;
  is_as_before_ = false;
  return system_.n > 0 ? controls_.violated(*mode, segment_.y.data(), on) : none;
}

/// Guards that can fire in this segment. A constant one cannot, nor one whose row is zero (an indeterminate port).
void IslandRun::choose_guards(const std::vector<char>& on) {
  segment_.rows.clear();
  segment_.departures.clear();
  guard_rows_.clear();
  take_diode_guards();
  for (std::size_t i = 0; i < system_.controls.size(); ++i) {
    const auto row = static_cast<std::size_t>(controls_.row(i, on));
    if (mode->guard_constant[row] != 0) continue;
    // Switches that watch the same voltage (a bridge's diagonal) are one guard.
    const int twin = mode->guard_twin[row];
    if (std::find(guard_rows_.begin(), guard_rows_.end(), twin) == guard_rows_.end()) guard_rows_.push_back(twin);
  }
  if (!guard_rows_.empty()) take_guard_rows();
}

/// Those whose departures the selection knows; the others go to guard_rows_.
void IslandRun::take_diode_guards() {
  const bool is_known = selector_.departures_hold_for(*mode);
  for (int i = 0; i < system_.diodes; ++i) {
    if (mode->guard_constant[static_cast<std::size_t>(i)] != 0 || mode->guard_twin[static_cast<std::size_t>(i)] != i) continue;
    if (!is_known) {
      guard_rows_.push_back(i);
      continue;
    }
    model::Departure d = selector_.departures()[static_cast<std::size_t>(i)];
    if (i == rests_ || (all_rest_ && d.order > 0)) d.order = -1;
    if (d.order < 0 && mode->guard_norm[i] == 0.0) continue;
    segment_.rows.push_back(i);
    segment_.departures.push_back(d);
  }
}

/// Those of guard_rows_, with their departures.
void IslandRun::take_guard_rows() {
  auto& rows = segment_.rows;
  auto& departures = segment_.departures;
  if (mode->piecewise_linear) {  // straight lines are solved, not searched
    rows.insert(rows.end(), guard_rows_.begin(), guard_rows_.end());
    departures.resize(rows.size());
    return;
  }
  departures_.resize(guard_rows_.size());
  selector_.verifier().departures(*mode, segment_.y0.data(), guard_rows_, departures_.data());
  for (std::size_t i = 0; i < guard_rows_.size(); ++i) {
    if (departures_[i].order < 0 && mode->guard_norm[guard_rows_[i]] == 0.0) continue;
    if (departures_[i].order == 0 && departures_[i].value < 0.0 && guard_rows_[i] >= system_.diodes)
      controls_.take_slope_at_threshold(*mode, guard_rows_[i], segment_.y0.data(), departures_[i]);
    rows.push_back(guard_rows_[i]);
    departures.push_back(departures_[i]);
  }
}

void IslandRun::set_tolerance(double tolerance) {
  tolerance_ = tolerance;
  controls_.set_tolerance(tolerance);
  selector_.set_unseen(tolerance::unseen_per_merge * tolerance);
  continuity_watch_.set_tolerance(tolerance);
}

/// Until the fast decays of the mode are over; ∞ where it has none, or is their slow motion.
double IslandRun::time_to_settle() { return mode->slow ? model::time_constants_to_rest * mode->slow->decays->slowest : model::forever; }

void IslandRun::close(double time, const std::vector<char>& on) {
  open_ = false;
  event_ = {};
  time_to_settle_ = time_to_settle();
  begin_segment(time, late_);
  if (is_coarse_) [[unlikely]]
    note_coarse(time);
  choose_guards(on);
  selector_.modes().mark_visited(*mode);
  row_state_.forget();
}

/// The certificate counts what the coarse level has let pass.
[[gnu::noinline]] void IslandRun::note_coarse(double time) {
  is_coarse_ = false;
  if (coarse_selections_++ == 0) first_coarse_ = time;
  guard_watch_.look(*mode, segment_.y0.data(), time);
}

/// From x in the mode as it is.
void IslandRun::begin_segment(double time, double late) {
  if (segment_.y0.size() < x.size()) {
    segment_.y0.resize(x.size());
    segment_.y.resize(x.size());
  }
  if (const double* y = selector_.coordinates(*mode); y != nullptr)
    linalg::copy(y, mode->ny, segment_.y0.data());
  else
    model::to_mode(system_, *mode, x.data(), segment_.y0.data());
  if (segment_number_ + 1 == faults_.disturbed_segment)
    for (int i = 0; i < mode->n1; ++i) segment_.y0[static_cast<std::size_t>(i)] *= 1.0 + faults_.disturbance;
  continuity_watch_.end({segment_.mode, segment_.y.data()}, {mode, segment_.y0.data()}, time);
  segment_.mode = mode;
  segment_.anchor = time;
  segment_.late = late;
  ++segment_number_;
  linalg::copy(segment_.y0.data(), mode->ny, segment_.y.data());
  segment_.tau = segment_.certified = segment_.step = 0.0;
  segment_.intervals = 0;
  segment_.is_brief = time_to_settle_ < model::forever;
  segment_.decays.clear();
  segment_.decays_fail = segment_.is_enclosed = false;
  segment_.turns = segment_.turns_without_modal_form = 0;
  segment_.sampled = false;
}

void IslandRun::outputs_from(const model::Mode& m, const double* y, double* out) {
  linalg::multiply(m.outputs, y, outputs_.data());
  for (std::size_t i = 0; i < outputs_.size(); ++i) out[system_.output_signal[i]] += outputs_[i];
}

void IslandRun::add_signals(double time, double* out) {
  if (system_.outputs.empty()) return;
  const model::Mode& m = *mode;
  if (at_limit_ && time >= event_time_) {
    take_limit(time, work_.data());
    model::to_mode(system_, m, work_.data(), scratch_.data());
    return outputs_from(m, scratch_.data(), out);
  }
  // The rounding of times may be longer than what is fast: no row lies beyond the event.
  const double* y = event_.found && time >= event_time_ ? event_.y : row_state_.at(segment_, phase_, time);
  const bool is_long = m.flow.rate() * (time - segment_.anchor) >= 1.0;  // else no guard can have dipped since it began
  if (is_long && (time < event_time_ || !event_.found)) guard_watch_.look(m, y, time);
  outputs_from(m, y, out);
}

bool IslandRun::changes_visibly(const model::Mode& before) {
  guard_rows_.clear();
  bool undetermined = false;
  for (int i = system_.diodes; i < system_.ports; ++i)
    if (mode->active.contains(i) != before.active.contains(i)) return true;
  for (int i = 0; i < system_.diodes; ++i) {
    if (mode->active.contains(i) == before.active.contains(i)) continue;
    const auto port = static_cast<std::size_t>(i);
    const bool unique = mode->input_unique[port] != 0 && before.input_unique[port] != 0;
    undetermined |= !unique;
    if (unique) guard_rows_.push_back(i);
  }
  if (!guard_rows_.empty()) {
    const bool known = selector_.departures_hold_for(*mode);
    departures_.resize(static_cast<std::size_t>(system_.diodes));
    if (!known) {
      model::to_mode(system_, *mode, x.data(), scratch_.data());
      selector_.verifier().departures(*mode, scratch_.data(), guard_rows_, departures_.data());
    }
    for (std::size_t i = 0; i < guard_rows_.size(); ++i)
      if ((known ? selector_.departures()[static_cast<std::size_t>(guard_rows_[i])] : departures_[i]).order >= 0) return true;
  }
  if (!undetermined) return false;
  // A change between two modes that once went on differently is taken to be one again.
  const std::pair<const model::Mode*, const model::Mode*> change{&before, mode};
  if (std::find(visible_changes_.begin(), visible_changes_.end(), change) != visible_changes_.end()) return true;
  if (selector_.continues_alike(before, *mode, x.data())) return false;
  visible_changes_.push_back(change);
  return true;
}

}  // namespace pwlsim::engine
