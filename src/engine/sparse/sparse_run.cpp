#include "engine/sparse/sparse_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "engine/remarks.hpp"
#include "engine/sparse/jumps.hpp"
#include "engine/sparse/tolerances.hpp"
#include "linalg/legendre.hpp"

namespace pwlsim::engine::sparse {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t rows_per_block = 256;
constexpr int steps_between_checks = 64;
/// Residuals beyond so many tolerances are told; those of diodes that changed sides within the tolerance are below it.
constexpr double doubtful_tolerances = 10.0;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

SparseRun::SparseRun(const std::vector<std::unique_ptr<const Part>>& parts, std::size_t signals, const Request& request, double reltol,
                     PartRun::Method method, RowSink& sink)
    : request_(request),
      reltol_(reltol),
      method_(method),
      tolerance_(tolerance::merge * request.stop),
      rows_(request, sink, signals, rows_per_block, tolerance_) {
  for (const auto& part : parts) {
    tracks_.push_back(std::make_unique<Track>(*part, request, reltol, method));
    find_shares(*tracks_.back());
  }
}

/// Signals of the track that are parts of probes.
void SparseRun::find_shares(Track& track) const {
  const auto& probes = request_.probes.signals;
  const auto& numbers = track.part.island.signal_number;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    for (std::size_t probe = 0; probe < probes.size(); ++probe) {
      if (probes[probe] != numbers[i]) continue;
      track.shares.push_back(static_cast<int>(i));
      track.probes.push_back(static_cast<int>(probe));
    }
  track.values.resize(std::max(numbers.size(), track.shares.size()));
}

bool SparseRun::fail(const Answer& failure) {
  if (answer_.outcome == Outcome::completed) end({failure.outcome, failure.id, failure.message, failure.elements});
  return false;
}

std::string SparseRun::mode_text() const {
  ModeText text;
  for (const auto& track : tracks_) {
    const auto& ports = track->part.descriptor.ports();
    const Position& on = track->run.position();
    for (std::size_t i = 0; i < std::min(ports.size(), on.size()); ++i) text.add(ports[i].name, on[i] != 0);
  }
  return text.str();
}

bool SparseRun::begin(const std::vector<PartStart>& starts) {
  bool has_before = request_.probes.sink != nullptr;
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    has_before = has_before && starts[i].missing.empty() && starts[i].signals.size() == tracks_[i]->part.island.signal_number.size();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Track& track = *tracks_[i];
    const PartStart& start = starts[i];
    if (!track.run.begin(start)) {
      order_.clear();  // others are a little beyond 0 already
      return fail(track.run.failure());
    }
    if (has_before) note_before_start(track, start);
    track.is_start_given = request_.use_initial_conditions && start.unknowns.empty();
    order_.push_back(i);
  }
  if (has_before) hand_over_start();
  std::make_heap(order_.begin(), order_.end(), is_later());
  watch_start();
  return true;
}

/// The part that is least far takes a step; what lies before it is known of all.
bool SparseRun::advance_least() {
  Track& track = *tracks_[order_.front()];
  if (track.run.time() > last_instant_ + tolerance_ && !close_event()) return false;
  if (!rows_before(track.run.time(), false)) return false;
  const double time = track.run.time();
  pieces_before(time);
  if (!track.run.advance()) return fail(track.run.failure());
  hand_over_impulses(track, time);
  watch(track);
  if (!open_event(track)) return false;
  std::pop_heap(order_.begin(), order_.end(), is_later());
  if (track.run.finished())
    order_.pop_back();
  else
    std::push_heap(order_.begin(), order_.end(), is_later());
  return true;
}

void SparseRun::begin_lap(std::vector<std::vector<SegmentRecord>>* records, std::uint64_t most_openings) {
  if (records) records->assign(tracks_.size(), {});
  for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i]->run.begin_lap(records ? &(*records)[i] : nullptr, true, most_openings);
}

std::uint64_t SparseRun::openings() const {
  std::uint64_t most = 0;
  for (const auto& track : tracks_) most = std::max(most, track->run.openings());
  return most;
}

std::vector<PartStart> SparseRun::ends() {
  std::vector<PartStart> ends(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    ends[i].unknowns = tracks_[i]->run.unknowns();
    ends[i].on = tracks_[i]->run.position();
    ends[i].signals.resize(tracks_[i]->part.island.signal_number.size());
    tracks_[i]->run.signals(request_.stop, ends[i].signals.data());
  }
  return ends;
}

Answer SparseRun::run(const std::vector<PartStart>& starts) {
  const auto clock = Clock::now();
  bool going = begin(starts);
  for (int count = 0; going && !order_.empty(); ++count) {
    going = advance_least();
    if (going && count % steps_between_checks == 0 && request_.progress && !order_.empty())
      request_.progress(tracks_[order_.front()]->run.time());
    if (going) going = !is_interrupted() && take(rows_.flush_in_time());
  }
  if (answer_.outcome != Outcome::sink_stopped && !close_event()) going = false;
  if (answer_.outcome == Outcome::completed && going) rows_before(request_.stop, true);
  take(rows_.flush());
  answer_.time = request_.stop;
  if (going) pieces_before(request_.stop);
  if (!going) answer_.time = order_.empty() ? 0.0 : std::min(tracks_[order_.front()]->run.time(), request_.stop);
  answer_.probed = answer_.time;
  answer_.statistics.seconds_simulate = seconds_since(clock) - rows_.seconds();
  answer_.statistics.rows = rows_.count();
  tell_event();
  finish();
  return std::move(answer_);
}

/// Signals are sums of what the parts have of them.
void SparseRun::row(double time, double* values) {
  std::fill(values, values + rows_.width(), 0.0);
  values[0] = time;
  for (const auto& track : tracks_) {
    track->run.signals(time, track->values.data());
    for (std::size_t i = 0; i < track->part.island.signal_number.size(); ++i)
      values[1 + static_cast<std::size_t>(track->part.island.signal_number[i])] += track->values[i];
  }
}

bool SparseRun::is_interrupted() {
  if (!request_.interrupt || request_.interrupt->load(std::memory_order_relaxed) == 0) return false;
  end(interrupted(order_.empty() ? request_.stop : tracks_[order_.front()]->run.time()));
  return true;
}

bool SparseRun::rows_before(double time, bool inclusive) {
  while (rows_.is_due(time, inclusive))
    if (!accepted(rows_.push_next(*this))) return false;
  return true;
}

/// All ports, track by track.
void SparseRun::watch_start() {
  if (request_.watcher == nullptr) return;
  std::vector<std::string> elements;
  for (const auto& track : tracks_) {
    for (const DescriptorPort& port : track->part.descriptor.ports()) elements.push_back(port.name);
    on_.insert(on_.end(), track->run.position().begin(), track->run.position().end());
  }
  request_.watcher->begin(elements, on_);
}

/// What parts come upon within the tolerance of an instant is one event.
void SparseRun::watch(const Track& track) {
  const auto& instant = track.run.instant();
  if (request_.watcher == nullptr || !instant) return;
  if (event_ && std::abs(instant->time - event_->time) > tolerance_) tell_event();
  if (!event_) event_ = Event{.time = instant->time};
  event_->source_edge |= instant->source_edge;
  event_->mode_change |= instant->mode_change;
  event_->jump |= instant->jump;
  auto place = on_.begin();
  for (const auto& before : tracks_) {
    if (before.get() == &track) break;
    place += static_cast<std::ptrdiff_t>(before->run.position().size());
  }
  std::copy(track.run.position().begin(), track.run.position().end(), place);
}

void SparseRun::tell_event() {
  if (event_) request_.watcher->happened(*event_, on_);
  event_.reset();
}

/// A track's share of the probes at the operating point.
void SparseRun::note_before_start(const Track& track, const PartStart& start) {
  const auto& probes = request_.probes.signals;
  piece_values_.resize(probes.size());
  for (std::size_t k = 0; k < track.shares.size(); ++k)
    piece_values_[static_cast<std::size_t>(track.probes[k])] += start.signals[static_cast<std::size_t>(track.shares[k])];
}

/// What was before t = 0, and what happened then.
void SparseRun::hand_over_start() {
  request_.probes.sink->before_start(piece_values_);
  for (const auto& track : tracks_) hand_over_impulses(*track, 0.0);
}

void SparseRun::hand_over_impulses(const Track& track, double time) {
  const std::vector<double>& impulses = track.run.impulses();
  if (impulses.empty() || track.shares.empty()) return;
  std::vector<double> values(request_.probes.signals.size(), 0.0);
  for (std::size_t k = 0; k < track.shares.size(); ++k)
    values[static_cast<std::size_t>(track.probes[k])] += impulses[static_cast<std::size_t>(track.shares[k])];
  request_.probes.sink->impulse(time, values);
}

/// What lies before the instant that the least track stands at, of the last stretches of all.
void SparseRun::pieces_before(double time) {
  const Probes& probes = request_.probes;
  if (probes.sink == nullptr || time <= piece_time_) return;
  const double from = std::max(piece_time_, probes.from);
  const double to = std::min(time, probes.to);
  piece_time_ = time;
  if (from >= to) return;
  constexpr std::size_t points = linalg::legendre_points;
  const auto& point = linalg::gauss_legendre().point;
  piece_values_.resize(probes.signals.size() * points);
  std::fill(piece_values_.begin(), piece_values_.end(), 0.0);
  for (const auto& track : tracks_)
    for (std::size_t i = 0; i < points && !track->shares.empty(); ++i) {
      track->run.signals(from + 0.5 * (1.0 + point[i]) * (to - from), track->shares, track->values.data());
      for (std::size_t k = 0; k < track->shares.size(); ++k)
        piece_values_[static_cast<std::size_t>(track->probes[k]) * points + i] += track->values[k];
    }
  note_noise();
  probes.sink->take({from, to, from, to - from, piece_values_, probe_noise_});
}

/// A current through a resistor behind a blocked diode is what rounding leaves of the difference of two voltages.
void SparseRun::note_noise() {
  std::vector<double> sizes(request_.probes.signals.size(), 0.0);
  for (const auto& track : tracks_)
    for (std::size_t k = 0; k < track->shares.size(); ++k)
      sizes[static_cast<std::size_t>(track->probes[k])] += track->run.signal_size(track->shares[k]);
  probe_noise_.resize(sizes.size(), 0.0);
  for (std::size_t i = 0; i < sizes.size(); ++i) probe_noise_[i] = std::max(probe_noise_[i], tolerance::signal_rounding * sizes[i]);
}

/// A row before what the part's last step came upon; the one after it waits for the parts that come upon the same.
bool SparseRun::open_event(Track& track) {
  const auto& instant = track.run.instant();
  if (!instant) return true;
  const double time = instant->time;
  if (std::abs(time - last_instant_) <= tolerance_) {
    ++shared_instants_;
    return true;
  }
  last_instant_ = time;
  if (!rows_.has_event_rows(time)) return true;
  double* before = rows_.room();
  row(time, before);
  before[0] = rows_.begin_event(time);
  for (std::size_t i = 0; i < track.part.island.signal_number.size(); ++i)
    before[1 + static_cast<std::size_t>(track.part.island.signal_number[i])] += track.run.signals_before()[i] - track.values[i];
  event_open_ = true;
  return accepted(rows_.push());
}

/// The row after the event, once all parts are beyond it.
bool SparseRun::close_event() {
  if (!event_open_) return true;
  event_open_ = false;
  row(last_instant_, rows_.room());
  rows_.room()[0] = rows_.event_time();
  return accepted(rows_.push());
}

/// Whether the run goes on after a row.
bool SparseRun::accepted(RowFeed::Pushed pushed) {
  return take(pushed != RowFeed::Pushed::refused) && (pushed == RowFeed::Pushed::kept || !is_interrupted());
}

bool SparseRun::take(bool accepted) {
  if (!accepted && answer_.outcome == Outcome::completed) end({Outcome::sink_stopped, "", ""});
  return accepted;
}

void SparseRun::end(Ending ending) {
  end_run(answer_, std::move(ending));
  answer_.mode = mode_text();
}

void SparseRun::finish() {
  answer_.statistics.islands = tracks_.size();
  const auto clock = Clock::now();
  Certificate& c = answer_.certificate;
  c.has_passivity = c.passive = true;
  double damped = 0.0;
  if (std::any_of(tracks_.begin(), tracks_.end(), [](const auto& track) { return track->is_start_given && track->run.start_projected(); }))
    answer_.remarks.push_back(projected_start());
  for (const auto& track : tracks_) {
    track->run.add_statistics(answer_.statistics);
    const auto& jumps = track->run.jumps();
    answer_.jumps.insert(answer_.jumps.end(), jumps.begin(), jumps.end());
    for (Remark& remark : track->run.threshold_remarks()) answer_.remarks.push_back(std::move(remark));
    const std::vector<Remark>& limits = track->run.limits();
    answer_.remarks.insert(answer_.remarks.end(), limits.begin(), limits.end());
    answer_.statistics.accumulations += limits.size();
    const Certificate own = track->run.certificate().check();
    c.complementarity = std::max(c.complementarity, own.complementarity);
    c.kcl_kvl = std::max(c.kcl_kvl, own.kcl_kvl);
    c.energy = std::max(c.energy, own.energy);
    c.points_checked += own.points_checked;
    if (method_ == PartRun::Method::segments && request_.jumps) {
      c.error_bound = std::max(c.error_bound.value_or(0.0), track->run.error_bound());
      c.error_holds = c.error_holds && track->run.error_holds() && track->part.descriptor.passive();
    }
    damped = std::max(damped, track->run.damped());
    c.passive = c.passive && track->part.descriptor.passive();
  }
  std::set<std::string> open;
  for (const auto& track : tracks_)
    for (std::string& name : track->run.open_signals()) open.insert(std::move(name));
  if (!open.empty()) answer_.remarks.push_back(indeterminate(open));
  std::stable_sort(answer_.jumps.begin(), answer_.jumps.end(), [](const Jump& a, const Jump& b) { return a.time < b.time; });
  answer_.jumps.resize(std::min(answer_.jumps.size(), most_jumps_kept));
  answer_.statistics.events -= shared_instants_;
  const double worst = std::max({c.complementarity, c.kcl_kvl, c.energy, damped});
  const bool has_segments = method_ == PartRun::Method::segments;
  const bool is_doubtful = worst > (has_segments ? tolerance::doubtful_segments : doubtful_tolerances * reltol_);
  if (is_doubtful && has_segments && answer_.outcome == Outcome::completed) {
    end_run(answer_,
            {Outcome::no_solution, "E-certificate",
             fmt::format("the worst residual of the run is {:.1e}: its rows do not satisfy the circuit; try --engine exact", worst)});
  } else if (is_doubtful) {
    answer_.remarks.push_back(doubtful_certificate(worst));
  }
  if (!c.passive)
    answer_.remarks.push_back(
        {"N-not-examined",
         "the circuit contains controlled sources or blocks that may feed energy in, so its solution need not be unique; "
         "the engine takes the one it finds, --engine modes checks it"});
  answer_.statistics.seconds_certificate = seconds_since(clock);
}

}  // namespace pwlsim::engine::sparse
