#include "steady/orbit_trace.hpp"

#include <algorithm>
#include <utility>

namespace pwlsim::steady {

std::size_t Trace::segments() const {
  std::size_t count = tail.size();
  for (const TraceStep& step : steps) count += step.segments.size();
  return count;
}

void end_at(Trace& trace, double end) {
  constexpr double at_end = 1e-12;  // of it
  auto& steps = trace.steps;
  const auto behind = std::find_if(steps.begin(), steps.end(), [&](const TraceStep& step) { return step.time > end * (1.0 + at_end); });
  if (behind == steps.end()) return;
  trace.tail = std::move(behind->segments);
  steps.erase(behind, steps.end());
}

void TraceRecorder::segment(const engine::SegmentView& view) {
  const auto copy = [&](const double* y) { return std::vector<double>(y, y + view.mode->ny); };
  segments_.push_back({view.island, view.mode, view.begin, view.length, copy(view.y0), copy(view.y1)});
}

bool TraceRecorder::instant(const engine::InstantView& view) {
  TraceStep& step = trace_.steps.emplace_back();
  step.segments = std::exchange(segments_, {});
  step.time = view.time;
  step.has_jump = view.has_jump;
  step.changes.assign(view.changes.begin(), view.changes.end());
  step.on.assign(view.on.begin(), view.on.end());
  has_ended_ = ends_at_ && ends_at_(view, on_);
  on_ = step.on;
  return !has_ended_;
}

Trace TraceRecorder::take() {
  trace_.tail = std::exchange(segments_, {});
  return std::exchange(trace_, {});
}

}  // namespace pwlsim::steady
