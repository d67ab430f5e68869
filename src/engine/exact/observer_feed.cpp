#include "engine/exact/observer_feed.hpp"

namespace pwlsim::engine {

Change& ObserverFeed::begin(std::size_t island) {
  place_[island] = changes_.size();
  changes_.emplace_back();
  changes_.back().island = island;
  return changes_.back();
}

void ObserverFeed::end_segment(std::size_t island, const IslandRun& run, double time, double length) {
  const Segment& segment = run.segment();
  observer_->segment({island, segment.mode, time - length, length, segment.y0.data(), segment.y.data()});
}

void ObserverFeed::take_opening(std::size_t island, const IslandRun& run, double time, bool from_outside, bool breaks) {
  Change& change = begin(island);
  change.before = run.segment().mode;
  if (run.is_open_at_limit()) {
    change.cause = Cause::accumulation;
    return;
  }
  end_segment(island, run, time, run.length_before());
  change.y_before.assign(run.segment().y.begin(), run.segment().y.begin() + change.before->ny);
  change.guard = run.passed_row >= 0 && !breaks ? run.passed_row : -1;
  change.cause = run.is_settled()     ? Cause::decays
                 : change.guard >= 0  ? Cause::guard
                 : run.is_undecided() ? Cause::undecided
                 : from_outside       ? Cause::outside
                                      : Cause::time;
}

void ObserverFeed::take_selection(std::size_t island, const IslandRun& run) {
  if (place_[island] == none) return;
  Change& change = changes_[place_[island]];
  const auto& jumped = run.selector().jumped_into();
  change.by_way_of.insert(change.by_way_of.end(), jumped.begin(), jumped.end());
  change.by_way_of.push_back(run.mode);
}

void ObserverFeed::take_end(std::size_t island, const IslandRun& run) {
  if (place_[island] == none) return;
  Change& change = changes_[place_[island]];
  change.after = run.segment().mode;
  if (change.by_way_of.empty() || change.by_way_of.back() != change.after) change.by_way_of.push_back(change.after);
  change.y_after.assign(run.segment().y0.begin(), run.segment().y0.begin() + change.after->ny);
}

bool ObserverFeed::end(double time, bool has_jump, const std::vector<char>& on) {
  if (!observer_) return true;
  const bool goes_on = observer_->instant({time, has_jump, changes_, on});
  for (const Change& change : changes_) place_[change.island] = none;
  changes_.clear();
  return goes_on;
}

}  // namespace pwlsim::engine
