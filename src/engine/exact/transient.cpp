#include "engine/exact/transient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/remarks.hpp"

namespace pwlsim::engine {

namespace {

using Clock = std::chrono::steady_clock;

/// Breakpoints and crossings closer than this fraction of the run are one instant.
constexpr double merge_fraction = 1e-14;
constexpr int most_rounds = 12;  ///< of switches answering switches at one instant
constexpr std::size_t rows_per_block = 1024;
/// Of the time from the first event of a sequence to its limit: so far ahead it is crossed once the limit is known to rounding; and so far
/// where it is known to a fraction of what is ahead. There rounding begins to tell in states that shrink with the square of the time.
constexpr double crossing_fraction = 1e-4;
constexpr double last_crossing_fraction = 1e-5;
constexpr double limit_tolerance = 1e-13;  ///< of the limit's time
constexpr double known_fraction = 1e-2;
/// A run whose certificate is worse than this says so.
constexpr double doubtful_residual = 1e-6;
/// So many events within crowd_fraction of the run are an accumulation that cannot be crossed.
constexpr std::uint64_t crowd_limit = 400;
constexpr double crowd_fraction = 1e-9;
constexpr double idle_crowd_fraction = 1e-6;  ///< the same where guards are passed and nothing happens
constexpr std::uint64_t instants_between_checks = 256;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Elements with a port that is meant; ports of one element stand side by side, and it is named once.
template <typename IsMeant>
std::vector<std::string> port_names(const model::System& system, const IsMeant& is_meant) {
  std::vector<std::string> names;
  for (int i = 0; i < system.ports; ++i) {
    const std::string& name = system.port[static_cast<std::size_t>(i)].name;
    if (is_meant(i) && (names.empty() || names.back() != name)) names.push_back(name);
  }
  return names;
}

std::vector<std::string> all_names(const model::System& system) {
  return port_names(system, [](int) { return true; });
}

/// Elements with a port that is not on the same side in all of the modes.
std::vector<std::string> differing_elements(const model::System& system, const std::vector<const model::Mode*>& modes) {
  const model::IndexSet& first = modes.front()->active;
  return port_names(system, [&](int port) {
    return std::any_of(modes.begin(), modes.end(), [&](const model::Mode* m) { return m->active.contains(port) != first.contains(port); });
  });
}

}  // namespace

Transient::Transient(const ExactModel& exact_model, const Request& request, RowSink& sink)
    : model_(exact_model),
      request_(request),
      sink_(sink),
      jump_recorder_(exact_model.islands, request.jumps),
      port_watch_(islands_, request.watcher),
      pieces_(exact_model.islands, request.probes) {
  islands_.reserve(model_.islands.size());
  for (const auto& island : model_.islands)
    islands_.emplace_back(island, request.non_unique == NonUnique::first ? model::Several::first : model::Several::stay);
  tolerance_ = merge_fraction * request.stop;
  make_clocks();
  order_ = running_;
  std::stable_sort(order_.begin(), order_.end(), [](const auto* a, const auto* b) { return a->system().size() < b->system().size(); });
  modes_before_.assign(islands_.size(), nullptr);
  opened_.assign(islands_.size(), Opened::no);
  all_passive_ = std::all_of(islands_.begin(), islands_.end(), [](const auto& island) { return island.system().passive; });
  width_ = 1 + model_.signal_names.size();
  rows_.resize(rows_per_block * width_);
  row_before_.resize(width_);
  if (request.grid.rows > 0) row_time_ = first_row_time_ = request.grid.time(0);
  for (auto& island : islands_) island.set_tolerance(tolerance_);
  if (request.grid.rows > 2)
    for (auto& island : islands_) island.set_row_step(request.grid.time(1) - request.grid.time(0));
}

void Transient::make_clocks() {
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    const model::System& system = islands_[i].system();
    if (!model::Clock::can_drive(system)) {
      running_.push_back(&islands_[i]);
      if (!system.controls.empty()) steering_.push_back(&islands_[i]);
      continue;
    }
    for (const model::Control& control : system.controls) clocks_.emplace_back(system, control, tolerance_);
  }
}

Answer Transient::run(const Start& start) {
  const auto clock = Clock::now();
  answer_.outcome = Outcome::completed;
  bool going = begin(start);
  while (going) {
    const double time = next_instant();
    if (!rows_before(time, false)) break;
    now_ = time;
    going = handle(time) && time < request_.stop;
    if (++instants_ % instants_between_checks == 0) {
      if (request_.progress) request_.progress(time);
      if (request_.interrupt && request_.interrupt->load(std::memory_order_relaxed) != 0) {
        fail(Outcome::interrupted, "E-interrupted", fmt::format("stopped at t = {} s by a signal", time), {});
        break;
      }
    }
  }
  if (answer_.outcome == Outcome::completed) rows_before(request_.stop, true);
  flush();
  pieces_.advance(islands_, now_);
  answer_.time = now_;
  for (const auto& island : islands_)
    if (island.mode && !island.is_open()) recorder_.add(island.model(), island.segment(), std::max(0.0, now_ - island.segment().anchor));
  answer_.statistics.seconds_simulate = seconds_since(clock) - sink_seconds_;
  finish();
  return std::move(answer_);
}

/// t = 0: states as given, switches where the start has them, then the instant itself.
bool Transient::begin(const Start& start) {
  on_ = start.on;
  pieces_.before_start(start.signals);
  for (IslandRun* island : running_) {
    const auto& xi = start.xi[number_of(*island)];
    std::copy(xi.begin(), xi.end(), island->x.begin());
    island->open_at_start();
  }
  for (std::size_t i = 0; i < on_.size(); ++i) {
    const SwitchInfo& info = model_.switches[i];
    if (info.island >= 0) islands_[static_cast<std::size_t>(info.island)].set_switch(info.port, on_[i] != 0);
  }
  for (model::Clock& clock : clocks_) clock.start(on_[static_cast<std::size_t>(clock.driven())] != 0);
  Instant instant;
  for (IslandRun* island : running_) {
    island->evaluate_sources(0.0);
    jump_recorder_.before(number_of(*island), island->x);
    island->take_breakpoints(0.0);
    recorder_.start(island->model(), island->x.data());
  }
  if (!settle(instant, true)) return false;
  port_watch_.begin();
  if (instant.jumps > 0 && request_.use_initial_conditions) answer_.remarks.push_back(projected_start());
  return true;
}

double Transient::next_instant() {
  double horizon = request_.stop;
  for (const model::Clock& clock : clocks_) horizon = std::min(horizon, clock.next().time);
  for (const IslandRun* island : running_) horizon = std::min(horizon, island->next_break());
  for (IslandRun* island : order_) horizon = island->certify(horizon);
  return std::min(horizon, request_.stop);
}

void Transient::open_island(IslandRun& island, Instant& instant) {
  Opened& opened = opened_[number_of(island)];
  if (opened == Opened::no) opened = Opened::from_outside;
  // What lies between the last of many events and their limit is no segment.
  const double length = island.is_at_limit(instant.time) ? 0.0 : instant.time - island.segment().anchor;
  if (!island.is_open()) recorder_.add(island.model(), island.segment(), length);
  pieces_.advance(islands_, instant.time);
  island.open(instant.time, instant.late);
  jump_recorder_.before(number_of(island), island.x);
  if (island.take_breakpoints(instant.time)) instant.source_edge = true;
}

void Transient::open_event_islands(double time, Instant& instant) {
  std::fill(opened_.begin(), opened_.end(), Opened::no);
  for (IslandRun* island : running_) {
    const bool breaks = island->next_break() <= time + tolerance_;
    const bool crosses = island->has_event() && island->event_time() <= time;
    if (crosses && !breaks) opened_[number_of(*island)] = Opened::by_own_event;
    if (breaks || crosses) open_island(*island, instant);
  }
}

bool Transient::handle(double time) {
  Instant instant;
  instant.time = time;
  for (const IslandRun* island : running_) modes_before_[number_of(*island)] = island->mode;
  bool any = false;
  for (const model::Clock& clock : clocks_) {
    if (clock.next().time > time + tolerance_) continue;
    any = true;
    if (clock.next().time == time && instant.late == 0.0) instant.late = clock.next().late;
  }
  for (const IslandRun* island : running_) {
    const bool crosses = island->has_event() && island->event_time() <= time;
    instant.crossing |= crosses;
    any |= crosses || island->next_break() <= time + tolerance_;
    if (crosses && island->event_time() == time && instant.late == 0.0) instant.late = island->event_late();
  }
  if (!any) return true;
  const bool has_rows = request_.events && time >= first_row_time_ - tolerance_;
  if (has_rows) fill_row(time, row_before_.data());
  open_event_islands(time, instant);
  if (!settle(instant, false)) return false;
  watch_accumulation(instant);
  const bool happened = instant.source_edge || instant.mode_change || instant.jumps > 0;
  if (!happened) return watch_idle_crowd(instant) && watch_crowd(instant);  // nothing but a corner of a source, or idle flips
  idle_crowd_ = {};
  ++answer_.statistics.events;
  answer_.statistics.jumps += static_cast<std::uint64_t>(instant.jumps > 0);
  port_watch_.happened({time, instant.source_edge, instant.mode_change, instant.jumps > 0});
  if (has_rows) {
    // On the grid the row's own time is written.
    const bool on_grid = next_row_ < request_.grid.rows && std::abs(row_time_ - time) <= tolerance_;
    row_before_[0] = last_event_row_ = on_grid ? row_time_ : time;
    std::copy(row_before_.begin(), row_before_.end(), rows_.begin() + static_cast<std::ptrdiff_t>(buffered_ * width_));
    if (!push_row()) return false;
    double* row = &rows_[buffered_ * width_];
    fill_row(time, row);
    row[0] = last_event_row_;
    if (!push_row()) return false;
  }
  return watch_crowd(instant);
}

/// Sources have moved: first the switches that only they drive, so that no mode between two positions is ever entered; then modes,
/// and what those do to the other switches, until nothing moves.
bool Transient::settle(Instant& instant, bool at_start) {
  for (int round = 0; round < most_rounds; ++round) {
    if (flip_without_mode(instant, at_start && round == 0)) continue;
    if (!select_open(instant)) return false;
    if (flip_violated(instant)) continue;
    note_mode_changes(instant);
    for (IslandRun* island : running_) {
      if (!island->is_open()) continue;
      jump_recorder_.after(number_of(*island), instant.time, island->x);
      island->close(instant.time, instant.late, on_);
    }
    return true;
  }
  std::vector<std::string> names;
  for (const int i : flips_) names.push_back(model_.switches[static_cast<std::size_t>(i)].name);
  fail(Outcome::no_solution, "E-no-settle",
       fmt::format("the switches {} find no rest at t = {} s: each position undoes its own condition; try a hysteresis Vh",
                   fmt::join(names, ", "), instant.time),
       names);
  return false;
}

bool Transient::select_open(Instant& instant) {
  for (IslandRun* island : running_) {
    if (!island->is_open()) continue;
    const model::Selected selected = island->select();
    instant.jumps += selected.jumps;
    if (selected.jumps > 0) jump_recorder_.jumped(number_of(*island), selected);
    if (selected.choice == model::Choice::found) continue;
    if (selected.choice == model::Choice::several && request_.non_unique != NonUnique::error) {
      note_several(*island, selected, instant.time);
      continue;
    }
    fail_selection(*island, selected, instant.time);
    return false;
  }
  return true;
}

void Transient::take_clocks(Instant& instant) {
  for (model::Clock& clock : clocks_) {
    if (clock.next().time > instant.time + tolerance_) continue;
    instant.source_edge |= clock.next().is_edge;
    if (clock.next().flips) flips_.push_back(clock.driven());
    clock.take();
  }
}

bool Transient::flip_without_mode(Instant& instant, bool at_start) {
  flips_.clear();
  take_clocks(instant);
  for (IslandRun* island : steering_) {
    if (!island->is_open()) continue;
    for (const int c : island->violated_without_mode(on_, at_start))
      flips_.push_back(island->system().controls[static_cast<std::size_t>(c)].driven);
  }
  return flip(flips_, instant);
}

/// All switches whose control has passed at this instant change together.
bool Transient::flip_violated(Instant& instant) {
  flips_.clear();
  for (IslandRun* island : steering_) {
    if (!island->is_open()) continue;
    for (const int c : island->violated_controls(on_)) flips_.push_back(island->system().controls[static_cast<std::size_t>(c)].driven);
  }
  return flip(flips_, instant);
}

bool Transient::flip(const std::vector<int>& switches, Instant& instant) {
  if (switches.empty()) return false;
  instant.flips = true;
  last_flips_ = switches;
  for (const int s : switches) {
    const auto index = static_cast<std::size_t>(s);
    on_[index] = on_[index] == 0;
    const SwitchInfo& info = model_.switches[index];
    if (info.island < 0) continue;
    IslandRun& island = islands_[static_cast<std::size_t>(info.island)];
    if (!island.is_open()) open_island(island, instant);
    island.set_switch(info.port, on_[index] != 0);
  }
  return true;
}

/// A change of label counts when a port that is determined in both modes, and not identically zero, changed sides.
void Transient::note_mode_changes(Instant& instant) {
  for (IslandRun* island : running_) {
    const model::Mode* before = modes_before_[number_of(*island)];
    if (island->is_open() && before && island->mode != before && island->changes_visibly(*before)) instant.mode_change = true;
  }
}

/// In a passive circuit no events accumulate ahead.
void Transient::watch_accumulation(const Instant& instant) {
  const double time = instant.time;
  if (all_passive_) return;
  for (IslandRun* running : running_) {
    IslandRun& island = *running;
    const Opened opened = opened_[number_of(island)];
    if (island.system().passive || opened == Opened::no) continue;
    AccumulationWatch& watch = island.accumulation();
    if (opened == Opened::from_outside || instant.flips) {  // what switches do infinitely often has no limit
      watch.reset();
      continue;
    }
    watch.note(time, *island.mode, island.x.data(), island.system().n);
    const auto limit = watch.limit();
    if (limit && may_cross(island, *limit, time)) cross(island, *limit);
  }
}

/// Near enough to the limit, which is well known, and nothing else happens before it: no row, no source edge, no event elsewhere.
bool Transient::may_cross(const IslandRun& island, const AccumulationWatch::Limit& limit, double time) {
  const double ahead = limit.time - time;
  const bool known_exactly = limit.uncertainty <= limit_tolerance * limit.time;
  if (!(ahead > 0.0) || ahead > (known_exactly ? crossing_fraction : last_crossing_fraction) * limit.span) return false;
  if (limit.uncertainty > known_fraction * ahead) return false;
  if (limit.time >= request_.stop ||
      (next_row_ < request_.grid.rows && row_time_ > time + tolerance_ && row_time_ < limit.time - tolerance_))
    return false;
  for (const model::Clock& clock : clocks_)
    if (clock.next().time <= limit.time) return false;
  for (IslandRun* other : running_) {
    if (other->next_break() <= limit.time) return false;
    if (other != &island && other->certify(limit.time) < limit.time) return false;
  }
  return true;
}

void Transient::cross(IslandRun& island, const AccumulationWatch::Limit& limit) {
  const std::vector<std::string> names = all_names(island.system());
  answer_.remarks.push_back({"N-accumulation", fmt::format("events accumulate at t = {} s in the part with {}: after {} of them, each {} "
                                                           "taking {:.6g} of the time of those before, the run goes on from "
                                                           "their limit (known to {:.1g} s)",
                                                           limit.time, fmt::join(names, ", "), island.accumulation().events(), limit.period,
                                                           limit.ratio, std::max(limit.uncertainty, tolerance_))});
  ++answer_.statistics.accumulations;
  island.go_to_limit(limit);
  island.accumulation().reset();
}

bool Transient::Crowd::note(double time, double length) {
  if (time - start > length) *this = {time, 0};
  return ++count >= crowd_limit;
}

bool Transient::watch_crowd(const Instant& instant) {
  if (!crowd_.note(instant.time, crowd_fraction * request_.stop)) return true;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < islands_.size(); ++i)
    if (modes_before_[i] && islands_[i].mode != modes_before_[i])
      for (auto& name : differing_elements(islands_[i].system(), {modes_before_[i], islands_[i].mode})) names.push_back(std::move(name));
  return fail_crowd(instant.time, crowd_, names);
}

/// Of instants at which a guard was passed and nothing happened, or nothing but flips of switches that change nothing.
bool Transient::watch_idle_crowd(const Instant& instant) {
  if (!instant.crossing || !idle_crowd_.note(instant.time, idle_crowd_fraction * request_.stop)) return true;
  std::vector<std::string> names;
  for (const int i : last_flips_) names.push_back(model_.switches[static_cast<std::size_t>(i)].name);
  for (std::size_t i = 0; i < islands_.size() && !instant.flips; ++i)
    if (opened_[i] == Opened::by_own_event) names = all_names(islands_[i].system());
  return fail_crowd(instant.time, idle_crowd_, names);
}

bool Transient::fail_crowd(double time, const Crowd& crowd, const std::vector<std::string>& names) {
  fail(Outcome::accumulation, "E-accumulation",
       fmt::format(
           "events accumulate at t = {} s ({} of them within {} s), at {}; try a resistor, capacitor or hysteresis that separates them",
           time, crowd.count, time - crowd.start, fmt::join(names, ", ")),
       names);
  return false;
}

void Transient::note_several(const IslandRun& island, const model::Selected& selected, double time) {
  if (several_++ > 0) return;
  several_text_ = fmt::format("the solution is not unique at t = {} s: {} may go on in {} ways", time,
                              fmt::join(differing_elements(island.system(), selected.details->continuations), ", "),
                              selected.details->continuations.size());
}

void Transient::fail_selection(const IslandRun& island, const model::Selected& selected, double time) {
  if (selected.choice == model::Choice::several) {
    const std::vector<std::string> names = differing_elements(island.system(), selected.details->continuations);
    fail(Outcome::not_unique, "E-not-unique",
         fmt::format("the solution is not unique at t = {} s: {} may go on in {} ways; try .options nonunique=first", time,
                     fmt::join(names, ", "), selected.details->continuations.size()),
         names);
    return;
  }
  const std::vector<std::string> names = all_names(island.system());
  const bool jumps = selected.choice == model::Choice::too_many_jumps;
  fail(Outcome::no_solution, jumps ? "E-jump-cycle" : "E-no-solution",
       fmt::format("{} at t = {} s in the part with {}; try a small resistor in its loops of sources, capacitors and closed switches",
                   jumps ? "the state jumps without end" : "no solution continues", time, fmt::join(names, ", ")),
       names);
}

void Transient::fail(Outcome outcome, std::string id, std::string text, std::vector<std::string> elements) {
  answer_.outcome = outcome;
  answer_.id = std::move(id);
  answer_.message = std::move(text);
  answer_.elements = std::move(elements);
}

/// Rows with a time before `time` (or at it, when inclusive).
bool Transient::rows_before(double time, bool inclusive) {
  // A row within rounding of an instant holds the values after it.
  const double limit = inclusive ? time : time - tolerance_;
  while (next_row_ < request_.grid.rows && (row_time_ < limit || (inclusive && row_time_ <= limit))) {
    const bool written = std::abs(last_event_row_ - row_time_) <= tolerance_;  // by --events
    if (!written && !emit_row(row_time_)) return false;
    ++next_row_;
    if (next_row_ < request_.grid.rows) row_time_ = request_.grid.time(next_row_);
  }
  return true;
}

void Transient::fill_row(double time, double* row) {
  std::fill(row, row + width_, 0.0);
  row[0] = time;
  for (auto& island : islands_) island.add_signals(time, row + 1);
}

bool Transient::emit_row(double time) {
  fill_row(time, &rows_[buffered_ * width_]);
  return push_row();
}

bool Transient::push_row() {
  ++answer_.statistics.rows;
  if (++buffered_ < rows_per_block) return true;
  if (request_.interrupt && request_.interrupt->load(std::memory_order_relaxed) != 0) {
    now_ = std::max(now_, row_time_);  // nothing happens between the last instant and this row
    fail(Outcome::interrupted, "E-interrupted", fmt::format("stopped at t = {} s by a signal", now_), {});
    flush();
    return false;
  }
  if (request_.progress) request_.progress(row_time_);
  return flush();
}

bool Transient::flush() {
  if (buffered_ == 0) return true;
  const auto clock = Clock::now();
  const std::size_t columns = width_ - request_.unsaved_signals;
  keep_columns(rows_.data(), buffered_, width_, columns);
  const bool accepted = sink_.write({rows_.data(), buffered_ * columns}, buffered_);
  sink_seconds_ += seconds_since(clock);
  buffered_ = 0;
  if (!accepted && answer_.outcome == Outcome::completed) fail(Outcome::sink_stopped, "", "", {});
  return accepted;
}

void Transient::note_open_signals() {
  std::set<std::string> names;
  for (const auto& island : islands_)
    for (const std::size_t output : island.selector().open_outputs())
      names.insert(model_.signal_names[static_cast<std::size_t>(island.system().output_signal[output])]);
  if (!names.empty())
    answer_.remarks.push_back(
        {"N-indeterminate",
         fmt::format("{}: the circuit leaves open how currents divide, or where a floating part lies, in some of its modes; the rows hold "
                     "the values of least norm",
                     fmt::join(names, ", "))});
}

void Transient::finish() {
  Statistics& s = answer_.statistics;
  std::set<int> parts;
  for (const auto& island : islands_) parts.insert(island.model().island.part);
  s.islands = parts.size();
  bool passive = true;
  for (const auto& island : islands_) {
    s.states += static_cast<std::uint64_t>(island.system().n);
    s.ports += static_cast<std::uint64_t>(island.system().diodes);
    s.switches += static_cast<std::uint64_t>(island.system().ports - island.system().diodes);
    s.modes_visited += island.selector().modes_visited();
    s.lcp_pivots += island.selector().pivots();
    s.steps += island.locator().intervals();
    passive &= island.system().passive;
    if (island.locator().sampled() > 0)
      answer_.remarks.push_back(
          {"W-events-sampled",
           fmt::format("in {} segments of the part with {} events were looked for at {} points only: parts of it are too fast for "
                       "the bounds that guarantee them; try larger Ron, or no Roff, beside small capacitors and inductors",
                       island.locator().sampled(), island.system().name, 1024)});
  }
  note_open_signals();
  answer_.jumps = jump_recorder_.take();
  if (several_ > 0)
    answer_.remarks.push_back(
        {"N-not-unique",
         fmt::format("{}{}; {} was taken, as .options nonunique says", several_text_,
                     several_ > 1 ? fmt::format(" (and not at {} later ones)", several_ - 1) : "",
                     request_.non_unique == NonUnique::first ? "the first" : "the mode before, or else the one found first,")});
  s.seconds_model = model_.seconds;
  const auto clock = Clock::now();
  answer_.certificate = recorder_.check();
  const double worst = std::max({answer_.certificate.complementarity, answer_.certificate.kcl_kvl, answer_.certificate.energy});
  if (worst > doubtful_residual) answer_.remarks.push_back(doubtful_certificate(worst));
  answer_.certificate.has_passivity = true;
  answer_.certificate.passive = passive;
  s.seconds_certificate = seconds_since(clock);
  answer_.remarks.insert(answer_.remarks.begin(), model_.remarks.begin(), model_.remarks.end());
}

}  // namespace pwlsim::engine
