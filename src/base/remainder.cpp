#include "base/remainder.hpp"

#include <algorithm>
#include <limits>

namespace pwlsim {

Remainder remainder_after(const std::vector<double>& changes) {
  constexpr double least_ratio = 1.5, largest_ratio = 4.0;
  if (changes.empty()) return {std::numeric_limits<double>::infinity(), false};
  const double last = changes.back();
  if (changes.size() == 1) return {2.0 * last, false};
  const double before = changes[changes.size() - 2];
  if (before < least_ratio * last) return {2.0 * std::max(last, before), false};
  const double ratio = last == 0.0 ? largest_ratio : std::min(before / last, largest_ratio);
  return {last / (ratio - 1.0), true};
}

}  // namespace pwlsim
