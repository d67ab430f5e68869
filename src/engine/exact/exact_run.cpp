#include "engine/exact/exact_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/exact/steering.hpp"
#include "engine/exact/tolerances.hpp"
#include "engine/remarks.hpp"

namespace pwlsim::engine {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t rows_per_block = 1024;
constexpr std::uint64_t instants_between_checks = 256;
constexpr int slow_size = 50;  ///< states and ports whose modes take milliseconds each

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

ExactRun::ExactRun(const ExactModel& exact_model, const Request& request, RowSink& sink, Selectors& selectors, const Watching& watching)
    : model_(exact_model),
      request_(request),
      watching_(watching),
      recorders_(exact_model, request, watching.observer, islands_),
      tolerance_(watching.merge > 0.0 ? watching.merge : tolerance::merge * request.stop),
      rows_(request, sink, exact_model.signal_names.size(), rows_per_block, tolerance_) {
  islands_.reserve(model_.islands.size());
  for (std::size_t i = 0; i < model_.islands.size(); ++i) islands_.emplace_back(model_.islands[i], selectors.of(i));
  if (request.watcher != nullptr)
    for (auto& island : islands_) island.selector().share_in_any_case();
  make_clocks();
  make_groups();
  modes_before_.assign(islands_.size(), nullptr);
  opened_.assign(islands_.size(), Opened::no);
  all_passive_ = std::all_of(islands_.begin(), islands_.end(), [](const auto& island) { return island.system().passive; });
  row_before_.resize(rows_.width());
  sampled_.resize(request.sampler != nullptr ? rows_.width() : 0);
  for (auto& island : islands_) {
    island.set_tolerance(tolerance_);
    island.inject(request.faults);
  }
  is_slow_ = std::any_of(islands_.begin(), islands_.end(),
                         [](const auto& island) { return island.system().size() + island.system().ports > slow_size; });
  if (request.grid.rows > 2)
    for (auto& island : islands_) island.set_row_step(request.grid.time(1) - request.grid.time(0));
}

void ExactRun::make_clocks() {
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    const model::System& system = islands_[i].system();
    for (const model::Control& control : system.clocked) clocks_.emplace_back(system, control, tolerance_);
    if (system.is_static() && system.outputs.empty() && system.controls.empty()) continue;
    running_.push_back(&islands_[i]);
    (system.controls.empty() ? following_ : steering_).push_back(&islands_[i]);
    if (!islands_[i].senses_state()) continue;
    sensing_.push_back(&islands_[i]);
    if (system.n == 0) logic_.push_back(&islands_[i]);
  }
}

void ExactRun::make_groups() {
  std::vector<IslandRun*> order = running_;
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->system().size() < b->system().size(); });
  std::vector<std::size_t> place(islands_.size(), order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[number_of(*order[i])] = i;
  const auto place_of_switch = [&](int number) {
    const int island = model_.switches[static_cast<std::size_t>(number)].island;
    return island < 0 ? order.size() : place[static_cast<std::size_t>(island)];
  };
  std::vector<std::pair<std::size_t, std::size_t>> steers;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const model::Control& control : order[i]->system().controls)
      if (const std::size_t to = place_of_switch(control.driven); to < order.size()) steers.emplace_back(i, to);
  std::vector<std::size_t> group_of(order.size());
  for (const SteeringGroup& group : steering_groups(order.size(), steers)) {
    Group& made = groups_.emplace_back();
    made.steered_by = group.steered_by;
    for (const std::size_t island : group.islands) {
      made.islands.push_back(order[island]);
      group_of[island] = groups_.size() - 1;
    }
  }
  for (const model::Clock& clock : clocks_)
    if (const std::size_t to = place_of_switch(clock.driven()); to < order.size()) groups_[group_of[to]].clocks.push_back(&clock);
}

Answer ExactRun::run(const RunState& start) {
  const auto clock = Clock::now();
  answer_.outcome = Outcome::completed;
  if (begin(start)) march();
  if (answer_.outcome == Outcome::completed) rows_before(request_.stop, true);
  take(rows_.flush());
  recorders_.run_ended(now_);
  const PieceMaker& pieces = recorders_.pieces();
  if (pieces.is_cut() && answer_.outcome == Outcome::completed) fail(interrupted(now_));
  answer_.time = now_;
  answer_.probed = pieces.is_cut() ? pieces.cut_at() : now_;
  for (auto& island : islands_) {
    if (!island.mode || island.is_open()) continue;
    island.look_at_end(now_);
    recorders_.reached_end(at(island, now_));
    if (answer_.outcome == Outcome::completed) holds(island);
  }
  for (const auto& island : islands_)
    if (island.mode && !island.is_open()) recorders_.ends_within(at(island, now_));
  answer_.statistics.seconds_simulate = seconds_since(clock) - rows_.seconds();
  answer_.statistics.rows = rows_.count();
  finish();
  return std::move(answer_);
}

void ExactRun::march() {
  for (bool going = !is_ended_by_observer_; going;) {
    const double time = next_instant();
    if (!rows_before(time, false)) break;
    now_ = time;
    if (watching_.leaves_end_open && time > request_.stop - tolerance_) return stop_short();
    going = handle(time) && time < request_.stop && !is_ended_by_observer_;
    if (is_interrupted()) {
      fail(interrupted(now_));
      break;
    }
    if (is_slow_ && !take(rows_.flush_in_time())) break;
    if (++instants_ % instants_between_checks == 0 && request_.progress) request_.progress(time);
  }
  if (is_ended_by_observer_) close_others();
}

/// Takes an island to the present time, which ends the run within its segment. False: its mode does not hold there.
bool ExactRun::leave(IslandRun& island) {
  recorders_.ends_within(at(island, now_));
  island.open(now_, 0.0);
  recorders_.left(at(island, now_));
  return holds(island);
}

/// The other parts, where an event of one ends the run, are taken to that time.
void ExactRun::close_others() {
  for (IslandRun* island : running_)
    if (!island->is_open() && island->segment().anchor < now_ && !leave(*island)) return;
}

/// The state just before `stop`, where what happens belongs to the next run.
void ExactRun::stop_short() {
  now_ = request_.stop;
  for (IslandRun* island : running_)
    if (!leave(*island)) return;
}

RunState ExactRun::state() const {
  RunState state{{}, on_, {}, now_};
  for (const IslandRun& island : islands_) {
    model::Vector x = Eigen::Map<const model::Vector>(island.x.data(), island.system().size());
    if (!island.is_open() && island.mode != nullptr) model::from_mode(island.system(), *island.mode, island.segment().y0.data(), x.data());
    state.xi.push_back(x.head(island.system().n));
    state.active.push_back(island.mode != nullptr ? island.mode->active : island.wanted);
  }
  return state;
}

/// States as given, switches where the start has them, then the instant itself.
bool ExactRun::begin(const RunState& start) {
  if (request_.sampler != nullptr) request_.sampler->begin();
  begin_ = start.time;
  is_start_given_ = request_.use_initial_conditions && start.active.empty();
  on_ = start.on;
  rested_.assign(on_.size(), 0);
  is_ready_.assign(islands_.size(), 0);
  recorders_.run_begins(start.signals);
  for (IslandRun& island : islands_) island.start_sources(begin_);
  for (IslandRun* island : running_) {
    const auto& xi = start.xi[number_of(*island)];
    std::copy(xi.begin(), xi.end(), island->x.begin());
    if (!start.active.empty()) island->wanted = start.active[number_of(*island)];
    island->open_at_start();
    recorders_.started(at(*island, begin_));
  }
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const SwitchInfo& info = model_.switches[i];
    if (info.island >= 0) islands_[static_cast<std::size_t>(info.island)].set_switch(info.port, on_[i] != 0);
  }
  for (model::Clock& clock : clocks_) clock.start(on_[static_cast<std::size_t>(clock.driven())] != 0, begin_);
  Instant instant;
  instant.time = now_ = begin_;
  for (IslandRun* island : running_) {
    island->evaluate_sources(instant.time);
    const IslandAt start_of_island = at(*island, begin_);
    recorders_.opened(start_of_island, {});
    if (island->take_breakpoints(instant.time)) recorders_.sources_jumped(start_of_island);
    recorders_.start_is_known(start_of_island);
  }
  if (!settle(instant, true)) return false;
  recorders_.run_has_begun();
  if (instant.jumps > 0 && is_start_given_) answer_.remarks.push_back(projected_start());
  return true;
}

/// A group looks as far as nothing happens to it, whatever happens elsewhere: else an answer would depend, in its last digits, on what other parts run
/// beside it, that is on what is saved.
double ExactRun::next_instant() {
  double horizon = request_.stop;
  if (request_.sampler != nullptr) horizon = std::min(horizon, request_.sampler->next());
  const double limit = horizon;
  for (Group& group : groups_) {
    double own = limit;
    for (const std::size_t other : group.steered_by) own = std::min(own, groups_[other].horizon);
    for (const model::Clock* clock : group.clocks) own = std::min(own, clock->next().time);
    for (const IslandRun* island : group.islands) own = std::min(own, island->next_break());
    for (IslandRun* island : group.islands) own = island->certify(own);
    group.horizon = own;
    horizon = std::min(horizon, own);
  }
  return horizon;
}

void ExactRun::open_island(IslandRun& island, Instant& instant) {
  Opened& opened = opened_[number_of(island)];
  if (opened == Opened::no) opened = Opened::from_outside;
  // What lies between the last of many events and their limit is no segment.
  const double length = island.is_at_limit(instant.time) ? 0.0 : std::max(island.length_until(instant.time, instant.late), 0.0);
  recorders_.opens(at(island, instant.time), length);
  const Opening opening{!island.is_open() && island.mode != nullptr, opened == Opened::from_outside,
                        island.next_break() <= instant.time + tolerance_};
  island.open(instant.time, instant.late);
  // What holds nothing but sources has not been brought along.
  if (request_.probes.sink != nullptr && island.is_static() && island.next_break() <= instant.time) island.evaluate_sources(instant.time);
  recorders_.opened(at(island, instant.time), opening);
  if (island.take_breakpoints(instant.time)) {
    instant.source_edge = true;
    recorders_.sources_jumped(at(island, instant.time));
  }
}

void ExactRun::open_event_islands(double time, Instant& instant) {
  std::fill(opened_.begin(), opened_.end(), Opened::no);
  for (IslandRun* island : running_) {
    const bool breaks = island->next_break() <= time + tolerance_;
    const bool crosses = island->has_event_at(time);
    if (crosses && !breaks) opened_[number_of(*island)] = Opened::by_own_event;
    if (breaks || crosses) open_island(*island, instant);
  }
}

/// The signals are those just before what happens at `time`.
bool ExactRun::ask_sampler(double time) {
  row(time, sampled_.data());
  settings_.clear();
  if (!request_.sampler->sample(time, std::span(sampled_).subspan(1), settings_)) {
    fail(interrupted(now_));
    return false;
  }
  for (const Sampler::Setting& setting : settings_)
    for (IslandRun* island : running_) island->hold(setting.channel, setting.value, time);
  return true;
}

/// Whether a clock, a breakpoint or an event of an island is due.
bool ExactRun::is_due(double time, Instant& instant) const {
  bool any = false;
  for (const model::Clock& clock : clocks_) {
    if (clock.next().time > time + tolerance_) continue;
    any = true;
    if (clock.next().time == time && instant.late == 0.0) instant.late = clock.next().late;
  }
  for (const IslandRun* island : running_) {
    const bool crosses = island->has_event_at(time);
    instant.crossing |= crosses;
    any |= crosses || island->next_break() <= time + tolerance_;
    if (crosses && island->event_time() == time && instant.late == 0.0) instant.late = island->event_late();
  }
  return any;
}

/// The rows before (row_before_) and after an event.
bool ExactRun::push_event_rows(double time) {
  row_before_[0] = rows_.begin_event(time);
  std::copy(row_before_.begin(), row_before_.end(), rows_.room());
  if (!accepted(rows_.push())) return false;
  row(time, rows_.room());
  rows_.room()[0] = rows_.event_time();
  return accepted(rows_.push());
}

bool ExactRun::handle(double time) {
  if (request_.sampler != nullptr && request_.sampler->next() <= time + tolerance_ && !ask_sampler(time)) return false;
  Instant instant;
  instant.time = time;
  for (const IslandRun* island : running_) modes_before_[number_of(*island)] = island->mode;
  if (!is_due(time, instant)) return true;
  const bool has_rows = rows_.has_event_rows(time);
  if (has_rows) row(time, row_before_.data());
  open_event_islands(time, instant);
  if (!std::all_of(running_.begin(), running_.end(), [&](const IslandRun* island) { return !island->is_open() || holds(*island); }))
    return false;
  if (!settle(instant, false)) return false;
  watch_accumulation(instant);
  const bool happened = instant.source_edge || instant.mode_change || instant.jumps > 0;
  if (!happened) return watch_idle_crowd(instant) && watch_crowd(instant);  // nothing but a corner of a source, or idle flips
  idle_crowd_ = {};
  ++answer_.statistics.events;
  answer_.statistics.jumps += static_cast<std::uint64_t>(instant.jumps > 0);
  recorders_.happened({time, instant.source_edge, instant.mode_change, instant.jumps > 0});
  if (has_rows && !push_event_rows(time)) return false;
  return watch_crowd(instant);
}

/// What a jump costs where the switches that flipped last have opened.
void ExactRun::note_loss(const IslandRun& island, const Instant& instant) {
  std::vector<std::string> opened;
  const model::System& system = island.system();
  for (const int i : last_flips_) {
    const SwitchInfo& info = model_.switches[static_cast<std::size_t>(i)];
    if (info.island != static_cast<int>(number_of(island))) continue;
    const bool inverted = system.switch_inverted[static_cast<std::size_t>(info.port - system.diodes)] != 0;
    if ((on_[static_cast<std::size_t>(i)] != 0) == inverted) opened.push_back(info.name);
  }
  const model::Vector now = Eigen::Map<const model::Vector>(island.x.data(), system.size());
  recorders_.jumped_by_switches(at(island, instant.time), now, opened);
}

/// A change of label counts when a port that is determined in both modes, and not identically zero, changed sides.
void ExactRun::note_mode_changes(Instant& instant) {
  for (IslandRun* island : running_) {
    const model::Mode* before = modes_before_[number_of(*island)];
    if (island->is_open() && before && island->mode != before && island->changes_visibly(*before)) instant.mode_change = true;
  }
}

/// Rows with a time before `time` (or at it, when inclusive).
bool ExactRun::rows_before(double time, bool inclusive) {
  while (rows_.is_due(time, inclusive)) {
    const double row_time = rows_.next_time();
    const RowFeed::Pushed pushed = rows_.push_next(*this);
    if (pushed == RowFeed::Pushed::handed_over) now_ = std::max(now_, row_time);  // nothing happens between the last instant and this row
    if (!accepted(pushed)) return false;
  }
  return true;
}

void ExactRun::row(double time, double* row) {
  std::fill(row, row + rows_.width(), 0.0);
  row[0] = time;
  for (auto& island : islands_) island.add_signals(time, row + 1);
}

bool ExactRun::is_interrupted() const { return request_.interrupt && request_.interrupt->load(std::memory_order_relaxed) != 0; }

/// Whether the run goes on after a row.
bool ExactRun::accepted(RowFeed::Pushed pushed) {
  if (pushed == RowFeed::Pushed::handed_over && is_interrupted()) fail(interrupted(now_));
  if (pushed == RowFeed::Pushed::handed_over && request_.progress) request_.progress(now_);
  return take(pushed != RowFeed::Pushed::refused) && answer_.outcome == Outcome::completed;
}

bool ExactRun::take(bool accepted) {
  if (!accepted && answer_.outcome == Outcome::completed) fail({Outcome::sink_stopped, "", ""});
  return accepted;
}

}  // namespace pwlsim::engine
