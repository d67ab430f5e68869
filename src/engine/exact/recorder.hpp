#pragma once
/// What a run reports of itself, as it happens. A recorder derives from this and hides the reports that it takes; the others cost nothing.
/// Observers of other rooms see the same as whole segments and instants (observer.hpp), from ObserverFeed.

#include <string>
#include <vector>

#include "engine/exact/island_run.hpp"
#include "engine/run.hpp"
#include "model/clock.hpp"
#include "model/selection.hpp"

namespace pwlsim::engine {

/// An island at a time of the run, s.
struct IslandAt {
  std::size_t number;
  const IslandRun& run;
  double time;
};

/// Why an island has been opened.
struct Opening {
  bool ends_segment = false;  ///< it was not open, and had a mode
  bool from_outside = false;  ///< neither its sources nor its guards are the reason
  bool breaks = false;        ///< a source has a breakpoint
};

struct RunEnd {
  const std::vector<model::Clock>& clocks;
  const std::vector<char>& on;  ///< switches
};

class Recorder {
 public:
  /// Each island's share of its signals before the run (RunState::signals).
  void run_begins(const std::vector<std::vector<double>>& /*signals*/) {}
  /// Open at the start of the run, with nothing evaluated.
  void started(const IslandAt& /*island*/) {}
  /// The state from which the island starts is known, sources included, and not projected yet.
  void start_is_known(const IslandAt& /*island*/) {}
  /// All islands have their first segment.
  void run_has_begun() {}

  /// About to be opened, after a segment of this length, s.
  void opens(const IslandAt& /*island*/, double /*length*/) {}
  /// Open, with the state left of the instant; at the start of the run, too.
  void opened(const IslandAt& /*island*/, const Opening& /*opening*/) {}
  /// Sources have passed a breakpoint: the state holds their values after the instant.
  void sources_jumped(const IslandAt& /*island*/) {}
  /// A mode has been selected; there may be further ones at the same instant.
  void selected(const IslandAt& /*island*/, const model::Selected& /*selected*/) {}
  void flipped(int /*number*/) {}
  /// All islands have their modes. `impulses_count`: the state before the instant is one of the run.
  void settled(double /*time*/, bool /*impulses_count*/) {}
  /// The next segment is about to begin.
  void closes(const IslandAt& /*island*/) {}
  /// The state has jumped to `now` at an instant at which these switches have opened.
  void jumped_by_switches(const IslandAt& /*island*/, const model::Vector& /*now*/, const std::vector<std::string>& /*switches*/) {}
  /// The next segment has begun.
  void closed(const IslandAt& /*island*/) {}
  /// False ends the run.
  bool instant_ended(double /*time*/, bool /*has_jump*/, const std::vector<char>& /*on*/) { return true; }
  /// Something visible has happened at that instant.
  void happened(const Event& /*event*/) {}

  /// The run ends at the time at hand, within a segment; it has been opened there if it is left.
  void ends_within(const IslandAt& /*island*/) {}
  void left(const IslandAt& /*island*/) {}
  /// The same at the end of a whole run.
  void reached_end(const IslandAt& /*island*/) {}
  void run_ended(double /*time*/) {}
  /// Jumps and remarks.
  void hand_over(const RunEnd& /*end*/, Answer& /*answer*/) {}
};

}  // namespace pwlsim::engine
