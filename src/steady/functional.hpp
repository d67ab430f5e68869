#pragma once
/// The functional by which a measurement's derivative depends on a run's derivative: a weighted sum of its values at times, in intervals, and of the shifts of instants.

#include <cstddef>
#include <map>
#include <vector>

namespace pwlsim::steady {

/// Which side of an instant.
enum class Side { left, right };

struct Functional {
  /// Signals at one time, their derivatives to the parameter and those derivatives' rates.
  struct Point {
    double time = 0.0;
    Side side = Side::right;
    std::vector<double> moved, rates;  ///< weights, of each signal; may be empty
  };
  /// Signals at the points of Gauss and Legendre on [begin, begin + length], in the motion of the segment that `inside` lies in.
  struct Interval {
    double inside = 0.0, begin = 0.0, length = 0.0;
    std::vector<double> weights;  ///< point by point, of each signal
  };
  /// ∫ over [begin, end] of signals with weights that do not change.
  struct Stretch {
    double begin = 0.0, end = 0.0;
    std::vector<double> weights;  ///< of each signal
  };
  std::vector<Point> points;
  std::vector<Stretch> stretches;
  std::map<std::size_t, Interval> intervals;  ///< by number of the piece
  std::map<std::size_t, double> shifts;       ///< weights of dt/dp of instants

  /// += weight·other.
  void add(double weight, const Functional& other);
  [[nodiscard]] bool is_empty() const { return points.empty() && stretches.empty() && intervals.empty() && shifts.empty(); }
};

}  // namespace pwlsim::steady
