#include "elements/varied.hpp"

#include <algorithm>
#include <limits>

namespace pwlsim::elements {
namespace {

/// Derivatives that cancel to less are zero but for the rounding of the arithmetic that made them.
constexpr double derivative_rounding = 8.0 * std::numeric_limits<double>::epsilon();

}  // namespace

Varied applied(const Varied& x, double value, double slope) { return applied(x, {}, value, slope, 0.0); }

Varied applied(const Varied& x, const Varied& y, double value, double slope_x, double slope_y) {
  if (!x.moves() && !y.moves()) return value;
  Varied result(value, std::vector<double>(std::max(x.gradient.size(), y.gradient.size()), 0.0));
  bool any = false;
  for (std::size_t k = 0; k < result.gradient.size(); ++k) {
    const double a = x.moved(k) != 0.0 ? slope_x * x.moved(k) : 0.0, b = y.moved(k) != 0.0 ? slope_y * y.moved(k) : 0.0, sum = a + b;
    if (std::abs(sum) <= derivative_rounding * (std::abs(a) + std::abs(b))) continue;
    result.gradient[k] = sum;
    any = true;
  }
  if (!any) result.gradient.clear();
  return result;
}

Varied unfollowed(const Varied& x, const Varied& other) {
  Varied result(x.value, std::vector<double>(std::max(x.gradient.size(), other.gradient.size()), 0.0));
  for (std::size_t k = 0; k < result.gradient.size(); ++k)
    result.gradient[k] = other.moved(k) != 0.0 ? std::numeric_limits<double>::quiet_NaN() : x.moved(k);
  return result;
}

Varied operator+(const Varied& a, const Varied& b) { return applied(a, b, a.value + b.value, 1.0, 1.0); }
Varied operator-(const Varied& a, const Varied& b) { return applied(a, b, a.value - b.value, 1.0, -1.0); }
Varied operator*(const Varied& a, const Varied& b) { return applied(a, b, a.value * b.value, b.value, a.value); }
Varied operator/(const Varied& a, const Varied& b) {
  const double ratio = a.value / b.value;
  return applied(a, b, ratio, 1.0 / b.value, -ratio / b.value);
}
Varied operator-(const Varied& a) { return applied(a, -a.value, -1.0); }

}  // namespace pwlsim::elements
