#pragma once
/// The largest magnitude among numbers.

#include <algorithm>
#include <cmath>
#include <span>

namespace pwlsim {

/// max |xᵢ|, or 0 without numbers.
[[nodiscard]] inline double largest(std::span<const double> values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

}  // namespace pwlsim
