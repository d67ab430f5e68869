#include "steady/functional.hpp"

#include <algorithm>

namespace pwlsim::steady {

void Functional::add(double weight, const Functional& other) {
  if (weight == 0.0) return;
  const auto scaled = [&](std::vector<double> list) {
    for (double& each : list) each *= weight;
    return list;
  };
  for (const Point& point : other.points) points.push_back({point.time, point.side, scaled(point.moved), scaled(point.rates)});
  for (const Stretch& stretch : other.stretches) {
    const auto same = [&](const Stretch& own) { return own.begin == stretch.begin && own.end == stretch.end; };
    const auto own = std::find_if(stretches.begin(), stretches.end(), same);
    if (own == stretches.end())
      stretches.push_back({stretch.begin, stretch.end, scaled(stretch.weights)});
    else
      for (std::size_t k = 0; k < own->weights.size(); ++k) own->weights[k] += weight * stretch.weights[k];
  }
  for (const auto& [number, interval] : other.intervals) {
    Interval& own = intervals[number];
    if (own.weights.empty()) {
      own = interval;
      own.weights = scaled(interval.weights);
      continue;
    }
    for (std::size_t k = 0; k < own.weights.size(); ++k) own.weights[k] += weight * interval.weights[k];
  }
  for (const auto& [number, shift] : other.shifts) shifts[number] += weight * shift;
}

}  // namespace pwlsim::steady
