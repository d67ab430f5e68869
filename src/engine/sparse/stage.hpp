#pragma once
/// One implicit stage to solve, and what the signs of its port quantities are judged against.

#include <vector>

namespace pwlsim::engine::sparse {

/// Largest port quantities of the run so far, in volts: what signs are judged against.
struct PortScale {
  double input = 0.0, slack = 0.0;
};

/// A stage to solve. `right`: r, its closing rows without meaning.
struct Stage {
  double shift;
  const std::vector<double>& from;  ///< z0
  const std::vector<double>& right;
  const std::vector<double>& w;
};

}  // namespace pwlsim::engine::sparse
