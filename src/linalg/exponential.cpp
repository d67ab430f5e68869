#include "linalg/exponential.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "linalg/columns.hpp"
#include "linalg/small.hpp"
#include "linalg/tolerances.hpp"

namespace pwlsim::linalg {

namespace {

constexpr double radius = 1.0;  ///< rate·τ up to which the series is summed directly
constexpr int most_terms = 60;
constexpr Eigen::Index most_by_columns = 64;  ///< of a matrix whose products are made column by column
/// A matrix costs as much as going over so many intervals without it, at least, and one for each state.
constexpr Eigen::Index least_worth_a_matrix = 4;
/// What an interval that recurs is worth against those that do not: a use, and the most of it that counts.
constexpr std::uint32_t worth_of_a_use = 4, most_worth = 64;

/// term + (Aτ)/first·term + (Aτ)²/(first (first + 1))·term + …, until one changes nothing.
template <int length>
Small<length> small_series(const double* a, double tau, Small<length> term, int first) {
  auto sum = term;
  double largest_term = term.size();
  for (int k = first; k <= most_terms; ++k) {
    term = product(a, term);
    term.scale(tau / k);
    sum.add(term);
    const double change = term.size();
    if (change <= tolerance::negligible_term * largest_term) break;
    largest_term = std::max(largest_term, change);
  }
  return sum;
}

/// y := e^{Aτ} y.
template <int length>
void sum_small_series(const double* a, double tau, double* y) {
  small_series(a, tau, Small<length>::load(y), 1).store(y);
}

/// e^{Aτ}y from y, Ay, … A^k y.
template <int length>
void continue_small_series(const double* a, const double* powers, int k, double tau, double* out) {
  auto known = Small<length>::load(powers);
  double factor = 1.0;
  for (int j = 1; j < k; ++j) known.add_multiple(powers + j * length, factor *= tau / j);
  auto term = Small<length>::load(powers + k * length);
  term.scale(factor * tau / k);
  known.add(small_series(a, tau, term, k + 1));
  known.store(out);
}

/// e^{Aτ} − I, column by column.
template <int length>
void small_minus_identity(const double* a, double tau, double* x) {
  for (int j = 0; j < length; ++j, x += length) {
    auto term = Small<length>::load(a + j * length);
    term.scale(tau);
    small_series(a, tau, term, 2).store(x);
  }
}

/// X Y, by columns as long as X stays in the cache.
Matrix product_of(const Matrix& x, const Matrix& y) {
  if (x.cols() > most_by_columns) return x * y;
  Matrix result = Matrix::Zero(x.rows(), y.cols());
  for (Eigen::Index j = 0; j < y.cols(); ++j) add_product(first_columns(x, x.cols()), y.col(j).data(), result.col(j).data());
  return result;
}

/// e^{2Aτ} − I from X = e^{Aτ} − I.
Matrix squared(const Matrix& x) {
  Matrix result = 2.0 * x;
  const Eigen::Index n = x.rows();
  const bool small = with_length(n, [&]<int length>(Length<length>) {
    for (int j = 0; j < length; ++j) {
      double* column = result.data() + j * length;
      auto sum = Small<length>::load(column);
      for (int k = 0; k < length; ++k) sum.add_multiple(x.data() + k * length, x(k, j));
      sum.store(column);
    }
  });
  if (!small) result += product_of(x, x);
  return result;
}

double column_norm(const Matrix& x) { return x.cwiseAbs().colwise().sum().maxCoeff(); }

/// e^X − I = X + X²/2 + … in groups of four powers, by half of the products. Paterson and Stockmeyer, SIAM J. Comput. 2 (1973).
Matrix polynomial_minus_identity(const Matrix& x) {
  constexpr int group = 4;
  static_assert(most_terms % group == 0);
  std::array<Matrix, group> power{x, product_of(x, x)};
  power[2] = product_of(power[1], x);
  power[3] = product_of(power[1], power[1]);
  std::array<double, group> size{};
  std::transform(power.begin(), power.end(), size.begin(), column_norm);
  std::vector<double> factor;  // 1/k!
  double term = 1.0, whole = 1.0;
  for (int k = 1; k <= most_terms; ++k) {
    term /= k;
    factor.push_back(term);
    if (k % group == 1 && factor.size() > 1) whole *= size.back();
    if (k % group == 0 && !(term * whole * *std::max_element(size.begin(), size.end()) > tolerance::negligible_term * size.front())) break;
  }
  const auto sum_of = [&](std::size_t first) {
    Matrix sum = factor[first] * power[0];
    for (std::size_t i = 1; i < group; ++i) sum += factor[first + i] * power[i];
    return sum;
  };
  std::size_t first = factor.size() - group;
  Matrix sum = sum_of(first);
  while (first > 0) {
    first -= group;
    sum = product_of(power[3], sum) + sum_of(first);
  }
  return sum;
}

double largest_entry(const double* x, Eigen::Index n) {
  double value = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) value = std::max(value, std::abs(x[i]));
  return value;
}

}  // namespace

double norm_bound(const Matrix& m) {
  if (m.size() == 0) return 0.0;
  const Matrix size = m.cwiseAbs();
  return std::min({size.rowwise().sum().maxCoeff(), size.colwise().sum().maxCoeff(), m.norm()});
}

Exponential::Exponential(Matrix a, double rate) : a_(std::move(a)), rate_(rate) {
  base_ = rate > 0.0 ? static_cast<int>(std::floor(std::log2(0.5 * radius / rate))) : 1023;
}

const Exponential* Exponential::lead(const double* y) const {
  const Eigen::Index n = a_.rows();
  if (n <= largest_small) return nullptr;
  Eigen::Index used = n;
  while (used > 0 && y[used - 1] == 0.0) --used;
  if (used <= lead_size_) return lead_.get();
  if (2 * used > n) return nullptr;
  // The least block that holds what is not zero, and that nothing leaves.
  Eigen::Index size = std::max<Eigen::Index>(used, 1), column = 0;
  for (; column < size && size < n; ++column)
    for (Eigen::Index row = n - 1; row >= size; --row)
      if (a_(row, column) != 0.0) size = row + 1;
  lead_size_ = size;
  lead_.reset();
  if (2 * size <= n) lead_ = std::make_shared<const Exponential>(Matrix(a_.topLeftCorner(size, size)), rate_);
  return lead_.get();
}

void Exponential::taylor(double tau, double* y, double* work) const {
  const Eigen::Index n = a_.rows();
  if (with_length(n, [&]<int length>(Length<length>) { sum_small_series<length>(a_.data(), tau, y); })) return;
  double* term = work;
  double* next = work + n;
  std::copy(y, y + n, term);
  double size = largest_entry(y, n);
  for (int k = 1; k <= most_terms; ++k) {
    multiply(a_, term, next);
    const double factor = tau / k;
    double change = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      next[i] *= factor;
      y[i] += next[i];
      change = std::max(change, std::abs(next[i]));
    }
    size = std::max(size, change);
    if (change <= tolerance::negligible_term * size) return;
    std::swap(term, next);
  }
}

bool Exponential::apply_recurring(double tau, double* y, double* work) const {
  const Eigen::Index n = a_.rows(), worth_a_matrix = std::max(least_worth_a_matrix, n);
  for (auto& entry : recurring_) {
    const double rest = tau - entry.tau;
    if (entry.worth == 0 || std::abs(rest) * rate_ > tolerance::same_interval || std::abs(rest) > tolerance::same_interval * tau) continue;
    entry.worth = std::min(entry.worth + worth_of_a_use, most_worth);
    if (entry.uses < worth_a_matrix && ++entry.uses < worth_a_matrix) return false;
    if (entry.x.size() == 0) entry.x = minus_identity(entry.tau);
    multiply(entry.x, y, work);
    for (Eigen::Index i = 0; i < n; ++i) y[i] += work[i];
    if (rest == 0.0) return true;
    multiply(a_, y, work);
    for (Eigen::Index i = 0; i < n; ++i) y[i] += rest * work[i];
    return true;
  }
  // Not seen lately: every second time, in no rhythm, it takes the place of another one that is not worth more, in turn. So that of
  // more intervals than there are places, in rotation, some stay until they recur.
  constexpr std::uint32_t golden_ratio = 0x9E3779B9U, half = 0x80000000U;
  if ((misses_ += golden_ratio) < half) return false;
  Recurring& entry = recurring_[victim_++ % recurring_.size()];
  if (entry.worth > worth_of_a_use) {
    entry.worth -= entry.worth / 8 + 1;
  } else {
    entry.tau = tau;
    entry.uses = 1;
    entry.worth = worth_of_a_use;
    entry.x.resize(0, 0);
  }
  return false;
}

void Exponential::apply(double tau, double* y, double* work) const {
  if (a_.rows() == 0 || tau == 0.0) return;
  if (const Exponential* own = lead(y)) return own->apply(tau, y, work);
  if (!apply_recurring(tau, y, work)) apply_once(tau, y, work);
}

void Exponential::apply_once(double tau, double* y, double* work) const {
  const Eigen::Index n = a_.rows();
  if (const Exponential* own = lead(y)) return own->apply_once(tau, y, work);
  if (rate_ * tau > radius) {
    int p = std::ilogb(tau);
    for (; p > base_ && rate_ * tau > radius; --p) {
      const double step = std::ldexp(1.0, p);
      if (tau < step) continue;
      multiply(power(p), y, work);
      for (Eigen::Index i = 0; i < n; ++i) y[i] += work[i];
      tau -= step;
    }
  }
  if (tau > 0.0) taylor(tau, y, work);
}

bool Exponential::shift(double tau, double* y, double* work) const {
  if (rate_ * std::abs(tau) > radius) return false;
  if (const Exponential* own = lead(y))
    own->taylor(tau, y, work);
  else if (a_.rows() > 0)
    taylor(tau, y, work);
  return true;
}

bool Exponential::continue_series(const double* powers, int k, double tau, double* out) const {
  if (rate_ * tau > radius) return false;
  return with_length(a_.rows(), [&]<int length>(Length<length>) { continue_small_series<length>(a_.data(), powers, k, tau, out); });
}

Matrix Exponential::taylor_minus_identity(double tau) const {
  Matrix sum(a_.rows(), a_.cols());
  if (with_length(a_.rows(), [&]<int length>(Length<length>) { small_minus_identity<length>(a_.data(), tau, sum.data()); })) return sum;
  return polynomial_minus_identity(a_ * tau);
}

const Matrix& Exponential::power(int p) const {
  const auto found = powers_.find(p);
  if (found != powers_.end()) return *found->second;
  Matrix x = p <= base_ ? taylor_minus_identity(std::ldexp(1.0, p)) : squared(power(p - 1));
  return *(powers_[p] = std::make_shared<const Matrix>(std::move(x)));
}

Matrix Exponential::minus_identity(double tau) const {
  const Eigen::Index n = a_.rows();
  if (n == 0 || tau == 0.0) return Matrix::Zero(n, n);
  const int halvings = rate_ * tau > 0.5 * radius ? static_cast<int>(std::ceil(std::log2(rate_ * tau / (0.5 * radius)))) : 0;
  Matrix x = taylor_minus_identity(std::ldexp(tau, -halvings));
  for (int i = 0; i < halvings; ++i) x = squared(x);
  return x;
}

}  // namespace pwlsim::linalg
