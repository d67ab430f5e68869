#include "steady/functional.hpp"

namespace pwlsim::steady {

void Functional::add(double weight, const Functional& other) {
  if (weight == 0.0) return;
  const auto scaled = [&](std::vector<double> list) {
    for (double& each : list) each *= weight;
    return list;
  };
  for (const Point& point : other.points) points.push_back({point.time, point.side, scaled(point.moved), scaled(point.rates)});
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
