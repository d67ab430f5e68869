#include "analysis/run_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace pwlsim::analysis {
namespace {

constexpr std::size_t most_changes = 50'000, most_events = 20'000, most_shared_events = 60'000;
constexpr std::size_t pieces = 4000;
constexpr std::size_t most_changes_told = 12;

}  // namespace

std::vector<std::string> port_names(std::span<const std::string> elements) {
  std::map<std::string, int> seen;
  std::vector<std::string> names;
  for (const std::string& element : elements) {
    const int number = ++seen[element];
    names.push_back(number == 1 ? element : fmt::format("{} ({})", element, number));
  }
  return names;
}

RunRecorder::RunRecorder(double from, double to, std::size_t signals, std::size_t sharers)
    : from_(from),
      to_(to),
      end_(to),
      solution_(from, to, std::min(signals, most_signals), sharers),
      most_events_(std::clamp(most_shared_events / sharers, pieces, most_events)) {}

void RunRecorder::take_piece(engine::Piece piece) {
  piece.from = std::max(piece.from, from_);
  if (piece.from < piece.to) solution_.take(piece);
}

double RunRecorder::piece_length() const { return (to_ - from_) / static_cast<double>(pieces); }

std::size_t RunRecorder::piece_of(double time) const {
  const double number = (time - from_) / piece_length();
  return static_cast<std::size_t>(std::clamp(number, 0.0, static_cast<double>(pieces - 1)));
}

void RunRecorder::begin(std::span<const std::string> elements, std::span<const char> on) {
  last_.assign(on.begin(), on.end());
  elements_ = port_names(elements);
  for (std::size_t i = 0; i < std::min(elements_.size(), most_lanes); ++i)
    tracks_.push_back({elements_[i], on[i] != 0, on[i] != 0, from_, {}, {}});
}

void RunRecorder::happened(const engine::Event& event, std::span<const char> on) {
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    if ((on[i] != 0) != tracks_[i].on) change(tracks_[i], on[i] != 0, event.time);
  if (event.time >= from_) {
    ++event_count_;
    if (told_.size() < most_told) tell(event, on);
    keep(event);
  }
  std::copy(on.begin(), on.end(), last_.begin());
}

void RunRecorder::end(double time) { end_ = std::clamp(time, from_, to_); }

void RunRecorder::tell(const engine::Event& event, std::span<const char> on) {
  ToldEvent told{event, {}, 0};
  for (std::size_t i = 0; i < on.size(); ++i) {
    if ((on[i] != 0) == (last_[i] != 0)) continue;
    if (told.changes.size() < most_changes_told)
      told.changes.push_back(elements_[i] + (on[i] != 0 ? " on" : " off"));
    else
      ++told.more_changes;
  }
  told_.push_back(std::move(told));
}

void RunRecorder::keep(const engine::Event& event) {
  const auto joins = [&](const engine::Event& next) { return piece_of(events_.back().time) == piece_of(next.time); };
  const auto add = [&](const engine::Event& next) {
    if (!events_folded_ || events_.empty() || !joins(next)) {
      events_.push_back(next);
      return;
    }
    engine::Event& last = events_.back();
    last.source_edge |= next.source_edge;
    last.mode_change |= next.mode_change;
    last.jump |= next.jump;
  };
  add(event);
  if (events_folded_ || events_.size() <= most_events_) return;
  events_folded_ = true;
  std::vector<engine::Event> all;
  std::swap(all, events_);
  for (const engine::Event& each : all) add(each);
}

void RunRecorder::change(Track& track, bool on, double time) {
  track.on = on;
  if (time <= from_) {
    track.on_first = on;
    return;
  }
  if (changes_folded_) {
    if (!on) add_on_time(track, track.since, time);
    track.since = time;
    return;
  }
  track.changes.push_back(time);
  if (++change_count_ > most_changes) fold_changes();
}

void RunRecorder::fold_changes() {
  changes_folded_ = true;
  for (Track& track : tracks_) {
    track.on_time.assign(pieces, 0.0);
    bool on = track.on_first;
    for (const double time : track.changes) {
      if (on) add_on_time(track, track.since, time);
      track.since = time;
      on = !on;
    }
    track.changes = {};
  }
}

void RunRecorder::add_on_time(Track& track, double from, double to) const {
  const double length = piece_length();
  for (std::size_t p = piece_of(from); p <= piece_of(to); ++p) {
    const double begin = from_ + static_cast<double>(p) * length;
    track.on_time[p] += std::max(0.0, std::min(to, begin + length) - std::max(from, begin));
  }
}

waveform::Lane RunRecorder::lane(const Track& track) const {
  waveform::Lane lane{track.name, {from_}, {track.on_first ? 1.0 : 0.0}};
  if (!changes_folded_) {
    for (const double time : track.changes) {
      lane.times.push_back(time);
      lane.shares.push_back(1.0 - lane.shares.back());
    }
    return lane;
  }
  Track whole = track;
  if (track.on) add_on_time(whole, track.since, end_);
  lane.times.clear();
  lane.shares.clear();
  for (std::size_t p = 0; p <= piece_of(end_); ++p) {
    const double begin = from_ + static_cast<double>(p) * piece_length();
    const double length = std::min(piece_length(), end_ - begin);
    // A piece that is on, or off, throughout is so to rounding.
    const double share = length > 0.0 ? std::round(1e6 * std::min(1.0, whole.on_time[p] / length)) / 1e6 : 0.0;
    if (!lane.shares.empty() && lane.shares.back() == share) continue;
    lane.times.push_back(begin);
    lane.shares.push_back(share);
  }
  return lane;
}

std::vector<waveform::Lane> RunRecorder::lanes() const {
  std::vector<waveform::Lane> result;
  for (const Track& track : tracks_) result.push_back(lane(track));
  return result;
}

}  // namespace pwlsim::analysis
