#pragma once
/// Collects the changes at an instant for an observer.

#include "engine/exact/island_run.hpp"
#include "engine/exact/observer.hpp"

namespace pwlsim::engine {

class ObserverFeed {
 public:
  ObserverFeed(Observer* observer, std::size_t islands) : observer_(observer), place_(observer ? islands : 0, none) {}

  /// The island is open at t = 0.
  void started(std::size_t island) {
    if (observer_) begin(island).cause = Cause::start;
  }
  /// The island has been opened; its segment ends. `from_outside`: the reason is not its sources or guards.
  void opened(std::size_t island, const IslandRun& run, double time, bool from_outside, bool breaks) {
    if (observer_) take_opening(island, run, time, from_outside, breaks);
  }
  /// A mode has been selected; there may be further ones at the same instant.
  void selected(std::size_t island, const IslandRun& run) {
    if (observer_) take_selection(island, run);
  }
  /// The new segment has begun.
  void closed(std::size_t island, const IslandRun& run) {
    if (observer_) take_end(island, run);
  }
  /// All islands are closed again. False: the observer ends the run.
  bool end(double time, bool has_jump, const std::vector<char>& on);
  /// The run ends within a segment.
  void ended(std::size_t island, const IslandRun& run, double time) {
    if (observer_) end_segment(island, run, time, run.length_before());
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  Change& begin(std::size_t island);
  void take_opening(std::size_t island, const IslandRun& run, double time, bool from_outside, bool breaks);
  void take_selection(std::size_t island, const IslandRun& run);
  void take_end(std::size_t island, const IslandRun& run);
  void end_segment(std::size_t island, const IslandRun& run, double time, double length);

  Observer* observer_;
  std::vector<std::size_t> place_;  ///< of each island in changes_
  std::vector<Change> changes_;
};

}  // namespace pwlsim::engine
