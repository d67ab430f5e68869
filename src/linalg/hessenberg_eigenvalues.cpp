#include "linalg/hessenberg_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pwlsim::linalg {

namespace {

using Eigen::Index;

constexpr double rounding = std::numeric_limits<double>::epsilon();
constexpr int most_steps = 40, steps_before_other_shift = 10;  ///< for an eigenvalue
constexpr double other_sum = 1.5,
                 other_product = 0.5625;  ///< of the two shifts that are taken then, in units of the entries beside the diagonal

/// Sum and product of the two eigenvalues that a step aims at.
struct Shifts {
  double sum, product;
};

class HessenbergStep {
 public:
  explicit HessenbergStep(Matrix& h) : h_(h) {}
  /// One step on rows and columns first … last, of which there are at least three.
  void take(Index first, Index last, const Shifts& shifts) {
    double column[3];
    const Index begin = find_begin(first, last, shifts, column);
    for (Index i = begin + 2; i <= last; ++i) {
      h_(i, i - 2) = 0.0;
      if (i > begin + 2) h_(i, i - 3) = 0.0;
    }
    for (Index k = begin; k < last; ++k) {
      const Index size = std::min<Index>(3, last - k + 1);
      if (k > begin)
        for (Index i = 0; i < 3; ++i) column[i] = i < size ? h_(k + i, k - 1) : 0.0;
      reflect(k, size, column, first, last, k > begin, k > first);
    }
  }

 private:
  /// Where two entries below the diagonal in a row are small enough for a step to begin behind them; the first column of what it does there.
  Index find_begin(Index first, Index last, const Shifts& shifts, double* column) const {
    for (Index m = last - 2;; --m) {
      const double own = h_(m, m), next = h_(m + 1, m + 1);
      column[0] = (own * (own - shifts.sum) + shifts.product) / h_(m + 1, m) + h_(m, m + 1);
      column[1] = own + next - shifts.sum;
      column[2] = h_(m + 2, m + 1);
      const double size = std::abs(column[0]) + std::abs(column[1]) + std::abs(column[2]);
      for (int i = 0; i < 3; ++i) column[i] /= size;
      if (m == first) return m;
      const double before = std::abs(h_(m, m - 1)) * (std::abs(column[1]) + std::abs(column[2]));
      if (before <= rounding * std::abs(column[0]) * (std::abs(h_(m - 1, m - 1)) + std::abs(own) + std::abs(next))) return m;
    }
  }

  /// By the reflection that leaves of a column its first entry alone.
  void reflect(Index k, Index size, const double* column, Index first, Index last, bool is_column_of_h, bool has_before) {
    const double scale = std::abs(column[0]) + std::abs(column[1]) + std::abs(column[2]);
    if (scale == 0.0) return;
    const double p = column[0] / scale, q = column[1] / scale, r = column[2] / scale;
    const double norm = std::copysign(std::sqrt(p * p + q * q + r * r), p);
    if (is_column_of_h)
      h_(k, k - 1) = -norm * scale;
    else if (has_before)
      h_(k, k - 1) = -h_(k, k - 1);
    const double x = (p + norm) / norm, y = q / norm, z = r / norm, second = q / (p + norm), third = r / (p + norm);
    for (Index j = k; j <= last; ++j) {
      double* const at = &h_(k, j);
      const double sum = at[0] + second * at[1] + (size == 3 ? third * at[2] : 0.0);
      at[0] -= sum * x;
      at[1] -= sum * y;
      if (size == 3) at[2] -= sum * z;
    }
    double *const own = h_.col(k).data(), *const next = h_.col(k + 1).data(), *const last_column = h_.col(k + size - 1).data();
    for (Index i = first; i <= std::min(last, k + 3); ++i) {
      const double sum = x * own[i] + y * next[i] + (size == 3 ? z * last_column[i] : 0.0);
      own[i] -= sum;
      next[i] -= sum * second;
      if (size == 3) last_column[i] -= sum * third;
    }
  }

  Matrix& h_;
};

/// Of the block of two that ends there.
Shifts shifts_of(const Matrix& h, Index last) {
  const double a = h(last - 1, last - 1), d = h(last, last);
  return {a + d, a * d - h(last, last - 1) * h(last - 1, last)};
}

void add_pair(const Matrix& h, Index last, std::vector<std::complex<double>>& values) {
  const double x = h(last, last), w = h(last, last - 1) * h(last - 1, last);
  const double half = 0.5 * (h(last - 1, last - 1) - x), square = half * half + w, root = std::sqrt(std::abs(square));
  if (square < 0.0) {
    values.emplace_back(x + half, root);
    values.emplace_back(x + half, -root);
    return;
  }
  const double far = half + std::copysign(root, half);
  values.emplace_back(x + far);
  values.emplace_back(far != 0.0 ? x - w / far : x);
}

}  // namespace

std::vector<std::complex<double>> hessenberg_eigenvalues(Matrix h) {
  std::vector<std::complex<double>> values;
  const double norm = h.cwiseAbs().sum();
  if (!std::isfinite(norm)) return {};
  int steps = 0;
  for (Index last = h.rows() - 1; last >= 0;) {
    Index first = last;
    for (; first > 0; --first) {
      const double beside = std::abs(h(first - 1, first - 1)) + std::abs(h(first, first));
      if (std::abs(h(first, first - 1)) <= rounding * (beside > 0.0 ? beside : norm)) break;
    }
    if (first + 1 < last) {
      if (++steps > most_steps) return {};
      Shifts shifts = shifts_of(h, last);
      if (steps % steps_before_other_shift == 0) {
        const double size = std::abs(h(last, last - 1)) + std::abs(h(last - 1, last - 2));
        shifts = {other_sum * size, other_product * size * size};
      }
      HessenbergStep(h).take(first, last, shifts);
      continue;
    }
    steps = 0;
    if (first == last)
      values.emplace_back(h(last, last));
    else
      add_pair(h, last, values);
    last = first - 1;
  }
  return values;
}

}  // namespace pwlsim::linalg
