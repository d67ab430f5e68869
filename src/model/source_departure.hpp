#pragma once
/// The side of a level on which a sum of sources is about to be: the sign of the first of row·ζ − level and its derivatives row·S^k ζ that is not rounding. A sum
/// that crosses the level within the time that counts as one instant, before or after, is on it.

#include <vector>

#include "model/exosystem.hpp"

namespace pwlsim::model {

class SourceDeparture {
 public:
  explicit SourceDeparture(const Exosystem& exosystem);

  /// Times closer than this are one instant.
  void set_tolerance(double tolerance) { tolerance_ = tolerance; }

  /// ζ (exosystem.size() entries) at `time` in that phase; false where it is what was taken last. (A corner is passed before the first question
  /// at its time, or shows in ζ.)
  [[nodiscard]] bool take(const Exosystem::Phase& phase, double time, const double* zeta);
  /// That value or derivative; 0 where all of them are rounding.
  [[nodiscard]] double of(const double* row, double level);

 private:
  bool extend();
  bool is_on_level(const double* row, double distance);

  const Exosystem& exosystem_;
  linalg::Matrix absolute_;                  ///< |S|
  std::vector<double> derivatives_, sizes_;  ///< S^k ζ in sequence, and the sums of the magnitudes of their terms
  std::size_t known_ = 0;
  double time_ = 0.0, tolerance_ = 0.0;
  double steepest_ = 0.0;       ///< bound of the states' first derivatives
  bool others_vanish_ = false;  ///< all derivatives beyond
};

}  // namespace pwlsim::model
