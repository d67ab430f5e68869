#pragma once
/// The rounding error of a sum in double.

namespace pwlsim {

/// a + b = sum + result, exactly, where `sum` is a + b rounded (D. E. Knuth, The Art of Computer Programming 2, §4.2.2, theorem B).
[[nodiscard]] inline double rounding_of_sum(double a, double b) {
  const double sum = a + b;
  const double share = sum - a;
  return (a - (sum - share)) + (b - share);
}

}  // namespace pwlsim
