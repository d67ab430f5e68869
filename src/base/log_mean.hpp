#pragma once
/// Geometric mean of positive numbers.

#include <cmath>

namespace pwlsim {

/// Ignores numbers that are not positive or not finite. 1 if none is left.
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
