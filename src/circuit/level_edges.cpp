#include "circuit/level_edges.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pwlsim::circuit {
namespace {

/// From one level to the other; a jump takes no time.
struct LevelEdge {
  double begin = 0.0, duration = 0.0;
};

/// Times in a deck are decimal: equal durations may differ by their rounding.
constexpr double duration_rounding = 1e-9;
constexpr std::size_t edges_of_one_pulse = 2;

/// `edges` in order; what is looked at begins at `begin` and ends at `end`.
bool are_short(const std::vector<LevelEdge>& edges, double begin, double end) {
  double on_edges = 0.0;
  std::size_t seen = 0;
  for (std::size_t k = 0; k < edges.size() && edges[k].begin < end; ++k) {
    const LevelEdge& edge = edges[k];
    ++seen;
    on_edges += std::min(edge.duration, end - edge.begin);
    if (k == 0) continue;
    const LevelEdge& before = edges[k - 1];
    const double level = edge.begin - (before.begin + before.duration);
    if (level < std::max(edge.duration, before.duration) * (1.0 - duration_rounding)) return false;
  }
  const double share = seen > edges_of_one_pulse ? longest_share_of_edges : longest_share_of_a_step;
  return on_edges <= share * (end - begin) * (1.0 + duration_rounding);
}

}  // namespace

bool has_short_edges(const model::Pulse& pulse, double stop) {
  if (pulse.initial == pulse.pulsed || (pulse.rise == 0.0 && pulse.fall == 0.0)) return true;
  const bool repeats = std::isfinite(pulse.period) && pulse.cycles > 1.0;
  // Two periods show all levels.
  const int periods = repeats ? 2 : 1;
  std::vector<LevelEdge> edges;
  for (int n = 0; n < periods; ++n) {
    const double begin = pulse.delay + n * (repeats ? pulse.period : 0.0);
    edges.push_back({begin, pulse.rise});
    if (!std::isfinite(pulse.width)) break;
    edges.push_back({begin + pulse.rise + pulse.width, pulse.fall});
  }
  const double shown = repeats && std::isfinite(pulse.width) ? pulse.delay + periods * pulse.period : stop;
  return are_short(edges, shown <= stop ? pulse.delay : 0.0, std::min(shown, stop));
}

bool has_short_edges(const model::Pwl& pwl, double stop) {
  std::vector<LevelEdge> edges;
  const auto take = [&](double shift, double from) {
    for (std::size_t k = 1; k < pwl.points.size(); ++k) {
      const auto &a = pwl.points[k - 1], &b = pwl.points[k];
      if (a.value != b.value && a.time >= from) edges.push_back({a.time + shift, b.time - a.time});
    }
  };
  take(0.0, -model::forever);
  const double last = pwl.points.empty() ? 0.0 : pwl.points.back().time, part = last - pwl.repeat_from;
  const bool repeats = pwl.repeats > 0.0 && part > 0.0;
  if (repeats) take(part, pwl.repeat_from);
  if (std::all_of(edges.begin(), edges.end(), [](const LevelEdge& edge) { return edge.duration == 0.0; })) return true;
  return are_short(edges, 0.0, repeats ? std::min(last + part, stop) : stop);
}

}  // namespace pwlsim::circuit
