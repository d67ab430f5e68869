#pragma once
/// Guards that an orbit touches without crossing: there its multipliers are those of one side only.

#include <vector>

#include "steady/orbit_trace.hpp"

namespace pwlsim::steady {

struct Touch {
  std::size_t island = 0;
  int guard = 0;      ///< row of the mode's guards
  double time = 0.0;  ///< s
};

/// Guards whose least value inside a segment is zero to 1e-9 of their largest there; each guard once.
[[nodiscard]] std::vector<Touch> touches(const Trace& trace);

}  // namespace pwlsim::steady
