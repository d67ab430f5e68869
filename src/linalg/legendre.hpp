#pragma once
/// Polynomials of degree 15 on [−1, 1] by their values at the sixteen Gauss–Legendre points, or as series Σ c_k P_k.
///
/// ∫ f = 2 c_0; the points and weights also give the integral of a product of two such polynomials exactly (degree 31). |f − c_0| ≤ Σ_{k≥1} |c_k|
/// shows intervals without a zero (Abramowitz & Stegun, chapters 22 and 25.4).

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace pwlsim::linalg {

inline constexpr std::size_t legendre_points = 16;
using LegendreValues = std::array<double, legendre_points>;

/// Ascending points and their weights (sum 2).
struct GaussLegendre {
  LegendreValues point{}, weight{};
};
[[nodiscard]] const GaussLegendre& gauss_legendre();

class LegendreSeries {
 public:
  LegendreSeries() = default;
  /// The polynomial with these values at the points.
  explicit LegendreSeries(const double* values);

  /// The first coefficients of a series; the others are zero.
  explicit LegendreSeries(std::span<const double> coefficients) { std::copy(coefficients.begin(), coefficients.end(), c_.begin()); }

  [[nodiscard]] double operator()(double x) const;
  [[nodiscard]] LegendreSeries derivative() const;
  /// The polynomial x ↦ f(lower + (x + 1)(upper − lower)/2).
  [[nodiscard]] LegendreSeries on(double lower, double upper) const;
  [[nodiscard]] double mean() const { return c_[0]; }
  [[nodiscard]] const LegendreValues& coefficients() const { return c_; }
  /// Bound of |f − mean|.
  [[nodiscard]] double variation() const;
  /// Size of the last three coefficients: rounding, if the points resolve the function.
  [[nodiscard]] double tail() const;

 private:
  LegendreValues c_{};
};

/// Points of [−1, 1] at which f changes sign, ascending; parts of size below `noise` are ignored. Where f touches zero to rounding there may be a pair
/// of points, with only rounding between them.
[[nodiscard]] std::vector<double> sign_changes(const LegendreSeries& f, double noise);

/// The least and the largest value on [−1, 1] and where they are.
struct Extremes {
  double least = 0.0, least_at = 0.0, largest = 0.0, largest_at = 0.0;
};
[[nodiscard]] Extremes extremes(const LegendreSeries& f);

}  // namespace pwlsim::linalg
