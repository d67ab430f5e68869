#include "steady/orbit_trace.hpp"
#include "steady/tolerances.hpp"

#include <algorithm>
#include <utility>

namespace pwlsim::steady {

std::size_t Trace::segments() const {
  std::size_t count = tail.size();
  for (const TraceStep& step : steps) count += step.segments.size();
  return count;
}

void end_at(Trace& trace, double end) {
  auto& steps = trace.steps;
  const auto behind =
      std::find_if(steps.begin(), steps.end(), [&](const TraceStep& step) { return step.time > end * (1.0 + tolerance::same_instant); });
  if (behind == steps.end()) return;
  trace.tail = std::move(behind->segments);
  steps.erase(behind, steps.end());
}

std::vector<std::vector<double>> signals_at_end(const engine::ExactModel& model, const Trace& trace, double period) {
  std::vector<std::vector<double>> signals;
  for (std::size_t island = 0; island < model.islands.size(); ++island) {
    const model::System& system = model.islands[island].extraction.system;
    const model::Mode* mode = nullptr;
    std::vector<double> y;
    const auto take = [&](const std::vector<TraceSegment>& segments) {
      for (const TraceSegment& segment : segments)
        if (segment.island == island && segment.begin + segment.length >= period * (1.0 - tolerance::near_end)) {
          mode = segment.mode;
          y = segment.y1;
        }
    };
    if (!trace.steps.empty()) take(trace.steps.back().segments);  // of a self-timed period, which ends with an instant
    take(trace.tail);
    if (system.is_static() && !trace.steps.empty())
      for (const engine::Change& change : trace.steps.front().changes)
        if (change.island == island && change.after != nullptr) {
          mode = change.after;
          y.assign(static_cast<std::size_t>(mode->ny), 0.0);
          system.exosystem->evaluate(system.exosystem->start(period), period, y.data());
        }
    if (mode == nullptr) return {};
    std::vector<double>& own = signals.emplace_back(system.outputs.size());
    for (std::size_t row = 0; row < own.size(); ++row)
      own[row] = mode->outputs.row(static_cast<Eigen::Index>(row)).dot(Eigen::Map<const linalg::Vector>(y.data(), mode->ny));
  }
  return signals;
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
