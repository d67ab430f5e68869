#pragma once
/// A zero of a function by its values alone.

#include <cmath>

namespace pwlsim {

/// Between `a` and `b`, where f has different signs, by the Illinois method (Dowell and Jarratt, BIT 11 (1971)): false position that halves the value at an end that is kept. Ends when f is
/// 0, when the place changes by less than `rounding` of itself, or after `most` steps. Returns the last place at which f was evaluated.
template <class F>
double zero_between(double a, double b, double rounding, int most, F&& f) {
  double fa = f(a), fb = f(b);
  double at = b;
  for (int k = 0; k < most && fa != fb; ++k) {
    const double next = (a * fb - b * fa) / (fb - fa);
    if (std::abs(next - at) <= rounding * std::abs(next)) break;
    at = next;
    const double value = f(at);
    if (value == 0.0) break;
    if ((value > 0.0) != (fb > 0.0)) {
      a = b;
      fa = fb;
    } else {
      fa *= 0.5;
    }
    b = at;
    fb = value;
  }
  return at;
}

}  // namespace pwlsim
