#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "steady/tolerances.hpp"

namespace pwlsim::steady {

/// Whether Newton's method goes round: on a map of pieces, steps of one piece may lead to another whose step leads back, and pass any test of a single step.
class NewtonCycle {
 public:
  /// From now on nothing before counts.
  void restart() { norms_.clear(); }
  /// Of a step that would be taken: whether it begins with the residual of one before, by its norm. (Periods of a drift have the same one, and are no steps.)
  [[nodiscard]] bool closes(double norm) {
    const bool is_known = std::any_of(norms_.begin(), norms_.end(),
                                      [&](double before) { return std::abs(norm - before) <= tolerance::same_residual * norm; });
    norms_.push_back(norm);
    return is_known;
  }

 private:
  std::vector<double> norms_;
};

}  // namespace pwlsim::steady
