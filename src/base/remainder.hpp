#pragma once
/// How far a sequence of refinements is from its limit.

#include <vector>

namespace pwlsim {

/// Richardson's estimate of the remaining error after these changes, each the largest from one level to the next, where each level divides
/// the cause of the error by a constant. With r the ratio of the last two changes, at most 4, it is the last one over r − 1. If r is below 1.5 the levels are not a geometric
/// sequence yet: the estimate is then twice the larger of the two. Without a change it is infinite.
struct Remainder {
  double size = 0.0;
  bool geometric = false;
};
[[nodiscard]] Remainder remainder_after(const std::vector<double>& changes);

}  // namespace pwlsim
