#pragma once
/// Collects the changes at an instant for an observer.

#include "engine/exact/observer.hpp"
#include "engine/exact/recorder.hpp"

namespace pwlsim::engine {

class ObserverFeed : public Recorder {
 public:
  ObserverFeed(Observer* observer, std::size_t islands) : observer_(observer), place_(observer ? islands : 0, none) {}

  void started(const IslandAt& island) {
    if (observer_) begin(island.number).cause = Cause::start;
  }
  void opened(const IslandAt& island, const Opening& opening) {
    if (observer_ && opening.ends_segment) take_opening(island, opening);
  }
  void selected(const IslandAt& island, const model::Selected& /*selected*/) {
    if (observer_) take_selection(island);
  }
  void closed(const IslandAt& island) {
    if (observer_) take_end(island);
  }
  bool instant_ended(double time, bool has_jump, const std::vector<char>& on);
  void left(const IslandAt& island) {
    if (observer_) end_segment(island);
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  Change& begin(std::size_t island);
  void take_opening(const IslandAt& island, const Opening& opening);
  void take_selection(const IslandAt& island);
  void take_end(const IslandAt& island);
  void end_segment(const IslandAt& island);

  Observer* observer_;
  std::vector<std::size_t> place_;  ///< of each island in changes_
  std::vector<Change> changes_;
};

}  // namespace pwlsim::engine
