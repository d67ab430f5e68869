#pragma once
/// A recorded run: its segments and instants in order, for computations along them.

#include <functional>
#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/exact/observer.hpp"

namespace pwlsim::steady {

struct TraceSegment {
  std::size_t island = 0;
  const model::Mode* mode = nullptr;
  double begin = 0.0, length = 0.0;  ///< s
  std::vector<double> y0, y1;        ///< (c, ζ) at its begin and end
};

/// Segments that end at an instant, and the instant.
struct TraceStep {
  std::vector<TraceSegment> segments;
  double time = 0.0;
  bool has_jump = false;
  std::vector<engine::Change> changes;
  std::vector<char> on;  ///< switches right of the instant
};

struct Trace {
  std::vector<TraceStep> steps;    ///< the first is t = 0
  std::vector<TraceSegment> tail;  ///< segments that the end of the run cuts
  [[nodiscard]] std::size_t segments() const;
};

/// Removes instants after `end`, s. One at the end stays.
void end_at(Trace& trace, double end);

/// Each island's share of its signals just before the end of the period of the trace; empty if one is not known.
[[nodiscard]] std::vector<std::vector<double>> signals_at_end(const engine::ExactModel& model, const Trace& trace, double period);

/// Whether the run must end at this instant, given the switches before it.
using EndsAt = std::function<bool(const engine::InstantView&, const std::vector<char>& on_before)>;

class TraceRecorder : public engine::Observer {
 public:
  /// `ends_at` may be empty. `on`: switches at the start.
  explicit TraceRecorder(std::vector<char> on, EndsAt ends_at = {}) : on_(std::move(on)), ends_at_(std::move(ends_at)) {}

  void segment(const engine::SegmentView& view) override;
  bool instant(const engine::InstantView& view) override;
  /// The recorded trace; the recorder is empty afterwards.
  [[nodiscard]] Trace take();
  [[nodiscard]] bool has_ended() const { return has_ended_; }

 private:
  std::vector<char> on_;
  EndsAt ends_at_;
  bool has_ended_ = false;
  std::vector<TraceSegment> segments_;
  Trace trace_;
};

}  // namespace pwlsim::steady
