#include "engine/exact/observer_feed.hpp"

namespace pwlsim::engine {

Change& ObserverFeed::begin(std::size_t island) {
  place_[island] = changes_.size();
  changes_.emplace_back();
  changes_.back().island = island;
  return changes_.back();
}

void ObserverFeed::end_segment(const IslandAt& island) {
  const Segment& segment = island.run.segment();
  const double length = island.run.length_before();
  observer_->segment({island.number, segment.mode, island.time - length, length, segment.y0.data(), segment.y.data()});
}

void ObserverFeed::take_opening(const IslandAt& island, const Opening& opening) {
  const IslandRun& run = island.run;
  Change& change = begin(island.number);
  change.before = run.segment().mode;
  if (run.is_open_at_limit()) {
    change.cause = Cause::accumulation;
    return;
  }
  end_segment(island);
  change.y_before.assign(run.segment().y.begin(), run.segment().y.begin() + change.before->ny);
  change.guard = run.passed_row >= 0 && !opening.breaks ? run.passed_row : -1;
  change.cause = run.is_settled()       ? Cause::decays
                 : change.guard >= 0    ? Cause::guard
                 : run.is_undecided()   ? Cause::undecided
                 : opening.from_outside ? Cause::outside
                                        : Cause::time;
}

void ObserverFeed::take_selection(const IslandAt& island) {
  if (place_[island.number] == none) return;
  Change& change = changes_[place_[island.number]];
  const auto& jumped = island.run.selector().jumped_into();
  change.by_way_of.insert(change.by_way_of.end(), jumped.begin(), jumped.end());
  change.by_way_of.push_back(island.run.mode);
}

void ObserverFeed::take_end(const IslandAt& island) {
  if (place_[island.number] == none) return;
  Change& change = changes_[place_[island.number]];
  const Segment& segment = island.run.segment();
  change.after = segment.mode;
  if (change.by_way_of.empty() || change.by_way_of.back() != change.after) change.by_way_of.push_back(change.after);
  change.y_after.assign(segment.y0.begin(), segment.y0.begin() + change.after->ny);
}

bool ObserverFeed::instant_ended(double time, bool has_jump, const std::vector<char>& on) {
  if (!observer_) return true;
  const bool goes_on = observer_->instant({time, has_jump, changes_, on});
  for (const Change& change : changes_) place_[change.island] = none;
  changes_.clear();
  return goes_on;
}

}  // namespace pwlsim::engine
