#pragma once
/// Small computations with numbers.

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

/// a + b = sum + result, exactly, where `sum` is a + b rounded (D. E. Knuth, The Art of Computer Programming 2, §4.2.2, theorem B).
[[nodiscard]] inline double rounding_of_sum(double a, double b) {
  const double sum = a + b;
  const double share = sum - a;
  return (a - (sum - share)) + (b - share);
}

/// Geometric mean of the numbers that are positive and finite; 1 without any.
class LogMean {
 public:
  void add(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return;
    sum_ += std::log(value);
    ++count_;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] double value() const { return count_ == 0 ? 1.0 : std::exp(sum_ / count_); }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

}  // namespace pwlsim
