#pragma once
/// What a run tells of itself: the segments it went through, and the instants between them.

#include <span>
#include <vector>

#include "model/mode.hpp"

namespace pwlsim::engine {

/// A stretch of one island in one mode; y = (c, ζ), mode.ny entries.
struct SegmentView {
  std::size_t island = 0;
  const model::Mode* mode = nullptr;
  double begin = 0.0, length = 0.0;  ///< s
  const double* y0 = nullptr;        ///< at its begin
  const double* y1 = nullptr;        ///< at its end, sources at their left limit
};

/// Why an island was looked at.
enum class Cause {
  start,         ///< t = 0
  time,          ///< a source or a clock, at a time that no state moves
  guard,         ///< a guard of its own passed zero
  outside,       ///< a switch of it was moved by another island
  decays,        ///< fast decays are over, and the slow motion goes on
  undecided,     ///< the search for events could not tell: what happens here has no guard
  accumulation,  ///< the limit of infinitely many events
};

/// What an instant does to one island.
struct Change {
  std::size_t island = 0;
  Cause cause = Cause::start;
  int guard = -1;                      ///< row of `before->guards`, with Cause::guard
  const model::Mode* before = nullptr;  ///< null at the start
  std::vector<double> y_before;         ///< in `before`
  std::vector<const model::Mode*> by_way_of;  ///< modes that were entered for no time, or jumped into, in order; the last is `after`
  const model::Mode* after = nullptr;
  std::vector<double> y_after;  ///< in `after`
};

struct InstantView {
  double time = 0.0;  ///< s
  bool has_jump = false;
  std::span<const Change> changes;
  std::span<const char> on;  ///< switches of the model, right of the instant
};

class Observer {
 public:
  virtual ~Observer() = default;
  virtual void segment(const SegmentView&) {}
  /// False: the run ends here.
  virtual bool instant(const InstantView&) { return true; }
};

}  // namespace pwlsim::engine
