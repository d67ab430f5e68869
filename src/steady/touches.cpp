#include "steady/touches.hpp"
#include "steady/tolerances.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace pwlsim::steady {
namespace {

constexpr int points = 32;      ///< of a segment, between which a least value is looked for
constexpr int most_steps = 60;  ///< of the golden section
constexpr double golden = 0.6180339887498949;

class Guards {
 public:
  explicit Guards(const TraceSegment& segment) : segment_(segment), work_(2 * segment.y0.size()) {}

  [[nodiscard]] double at(int row, double tau) {
    y_ = segment_.y0;
    segment_.mode->flow.apply_once(tau, y_.data(), work_.data());
    return linalg::row_times(segment_.mode->guards, row, y_.data());
  }
  /// The place of the least value between two times.
  [[nodiscard]] double lowest(int row, double from, double to) {
    for (int step = 0; step < most_steps && to - from > 0.0; ++step) {
      const double left = to - golden * (to - from), right = from + golden * (to - from);
      if (left >= right) break;
      (at(row, left) < at(row, right) ? to : from) = at(row, left) < at(row, right) ? right : left;
    }
    return 0.5 * (from + to);
  }

 private:
  const TraceSegment& segment_;
  std::vector<double> y_, work_;
};

void look(const TraceSegment& segment, std::set<std::pair<std::size_t, int>>& seen, std::vector<Touch>& found) {
  const model::Mode& mode = *segment.mode;
  if (mode.n1 == 0 || !(segment.length > 0.0)) return;
  Guards guards(segment);
  const double step = segment.length / points;
  for (int row = 0; row < mode.guards.rows(); ++row) {
    if (mode.guard_constant[static_cast<std::size_t>(row)] != 0 || mode.guard_norm[row] == 0.0 || seen.count({segment.island, row}) != 0)
      continue;
    std::vector<double> values;
    for (int k = 0; k <= points; ++k) values.push_back(guards.at(row, k * step));
    const double largest = *std::max_element(values.begin(), values.end());
    for (int k = 1; k < points; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (values[i] > values[i - 1] || values[i] > values[i + 1] || !(largest > 0.0) || values[i - 1] <= tolerance::touch * largest ||
          values[i + 1] <= tolerance::touch * largest)
        continue;
      const double tau = guards.lowest(row, (k - 1) * step, (k + 1) * step);
      if (std::abs(guards.at(row, tau)) > tolerance::touch * largest) continue;
      found.push_back({segment.island, row, segment.begin + tau});
      seen.insert({segment.island, row});
      break;
    }
  }
}

}  // namespace

std::vector<Touch> touches(const Trace& trace) {
  std::vector<Touch> found;
  std::set<std::pair<std::size_t, int>> seen;
  for (const TraceStep& step : trace.steps)
    for (const TraceSegment& segment : step.segments) look(segment, seen, found);
  for (const TraceSegment& segment : trace.tail) look(segment, seen, found);
  return found;
}

}  // namespace pwlsim::steady
