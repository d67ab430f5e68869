#pragma once
/// Numbers with their derivatives to the parameters of `.sens`, by the rules of calculus.

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pwlsim::elements {

struct Varied {
  double value = 0.0;
  std::vector<double>
      gradient{};  ///< to each varied parameter; empty if none moves it. NaN: it has no derivative, or none that is followed

  Varied() = default;
  Varied(double number) : value(number) {}  // NOLINT(google-explicit-constructor): numbers that nothing moves
  Varied(double number, std::vector<double> derivatives) : value(number), gradient(std::move(derivatives)) {}

  [[nodiscard]] bool moves() const { return !gradient.empty(); }
  /// No number of the formula: neither its value nor a derivative.
  [[nodiscard]] bool is_nothing() const { return value == 0.0 && !moves(); }
  /// Derivative to a parameter.
  [[nodiscard]] double moved(std::size_t parameter) const { return parameter < gradient.size() ? gradient[parameter] : 0.0; }
  bool operator==(const Varied&) const = default;
};

/// f(x), where f(x.value) = value and f′(x.value) = slope.
[[nodiscard]] Varied applied(const Varied& x, double value, double slope);
/// f(x, y).
[[nodiscard]] Varied applied(const Varied& x, const Varied& y, double value, double slope_x, double slope_y);
/// x, with NaN for every derivative that the other has.
[[nodiscard]] Varied unfollowed(const Varied& x, const Varied& other);

[[nodiscard]] Varied operator+(const Varied& a, const Varied& b);
[[nodiscard]] Varied operator-(const Varied& a, const Varied& b);
[[nodiscard]] Varied operator*(const Varied& a, const Varied& b);
[[nodiscard]] Varied operator/(const Varied& a, const Varied& b);
[[nodiscard]] Varied operator-(const Varied& a);

}  // namespace pwlsim::elements
