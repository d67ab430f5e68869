#include "regression/twisting.hpp"

#include <cmath>

namespace pwlsim::test {

Place twisted(double time) {
  double speed = 1.0, side = 1.0, start = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double out = speed / 3.0, top = speed * speed / 6.0, back = std::sqrt(2.0 * top);
    double t = time - start;
    if (t <= out) return {side * (speed * t - 1.5 * t * t), side * (speed - 3.0 * t)};
    t -= out;
    if (t <= back) return {side * (top - 0.5 * t * t), -side * t};
    start += out + back;
    speed = back;
    side = -side;
  }
  return {};
}

}  // namespace pwlsim::test
