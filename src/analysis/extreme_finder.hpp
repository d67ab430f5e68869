#pragma once
/// All places at which a measured expression takes its least and its largest value in a window.

#include <vector>

#include "circuit/measurement.hpp"
#include "measure/measuring.hpp"
#include "measure/piece_view.hpp"

namespace pwlsim::analysis {

/// Relative to the run: a place this near to an instant is at it.
inline constexpr double same_place = 1e-11;
/// Relative to the values on both sides of an instant: they are equal.
inline constexpr double same_value = 1e-12;

[[nodiscard]] bool is_extreme(circuit::Measurement::Kind kind);

/// The times of the least and the largest value of a measurement, s, in order; more than one for ties.
struct ExtremePlaces {
  std::vector<double> least, largest;
  double size = 0.0;  ///< largest magnitude of the expression in the window
};

class ExtremeFinder {
 public:
  /// `measurement` must outlive it.
  ExtremeFinder(const circuit::Measurement& measurement, const measure::Place& place);

  /// Pieces of the run in order.
  void take(measure::PieceView& view, const std::vector<double>& results);
  [[nodiscard]] ExtremePlaces found() const;

 private:
  /// The values that tie so far.
  struct Best {
    double sign = 1.0;                              ///< −1: the least
    std::vector<std::pair<double, double>> places;  ///< (time, sign·value)
    double best = 0.0;
  };
  void add(Best& best, double time, double value) const;
  void take(const measure::PolynomialPart& part);

  measure::Program program_;
  double from_, to_;
  double size_ = 0.0;
  Best least_{-1.0, {}, 0.0}, largest_{1.0, {}, 0.0};
};

}  // namespace pwlsim::analysis
