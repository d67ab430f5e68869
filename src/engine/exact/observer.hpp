#pragma once
/// The reports of a run to an observer: its segments, and the instants between them. A circuit falls into islands, parts that share no state; a
/// segment belongs to one, and one instant may change several. y = (c, ζ) is the state of a mode (model/mode.hpp): c of the island, ζ of its
/// sources. Pointers and spans are valid during the call; modes live as long as the run's March.

#include <span>
#include <vector>

#include "model/mode.hpp"

namespace pwlsim::engine {

/// A time interval of one island in one mode; y = (c, ζ), mode.ny entries.
struct SegmentView {
  std::size_t island = 0;
  const model::Mode* mode = nullptr;
  double begin = 0.0, length = 0.0;  ///< s
  const double* y0 = nullptr;        ///< at its begin
  const double* y1 = nullptr;        ///< at its end, sources at their left limit
};

/// Why an island is examined at an instant.
enum class Cause {
  start,         ///< t = 0
  time,          ///< a source or a clock, at a time that does not depend on any state
  guard,         ///< one of its own guards crosses zero
  outside,       ///< another island changes one of its switches
  decays,        ///< fast decays have ended, and the slow motion continues
  undecided,     ///< the search for events could not decide: no guard is known
  accumulation,  ///< the limit of infinitely many events
};

/// The change of one island at an instant.
struct Change {
  std::size_t island = 0;
  Cause cause = Cause::start;
  int guard = -1;                             ///< row of `before->guards`, with Cause::guard
  const model::Mode* before = nullptr;        ///< null at the start
  std::vector<double> y_before;               ///< in `before`
  std::vector<const model::Mode*> by_way_of;  ///< modes entered for zero time, or jumped into, in order; the last is `after`
  const model::Mode* after = nullptr;
  std::vector<double> y_after;  ///< in `after`
};

struct InstantView {
  double time = 0.0;  ///< s
  bool has_jump = false;
  std::span<const Change> changes;
  std::span<const char> on;  ///< switches of the model, after the instant
};

/// In order of time: an instant comes after the segments that end there, and before those that begin.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void segment(const SegmentView&) {}
  /// False: the run ends here.
  virtual bool instant(const InstantView&) { return true; }
};

}  // namespace pwlsim::engine
