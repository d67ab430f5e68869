#include "model/exact_modes.hpp"

#include <algorithm>
#include <optional>

namespace pwlsim::test {

namespace {

using Row = std::vector<Integer>;
using Table = std::vector<Row>;

Integer integer(double value) { return {static_cast<long long>(value)}; }
int sign(const Integer& value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

std::vector<int> members(unsigned bits, int k) {
  std::vector<int> set;
  for (int i = 0; i < k; ++i)
    if ((bits >> static_cast<unsigned>(i)) & 1U) set.push_back(i);
  return set;
}

/// Coefficients of t^0 … t^n times n!, t = s − s0, of the polynomial with these values at s0 … s0 + n.
Row polynomial(Row values) {
  const std::size_t n = values.size() - 1;
  for (std::size_t order = 1; order <= n; ++order)
    for (std::size_t i = n; i >= order; --i) values[i] -= values[i - 1];
  Row result(n + 1, 0), falling(n + 1, 0);
  falling[0] = 1;
  Integer weight = 1;  // n!/m!
  for (std::size_t m = 2; m <= n; ++m) weight *= m;
  for (std::size_t m = 0; m <= n; ++m) {
    for (std::size_t i = 0; i <= m; ++i) result[i] += values[m] * weight * falling[i];
    if (m == n) break;
    for (std::size_t i = m + 1; i > 0; --i) falling[i] = falling[i - 1] - Integer(m) * falling[i];
    falling[0] *= -Integer(m);
    weight /= Integer(m + 1);
  }
  return result;
}

int degree(const Row& p) {
  for (auto i = static_cast<int>(p.size()) - 1; i >= 0; --i)
    if (p[static_cast<std::size_t>(i)] != 0) return i;
  return -1;
}

const Integer& leading(const Row& p) { return p[static_cast<std::size_t>(degree(p))]; }

/// The coefficient of 1/t in p/q, times leading(q)^steps: steps ≥ degree(p) − degree(q) + 2.
Integer residue(Row p, const Row& q, int steps) {
  const int of_q = degree(q);
  Integer factor = 1;
  for (int i = 0; i < steps; ++i) factor *= leading(q);
  for (Integer& c : p) c *= factor;
  // Division of p·t by q down to the constant term.
  p.insert(p.begin(), 0);
  Integer quotient = 0;
  for (int at = static_cast<int>(p.size()) - 1; at >= of_q; --at) {
    quotient = p[static_cast<std::size_t>(at)] / leading(q);
    for (int i = 0; i <= of_q; ++i) p[static_cast<std::size_t>(at - of_q + i)] -= quotient * q[static_cast<std::size_t>(i)];
  }
  return quotient;
}

/// One mode: numerators of x̂, û, ŷ and their common denominator.
class ModeTransform {
 public:
  ModeTransform(const IntegerSystem& system, unsigned bits, const Row& x)
      : s_(system), n_(system.n()), k_(system.k()), j_(members(bits, k_)), x_(x) {
    // A determinant of degree ≤ n that has a zero in each of n + 1 disjoint intervals is zero everywhere.
    for (int trial = 0; trial <= n_ && !regular_; ++trial) regular_ = sample(2 + trial * (n_ + 1));
    if (!regular_) return;
    denominator_ = polynomial(at_[0]);
    for (std::size_t i = 1; i < at_.size(); ++i) numerators_.push_back(polynomial(at_[i]));
  }

  [[nodiscard]] bool regular() const { return regular_; }
  [[nodiscard]] const Row& x(int i) const { return numerators_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Row& u(int i) const { return numerators_[static_cast<std::size_t>(n_ + i)]; }
  [[nodiscard]] const Row& y(int i) const { return numerators_[static_cast<std::size_t>(n_ + k_ + i)]; }
  [[nodiscard]] const Row& denominator() const { return denominator_; }
  [[nodiscard]] int sign_of(const Row& p) const { return degree(p) < 0 ? 0 : sign(leading(p)) * sign(leading(denominator_)); }

 private:
  /// Values at start … start + n; false if the determinant is zero at one of them.
  bool sample(int start) {
    at_.assign(static_cast<std::size_t>(1 + n_ + 2 * k_), {});
    for (int s = start; s <= start + n_; ++s)
      if (!eliminate(s)) return false;
    return true;
  }

  /// Fraction-free elimination (Bareiss, Gauss–Jordan) of [[sI − A, −B_J], [C_J, D_JJ]] [x̂; û_J] = [x; 0].
  bool eliminate(int s) {
    const auto q = static_cast<int>(j_.size());
    const int size = n_ + q;
    Table t(static_cast<std::size_t>(size), Row(static_cast<std::size_t>(size) + 1, 0));
    const auto cell = [&](int r, int c) -> Integer& { return t[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)]; };
    for (int r = 0; r < n_; ++r) {
      for (int c = 0; c < n_; ++c) cell(r, c) = integer((r == c ? s : 0) - s_.a(r, c));
      for (int c = 0; c < q; ++c) cell(r, n_ + c) = integer(-s_.b(r, j_[static_cast<std::size_t>(c)]));
      cell(r, size) = x_[static_cast<std::size_t>(r)];
    }
    for (int r = 0; r < q; ++r) {
      const int port = j_[static_cast<std::size_t>(r)];
      for (int c = 0; c < n_; ++c) cell(n_ + r, c) = integer(s_.c(port, c));
      for (int c = 0; c < q; ++c) cell(n_ + r, n_ + c) = integer(s_.d(port, j_[static_cast<std::size_t>(c)]));
    }
    Integer previous = 1;
    int swaps = 1;
    for (int c = 0; c < size; ++c) {
      int pivot = c;
      while (pivot < size && cell(pivot, c) == 0) ++pivot;
      if (pivot == size) return false;
      if (pivot != c) {
        std::swap(t[static_cast<std::size_t>(pivot)], t[static_cast<std::size_t>(c)]);
        swaps = -swaps;
      }
      const Integer head = cell(c, c);
      for (int r = 0; r < size; ++r) {
        if (r == c) continue;
        const Integer factor = cell(r, c);
        for (int i = c + 1; i <= size; ++i) cell(r, i) = (head * cell(r, i) - factor * cell(c, i)) / previous;
        cell(r, c) = 0;
      }
      previous = head;
    }
    record(t, swaps, previous);
    return true;
  }

  void record(const Table& t, int swaps, const Integer& determinant) {
    Row value(static_cast<std::size_t>(n_ + 2 * k_), 0);
    const auto solution = [&](int i) { return Integer(swaps * t[static_cast<std::size_t>(i)].back()); };
    for (int i = 0; i < n_; ++i) value[static_cast<std::size_t>(i)] = solution(i);
    for (std::size_t i = 0; i < j_.size(); ++i) value[static_cast<std::size_t>(n_ + j_[i])] = solution(n_ + static_cast<int>(i));
    for (int i = 0; i < k_; ++i) {
      Integer& y = value[static_cast<std::size_t>(n_ + k_ + i)];
      for (int c = 0; c < n_; ++c) y += integer(s_.c(i, c)) * value[static_cast<std::size_t>(c)];
      for (int c = 0; c < k_; ++c) y += integer(s_.d(i, c)) * value[static_cast<std::size_t>(n_ + c)];
    }
    at_[0].push_back(swaps * determinant);
    for (std::size_t i = 0; i < value.size(); ++i) at_[i + 1].push_back(value[i]);
  }

  const IntegerSystem& s_;
  int n_, k_;
  std::vector<int> j_;
  const Row& x_;
  bool regular_ = false;
  Table at_;  ///< determinant, x̂, û, ŷ: values at the samples
  Row denominator_;
  Table numerators_;
};

std::optional<ExactSolution> solution_of(const IntegerSystem& system, const ModeTransform& mode, double scale) {
  ExactSolution solution;
  const int of_denominator = degree(mode.denominator());
  for (int i = 0; i < system.k(); ++i) {
    const int u = mode.sign_of(mode.u(i));
    const int y = mode.sign_of(mode.y(i));
    if (u < 0 || y < 0) return std::nullopt;
    if (u > 0) solution.active |= 1U << static_cast<unsigned>(i);
    if (y > 0) solution.inactive |= 1U << static_cast<unsigned>(i);
    solution.jumps |= degree(mode.u(i)) >= of_denominator;
  }
  int steps = 1;
  for (int i = 0; i < system.n(); ++i) steps = std::max(steps, degree(mode.x(i)) - of_denominator + 2);
  if (steps % 2 != 0) ++steps;  // so that the factor is positive
  Integer factor = 1;
  for (int i = 0; i < steps; ++i) factor *= leading(mode.denominator());
  solution.state_after.resize(system.n());
  Integer common = factor;
  for (int i = 0; i < system.n(); ++i) {
    solution.after.push_back(residue(mode.x(i), mode.denominator(), steps));
    common = gcd(common, solution.after.back());
    solution.state_after[i] = scale * (solution.after.back().convert_to<double>() / factor.convert_to<double>());
  }
  for (Integer& value : solution.after) value /= common;
  return solution;
}

}  // namespace

ExactOutcome solve_exactly(const IntegerSystem& system, const std::vector<Integer>& x, double scale) {
  ExactOutcome outcome;
  std::vector<char> regular;
  std::vector<ExactSolution> found;
  for (unsigned bits = 0; bits < (1U << static_cast<unsigned>(system.k())); ++bits) {
    const ModeTransform mode(system, bits, x);
    regular.push_back(mode.regular());
    outcome.all_regular &= mode.regular();
    if (!mode.regular()) continue;
    if (auto solution = solution_of(system, mode, scale)) found.push_back(std::move(*solution));
  }
  for (ExactSolution& solution : found) {
    // Two solutions with the same active set are one where that mode is regular.
    const bool known = std::any_of(outcome.solutions.begin(), outcome.solutions.end(), [&](const ExactSolution& other) {
      return other.active == solution.active &&
             (regular[solution.active] || (other.inactive == solution.inactive && other.after == solution.after));
    });
    if (!known) outcome.solutions.push_back(std::move(solution));
  }
  return outcome;
}

}  // namespace pwlsim::test
