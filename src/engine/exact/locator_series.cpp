/// Event location by Taylor models: over an interval a guard is a polynomial of fixed degree plus a remainder that is bounded for the
/// whole interval; the polynomial's Bernstein coefficients enclose it, and subdividing it costs no evaluation of the state
/// (Farouki & Rajan, Computer Aided Geometric Design 4 (1987) 191–216, for the basis and its subdivision).

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/exact/locator.hpp"
#include "engine/exact/tolerances.hpp"
#include "linalg/small.hpp"

namespace pwlsim::engine {

namespace {

using model::Mode;

constexpr int degree = 10;
constexpr double exact_reach = 0.14;     ///< rate·step up to which the series of this degree is exact to rounding
constexpr double longest_reach = 12.0;   ///< rate·h beyond which the remainder never passes
constexpr double shorter = 0.7;          ///< of an interval that could not be decided
constexpr double longer = 1.15;          ///< of the reach, after an interval decided at once
constexpr int most_shortenings = 16;     ///< before the tests of low order take over
constexpr double beyond_end = 1.25;      ///< of what is left: tried where a guard seems to be zero at the very end
constexpr double bracket_margin = 0.02;  ///< of the interval, behind an isolated root
constexpr int most_depth = 6;            ///< of subdivision

using Coefficients = std::array<double, degree + 1>;

constexpr std::array<double, degree + 2> inverse_factorial = [] {
  std::array<double, degree + 2> table{};
  double factorial = 1.0;
  for (std::size_t j = 0; j < table.size(); ++j) {
    if (j > 0) factorial *= static_cast<double>(j);
    table[j] = 1.0 / factorial;
  }
  return table;
}();

constexpr double binomial(int n, int k) {
  double value = 1.0;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

/// b_k = Σ_{j≤k} C(k,j)/C(n,j) c_j; column j of the table holds the factors of c_j.
constexpr std::array<Coefficients, degree + 1> to_bernstein = [] {
  std::array<Coefficients, degree + 1> table{};
  for (int k = 0; k <= degree; ++k)
    for (int j = 0; j <= k; ++j) table[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)] = binomial(k, j) / binomial(degree, j);
  return table;
}();

Coefficients bernstein(const Coefficients& c) {
  Coefficients b{};
  for (std::size_t j = 0; j < b.size(); ++j)
    for (std::size_t k = 0; k < b.size(); ++k) b[k] += to_bernstein[j][k] * c[j];
  return b;
}

/// De Casteljau's triangle at one half, its rows of a length that the compiler knows.
template <std::size_t length>
void halve(Coefficients& work, Coefficients& left, Coefficients& right) {
  left[degree + 1 - length] = work[0];
  right[length - 1] = work[length - 1];
  if constexpr (length > 1) {
    for (std::size_t k = 0; k + 1 < length; ++k) work[k] = 0.5 * (work[k] + work[k + 1]);
    halve<length - 1>(work, left, right);
  }
}

void split(const Coefficients& b, Coefficients& left, Coefficients& right) {
  Coefficients work = b;
  halve<degree + 1>(work, left, right);
}

/// Bounds of c over the unit interval, by Horner's scheme: s·q(s) lies between min(0, min q) and max(0, max q).
double lower_bound(const Coefficients& c) {
  double bound = c[degree];
  for (std::size_t k = degree; k-- > 0;) bound = c[k] + std::min(0.0, bound);
  return bound;
}

double upper_bound(const Coefficients& c) {
  double bound = c[degree];
  for (std::size_t k = degree; k-- > 0;) bound = c[k] + std::max(0.0, bound);
  return bound;
}

Coefficients derivative(const Coefficients& c) {
  Coefficients d{};
  for (std::size_t k = 0; k < degree; ++k) d[k] = static_cast<double>(k + 1) * c[k + 1];
  return d;
}

enum class Shape { positive, one_root, unclear };
struct SeriesPiece {
  Shape shape = Shape::unclear;
  double low = 0.0, high = 1.0;
};

double value_at(const Coefficients& c, double place) {
  double value = 0.0;
  for (std::size_t k = c.size(); k-- > 0;) value = value * place + c[k];
  return value;
}

/// What bounds over the whole interval tell, without subdividing it.
SeriesPiece at_a_glance(const Coefficients& c, double rest, double rest_slope) {
  if (!(c[0] > rest)) return {};
  const Coefficients slope = derivative(c);
  if (lower_bound(slope) > rest_slope) return {Shape::positive};
  if (upper_bound(slope) < -rest_slope) {
    const double end = value_at(c, 1.0);
    if (end < -rest) return {Shape::one_root};
    if (end > rest) return {Shape::positive};
  }
  return {};
}

/// Walks from left to right; positive everywhere, or the first place where it is not. `rest` bounds the remainder, `rest_slope` its
/// derivative over the whole unit interval.
SeriesPiece walk(const Coefficients& b, double rest, double rest_slope, double low, double high, int depth) {
  // Every verdict needs a value above the remainder at the left end, which subdividing does not move.
  if (!(b[0] > rest)) return {Shape::unclear, low, high};
  double least = b[0], steepest = INFINITY, flattest = -INFINITY;
  for (std::size_t k = 1; k < b.size(); ++k) {
    least = std::min(least, b[k]);
    steepest = std::min(steepest, b[k] - b[k - 1]);
    flattest = std::max(flattest, b[k] - b[k - 1]);
  }
  if (least > rest) return {Shape::positive, low, high};
  const double slope = rest_slope * (high - low) / degree;
  if (flattest < -slope && b[degree] < -rest) return {Shape::one_root, low, high};
  if (steepest > slope) return {Shape::positive, low, high};
  // Down into the remainder and no farther: no subdivision tells more.
  if (flattest <= 0.0 && std::abs(b[degree]) <= rest) return {Shape::unclear, low, high};
  if (depth == most_depth) return {Shape::unclear, low, high};
  Coefficients left{}, right{};
  split(b, left, right);
  const double middle = 0.5 * (low + high);
  const SeriesPiece first = walk(left, rest, rest_slope, low, middle, depth + 1);
  if (first.shape != Shape::positive) return first;
  return walk(right, rest, rest_slope, middle, high, depth + 1);
}

/// h^j/j!, which turn derivatives at the start into the coefficients of a polynomial on the unit interval; the last one belongs to the
/// remainder.
using Powers = std::array<double, degree + 2>;

Powers powers_of(double h) {
  Powers powers{};
  double power = 1.0;
  for (std::size_t j = 0; j < powers.size(); ++j) {
    powers[j] = power * inverse_factorial[j];
    power *= h;
  }
  return powers;
}

/// Root of the polynomial between two places, positive at the first and negative at the second: Newton kept inside its bracket, from the
/// root of the parabola.
double polynomial_root(const Coefficients& c, double low, double high) {
  const double discriminant = c[1] * c[1] - 4.0 * c[2] * c[0];
  double at = discriminant >= 0.0 ? 2.0 * c[0] / (-c[1] + std::sqrt(discriminant)) : low;
  if (!(at > low && at < high)) at = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    double value = 0.0, slope = 0.0;
    for (std::size_t k = c.size(); k-- > 0;) {
      slope = slope * at + value;
      value = value * at + c[k];
    }
    if (value == 0.0) return at;
    (value > 0.0 ? low : high) = at;
    double next = slope < 0.0 ? at - value / slope : 0.5 * (low + high);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - at) <= tolerance::series_root_step * std::abs(at)) return next;
    at = next;
  }
  return at;
}

}  // namespace

/// The derivatives beyond the second.
void Locator::differentiate(const Segment& s) {
  static_assert(degree == series_order);
  const Mode& m = *s.mode;
  const auto ny = static_cast<std::size_t>(m.ny);
  linalg::multiply_repeatedly(m.flow.a(), degree - 1, &derivatives_[2 * ny]);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    double* g = &guard_derivatives_[i * (degree + 1)];
    g[0] = g_[i];
    g[1] = gd_[i];
    g[2] = g2_[i];
    for (std::size_t j = 3; j <= degree; ++j) g[j] = linalg::row_times(m.guards, s.rows[i], &derivatives_[j * ny]);
  }
}

/// State at `step` from the derivatives at hand where they suffice.
void Locator::series_state(const Segment& s, double step, double* out) {
  if (s.mode->flow.rate() * step > exact_reach) return state_at(s, step, out);
  const auto ny = static_cast<std::size_t>(s.mode->ny);
  const bool is_small = linalg::with_length(s.mode->ny, [&]<int length>(linalg::Length<length>) {
    linalg::Small<length> sum{};
    for (int j = degree; j >= 0; --j) {
      sum.scale(step / (j + 1));
      sum.add(linalg::Small<length>::load(&derivatives_[static_cast<std::size_t>(j * length)]));
    }
    sum.store(out);
  });
  if (is_small) return;
  std::fill(out, out + ny, 0.0);
  for (std::size_t j = degree + 1; j-- > 0;) {
    const double* d = &derivatives_[j * ny];
    const double factor = step / static_cast<double>(j + 1);
    for (std::size_t i = 0; i < ny; ++i) out[i] = d[i] + factor * out[i];
  }
}

/// A guard at rest stays there, falls below its noise, or rises so far that it could fall again unseen. The state itself decides: in the series its
/// rounding is multiplied by powers of rate·h.
Locator::Isolated Locator::leave_rest(const Segment& s, std::size_t i, double h) {
  state_at(s, h, at_.data());
  const double noise = noise_at_rest(s, i);
  const double end = linalg::row_times(s.mode->guards, s.rows[i], at_.data());
  if (end < -noise) return {Verdict::one_root, 0.0, h, find_root(s, i, 0.0, h, 0.5 * h, noise), noise};
  return {end <= leaving_zero * noise ? Verdict::excluded : Verdict::undecided};
}

Locator::Isolated Locator::isolate_root(const Segment& s, std::size_t i, double h, const double* powers, double next_derivative) {
  if (is_at_rest(s, i)) return leave_rest(s, i, h);
  Coefficients c{};
  const double* g = &guard_derivatives_[i * (degree + 1)];
  for (std::size_t j = 0; j <= degree; ++j) c[j] = g[j] * powers[j];
  double rest = next_derivative * powers[degree + 1];
  double rest_slope = (degree + 1) * rest;
  const int start = s.tau == 0.0 ? s.departures[i].order : 0;
  if (start > degree - 4) return {Verdict::undecided, 0.0, 0.0, 0.0};
  if (start > 0) {
    // Zero at the start up to this degree: g/s^start has the same sign and roots on (0, 1].
    std::copy(c.begin() + start, c.end(), c.begin());
    std::fill(c.end() - start, c.end(), 0.0);
    rest_slope = (degree + 1 + start) * rest;
  }
  if (lower_bound(c) > rest) return {Verdict::excluded, 0.0, 0.0, 0.0};
  // What a value of this guard is worth, against which its own rounding counts.
  const double noise = noise_of(s, s.rows[i]);
  if (start == 0 && std::abs(c[0]) <= noise && lower_bound(c) - rest >= -noise) return {Verdict::excluded, 0.0, 0.0, 0.0};
  rest += noise * (start > 0 ? 0.0 : 0.1);
  SeriesPiece piece = at_a_glance(c, rest, rest_slope);
  if (piece.shape == Shape::unclear) piece = walk(bernstein(c), rest, rest_slope, 0.0, 1.0, 0);
  if (piece.shape == Shape::positive) return {Verdict::excluded, 0.0, 0.0, 0.0};
  if (piece.shape == Shape::unclear) return {Verdict::undecided, 0.0, 0.0, 0.0};
  const double root = polynomial_root(c, piece.low, piece.high);
  const double behind = root + bracket_margin;
  if (behind < piece.high && value_at(c, behind) < -rest) piece.high = behind;
  return {Verdict::one_root, piece.low * h, piece.high * h, root * h};
}

/// The first root of any guard in an interval of length h.
Locator::FirstRoot Locator::first_root(const Segment& s, double h) {
  FirstRoot first;
  const double* last = &derivatives_[(degree + 1) * static_cast<std::size_t>(s.mode->ny)];
  Bound bound = bound_of(s, degree + 1, last, h);
  double length = h;  // behind the first root so far nothing matters
  Powers powers = powers_of(length);
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const Isolated found = isolate_root(s, i, length, powers.data(), bound_at(s, bound, s.rows[i]));
    if (found.verdict == Verdict::undecided) return {false, false, 0, {}};
    if (found.verdict != Verdict::one_root || (first.is_found && found.guess >= first.root.guess)) continue;
    first = {true, true, i, found};
    length = found.upper;
    powers = powers_of(length);
  }
  return first;
}

/// Within the series' exact reach the polynomial's root is the root; elsewhere it starts a Newton iteration on the state.
void Locator::end_at_root(Segment& s, const FirstRoot& first, double end, Located& located) {
  const Isolated& root = first.root;
  double at = root.guess;
  if (root.below == 0.0 && s.mode->flow.rate() * at <= exact_reach) {
    series_state(s, at, event_.data());
  } else {
    at = go_to_root(s, first.row, root.lower, root.upper, root.guess, root.below);
  }
  double tau = s.tau + at;
  if (root.below == 0.0) polish(s, s.rows[first.row], tau);
  end_at_event(s, first.row, tau, end, located);
}

/// One interval; false when the series cannot decide even a short one.
bool Locator::march_by_series(Segment& s, double end, Located& located) {
  const double rest = end - s.tau;
  const double rate = s.mode->flow.rate();
  const double longest = rate > 0.0 ? s.mode->reach / rate : INFINITY;
  double h = std::min(rest, longest);
  differentiate(s);
  for (int attempt = 0; attempt <= most_shortenings; ++attempt) {
    if (attempt > 0) h = attempt == 1 && h == rest && beyond_end * rest <= longest ? beyond_end * rest : std::min(h, rest) * shorter;
    ++intervals_;
    const FirstRoot first = first_root(s, h);
    if (!first.is_clear) continue;
    // The next interval of this mode begins with what served here, and a little more where it served at once.
    if (attempt > 0)
      s.mode->reach = rate * h;
    else if (h < rest)
      s.mode->reach = std::min(longer * s.mode->reach, longest_reach);
    if (first.is_found) {
      end_at_root(s, first, end, located);
    } else {
      series_state(s, h, ye_.data());
      accept(s, h, end);
    }
    return true;
  }
  return false;
}

}  // namespace pwlsim::engine
