#include "linalg/legendre.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "linalg/tolerances.hpp"

namespace pwlsim::linalg {
namespace {

constexpr std::size_t count = legendre_points;
/// Beyond so many halvings what has not been decided is a touch.
constexpr int deepest = 50;
/// Parts looked at in one search: 15 zeros, each halved to the deepest, take half as many.
constexpr int most_parts = 4 * static_cast<int>(count) * deepest;
/// Numbers below the normal ones have lost their digits: series of them have no signs.
constexpr double smallest_size = static_cast<double>(count) * std::numeric_limits<double>::min();
constexpr int most_iterations = 100;
/// Rounding of a derivative's coefficients against the sum of the series' own: sums of terms (2k + 1) c_j.
constexpr double derivative_rounding = 16.0 * count * tolerance::series_rounding;

/// P_0(x) … P_15(x), and P_16(x) as the answer.
template <typename Real>
Real polynomials(Real x, std::array<Real, count>& p) {
  p[0] = 1;
  p[1] = x;
  for (std::size_t k = 1; k + 1 < count; ++k) p[k + 1] = ((2 * k + 1) * x * p[k] - k * p[k - 1]) / (k + 1);
  return ((2 * count - 1) * x * p[count - 1] - (count - 1) * p[count - 2]) / count;
}

struct Tables {
  GaussLegendre rule;
  std::array<LegendreValues, count> to_series{};  ///< c_k = Σ_i to_series[k][i] f_i

  Tables() {
    using Wide = long double;
    std::array<Wide, count> p{};
    for (std::size_t i = 0; i < count; ++i) {
      Wide x = -std::cos(std::numbers::pi_v<Wide> * (i + 0.75L) / (count + 0.5L));
      Wide slope = 1;
      for (int iteration = 0; iteration < most_iterations; ++iteration) {
        const Wide value = polynomials(x, p);
        slope = count * (p[count - 1] - x * value) / (1 - x * x);
        const Wide step = value / slope;
        x -= step;
        if (std::abs(step) < tolerance::last_root_step) break;
      }
      slope = count * (p[count - 1] - x * polynomials(x, p)) / (1 - x * x);
      const Wide weight = 2 / ((1 - x * x) * slope * slope);
      rule.point[i] = static_cast<double>(x);
      rule.weight[i] = static_cast<double>(weight);
      for (std::size_t k = 0; k < count; ++k) to_series[k][i] = static_cast<double>((2 * k + 1) * weight * p[k] / 2);
    }
  }
};

const Tables& tables() {
  static const Tables instance;
  return instance;
}

/// The zero of f between a and b, at which f has different signs: Newton's steps inside the bracket, halves outside.
double zero_between(const LegendreSeries& f, const LegendreSeries& slope, double a, double b, bool rises) {
  double x = 0.5 * (a + b);
  for (int iteration = 0; iteration < most_iterations && b - a > tolerance::series_rounding; ++iteration) {
    const double value = f(x);
    if (value == 0.0) return x;
    ((value < 0.0) == rises ? a : b) = x;
    const double newton = x - value / slope(x);
    const double next = newton > a && newton < b ? newton : 0.5 * (a + b);
    if (std::abs(next - x) <= tolerance::series_rounding * std::abs(x)) return next;
    x = next;
  }
  return x;
}

class ZeroSearch {
 public:
  ZeroSearch(const LegendreSeries& f, double noise) : f_(f), slope_(f.derivative()), noise_(std::max(noise, smallest_size)) {}

  void search(const LegendreSeries& part, double lower, double upper, int depth) {
    const double mean = std::abs(part.mean());
    const double variation = part.variation();
    if (mean + variation <= noise_ || depth > deepest) return;
    if (mean > variation + noise_) {
      see(part.mean(), lower);
      last_ = upper;
      return;
    }
    if (!std::isfinite(mean + variation) || ++parts_ > most_parts) return;
    const LegendreSeries slope = part.derivative();
    if (std::abs(slope.mean()) > slope.variation()) {
      see(part(-1.0), lower);
      see(part(1.0), upper);
      return;
    }
    const double middle = 0.5 * (lower + upper);
    search(part.on(-1.0, 0.0), lower, middle, depth + 1);
    search(part.on(0.0, 1.0), middle, upper, depth + 1);
  }

  std::vector<double> zeros;

 private:
  /// Values from left to right. Between one and the next beyond the noise, of the other sign, there is a zero: a flat one (x³) may have a stretch of noise around it.
  void see(double value, double x) {
    if (std::abs(value) <= noise_) return;
    const bool is_positive = value > 0.0;
    if (has_sign_ && is_positive != is_positive_) zeros.push_back(zero_between(f_, slope_, last_, x, is_positive));
    has_sign_ = true;
    is_positive_ = is_positive;
    last_ = x;
  }

  const LegendreSeries& f_;
  const LegendreSeries slope_;
  double noise_;
  int parts_ = 0;
  bool has_sign_ = false, is_positive_ = false;
  double last_ = -1.0;  ///< where the sign was seen last
};

}  // namespace

const GaussLegendre& gauss_legendre() { return tables().rule; }

LegendreSeries::LegendreSeries(const double* values) {
  const auto& rows = tables().to_series;
  // By differences: what is constant stays so to the last place.
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 1; i < count; ++i) c_[k] += rows[k][i] * (values[i] - values[0]);
  c_[0] += values[0];
}

/// Clenshaw's recurrence.
double LegendreSeries::operator()(double x) const {
  double b1 = 0.0, b2 = 0.0;
  for (std::size_t k = count; k-- > 1;) {
    const auto order = static_cast<double>(k);
    const double b = c_[k] + (2.0 * order + 1.0) / (order + 1.0) * x * b1 - (order + 1.0) / (order + 2.0) * b2;
    b2 = b1;
    b1 = b;
  }
  return c_[0] + x * b1 - 0.5 * b2;
}

/// P'_{k+1} = P'_{k−1} + (2k + 1) P_k.
LegendreSeries LegendreSeries::derivative() const {
  LegendreSeries result;
  for (std::size_t k = count - 1; k-- > 0;) {
    const double above = k + 2 < count ? result.c_[k + 2] / (2.0 * static_cast<double>(k + 2) + 1.0) : 0.0;
    result.c_[k] = (2.0 * static_cast<double>(k) + 1.0) * (c_[k + 1] + above);
  }
  return result;
}

LegendreSeries LegendreSeries::on(double lower, double upper) const {
  LegendreValues values;
  const LegendreValues& point = tables().rule.point;
  for (std::size_t i = 0; i < count; ++i) values[i] = (*this)(lower + 0.5 * (point[i] + 1.0) * (upper - lower));
  return LegendreSeries(values.data());
}

double LegendreSeries::variation() const {
  double sum = 0.0;
  for (std::size_t k = 1; k < count; ++k) sum += std::abs(c_[k]);
  return sum;
}

double LegendreSeries::tail() const { return std::max({std::abs(c_[count - 1]), std::abs(c_[count - 2]), std::abs(c_[count - 3])}); }

std::vector<double> sign_changes(const LegendreSeries& f, double noise) {
  ZeroSearch search(f, noise);
  search.search(f, -1.0, 1.0, 0);
  return std::move(search.zeros);
}

Extremes extremes(const LegendreSeries& f) {
  // Stationary points, beyond the rounding of the derivative.
  std::vector<double> candidates = sign_changes(f.derivative(), derivative_rounding * (std::abs(f.mean()) + f.variation()));
  candidates.push_back(1.0);
  Extremes result{f(-1.0), -1.0, f(-1.0), -1.0};
  for (const double x : candidates) {
    const double value = f(x);
    if (value < result.least) result.least = value, result.least_at = x;
    if (value > result.largest) result.largest = value, result.largest_at = x;
  }
  return result;
}

}  // namespace pwlsim::linalg
