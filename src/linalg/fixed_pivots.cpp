#include "linalg/fixed_pivots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pwlsim::linalg {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int most_estimates = 5;

double sum_of_sizes(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += std::abs(value);
  return sum;
}

}  // namespace

Zeros zeros_of(const SparsePattern& pattern, const std::vector<double>& values) {
  Zeros zeros{std::vector<char>(values.size()), std::vector<int>(index(pattern.size), 0)};
  for (std::size_t e = 0; e < values.size(); ++e) {
    zeros.is_zero[e] = values[e] == 0.0 ? 1 : 0;
    zeros.entries_of_row[index(pattern.row[e])] += values[e] == 0.0 ? 0 : 1;
  }
  return zeros;
}

FixedPivotFactor::FixedPivotFactor(std::shared_ptr<const Pivots> pivots, Values values)
    : pivots_(std::move(pivots)), values_(std::move(values)) {
  find_pivot_ratio();
}

void FixedPivotFactor::find_pivot_ratio() {
  double least = infinite, most = 0.0;
  for (const double inverse : values_.inverse_pivot) {
    least = std::min(least, std::abs(inverse));
    most = std::max(most, std::abs(inverse));
  }
  pivot_ratio_ = most > 0.0 ? least / most : 1.0;
}

/// Entries are divided by R, as by KLU: those of the same size in a row remain equal, and cancel.
void FixedPivotFactor::scale_rows(const SparsePattern& pattern, const std::vector<double>& values) {
  std::vector<double>& size = values_.row_size;
  size.assign(index(pattern.size), 0.0);
  for (std::size_t e = 0; e < pattern.entries(); ++e)
    size[index(pattern.row[e])] = std::max(size[index(pattern.row[e])], std::abs(values[e]));
  values_.row_factor.resize(size.size());
  for (std::size_t i = 0; i < size.size(); ++i) {
    if (!(size[i] > 0.0)) size[i] = 1.0;
    values_.row_factor[i] = 1.0 / size[i];
  }
}

/// Column k of the scaled matrix into `column`, of the block that begins at `first`; entries above the block into the values. Its largest entry.
double FixedPivotFactor::scatter(const SparsePattern& pattern, const std::vector<double>& values, int k, int first, int& above,
                                 double* column) {
  const std::size_t source = index(pivots_->column[index(k)]);
  double most = 0.0;
  for (std::size_t e = index(pattern.start[source]); e < index(pattern.start[source + 1]); ++e) {
    if (pivots_->zeros.is_zero[e] != 0) continue;
    const int row = pattern.row[e];
    const double value = values[e] / values_.row_size[index(row)];
    if (pivots_->place[index(row)] < first) {
      values_.upper[index(above++)] = value;
    } else {
      column[row] = value;
      most = std::max(most, std::abs(value));
    }
  }
  return most;
}

/// Column k of L and U from `column`, what is above the block done. The largest entry of U.
double FixedPivotFactor::eliminate(int k, int above, double* column) {
  const Pivots& p = *pivots_;
  double most = 0.0;
  for (int e = above; e < p.upper_start[index(k) + 1]; ++e) {
    const int row = p.upper_row[index(e)];
    const double u = std::exchange(column[row], 0.0);
    values_.upper[index(e)] = u;
    if (u == 0.0) continue;
    most = std::max(most, std::abs(u));
    const std::size_t j = index(p.place[index(row)]);
    for (int l = p.lower_start[j]; l < p.lower_start[j + 1]; ++l) column[p.lower_row[index(l)]] -= values_.lower[index(l)] * u;
  }
  const double pivot = std::exchange(column[p.row[index(k)]], 0.0);
  const double inverse = 1.0 / pivot;
  values_.inverse_pivot[index(k)] = inverse;
  for (int l = p.lower_start[index(k)]; l < p.lower_start[index(k) + 1]; ++l)
    values_.lower[index(l)] = std::exchange(column[p.lower_row[index(l)]], 0.0) * inverse;
  return std::max(most, std::abs(pivot));
}

bool FixedPivotFactor::factor(const SparsePattern& pattern, const std::vector<double>& values, std::shared_ptr<const Pivots> pivots,
                              std::vector<double>& work) {
  pivots_ = std::move(pivots);
  const Pivots& p = *pivots_;
  for (std::size_t e = 0; e < values.size(); ++e)
    if (p.zeros.is_zero[e] != 0 && values[e] != 0.0) return false;
  const std::size_t n = index(pattern.size);
  values_.lower.resize(p.lower_row.size());
  values_.upper.resize(p.upper_row.size());
  values_.inverse_pivot.resize(n);
  work.assign(n, 0.0);
  scale_rows(pattern, values);
  growth_ = 1.0;
  for (std::size_t b = 0; b + 1 < p.block.size(); ++b)
    for (int k = p.block[b]; k < p.block[b + 1]; ++k) {
      int above = p.upper_start[index(k)];
      const double of_matrix = scatter(pattern, values, k, p.block[b], above, work.data());
      const double of_upper = eliminate(k, above, work.data());
      const double inverse = std::abs(values_.inverse_pivot[index(k)]);
      if (!(inverse > 0.0 && inverse < infinite && of_upper < infinite)) return false;
      if (p.block[b + 1] - p.block[b] > 1) growth_ = std::min(growth_, of_matrix / of_upper);
    }
  find_pivot_ratio();
  return true;
}

void FixedPivotFactor::solve(double* b, std::vector<double>& work) const {
  const Pivots& p = *pivots_;
  const std::size_t n = values_.inverse_pivot.size();
  work.resize(n);
  double* const x = work.data();
  const int *const row = p.row.data(), *const column = p.column.data();
  const int *const lower_start = p.lower_start.data(), *const lower_row = p.lower_row.data();
  const int *const upper_start = p.upper_start.data(), *const upper_row = p.upper_row.data();
  const double *const lower = values_.lower.data(), *const upper = values_.upper.data(),
                      *const inverse_pivot = values_.inverse_pivot.data();
  for (std::size_t i = 0; i < n; ++i) x[i] = b[i] * values_.row_factor[i];
  const auto substitute_back = [&](std::size_t first, std::size_t end) {
    for (std::size_t k = end; k-- > first;) {
      const double factor = x[row[k]] * inverse_pivot[k];
      b[column[k]] = factor;
      if (factor == 0.0) continue;
      for (int u = upper_start[k]; u < upper_start[k + 1]; ++u) x[upper_row[u]] -= upper[u] * factor;
    }
  };
  const std::size_t singles = index(p.single_rows);
  substitute_back(n - singles, n);
  for (std::size_t block = p.block.size() - 1 - singles; block-- > 0;) {
    const std::size_t first = index(p.block[block]), end = index(p.block[block + 1]);
    for (std::size_t k = first; k + 1 < end; ++k) {
      const double factor = x[row[k]];
      if (factor == 0.0) continue;
      for (int l = lower_start[k]; l < lower_start[k + 1]; ++l) x[lower_row[l]] -= lower[l] * factor;
    }
    substitute_back(first, end);
  }
}

void FixedPivotFactor::solve_transposed(double* b, std::vector<double>& work) const {
  const Pivots& p = *pivots_;
  const std::size_t n = values_.inverse_pivot.size();
  work.resize(n);
  double* const x = work.data();  // by rows
  for (std::size_t k = 0; k < n; ++k) x[p.row[k]] = b[p.column[k]];
  for (std::size_t block = 0; block + 1 < p.block.size(); ++block) {
    const std::size_t first = index(p.block[block]), end = index(p.block[block + 1]);
    for (std::size_t k = first; k < end; ++k) {
      double& own = x[p.row[k]];
      for (int u = p.upper_start[k]; u < p.upper_start[k + 1]; ++u) own -= values_.upper[index(u)] * x[p.upper_row[index(u)]];
      own *= values_.inverse_pivot[k];
    }
    for (std::size_t k = end; k-- > first;)
      for (int l = p.lower_start[k]; l < p.lower_start[k + 1]; ++l) x[p.row[k]] -= values_.lower[index(l)] * x[p.lower_row[index(l)]];
  }
  for (std::size_t i = 0; i < n; ++i) b[i] = x[i] * values_.row_factor[i];
}

double FixedPivotFactor::inverse_norm(std::vector<double>& work) const {
  const std::size_t n = values_.inverse_pivot.size();
  std::vector<double> x(n, 1.0 / static_cast<double>(n)), sign(n, 0.0);
  double estimate = 0.0;
  std::size_t column = n;
  for (int i = 0; i < most_estimates; ++i) {
    solve(x.data(), work);
    const double now = sum_of_sizes(x);
    if (!(now > estimate)) break;
    estimate = now;
    for (std::size_t k = 0; k < n; ++k) sign[k] = x[k] >= 0.0 ? 1.0 : -1.0;
    solve_transposed(sign.data(), work);
    const auto largest = std::max_element(sign.begin(), sign.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    const auto next = static_cast<std::size_t>(largest - sign.begin());
    if (next == column) break;
    column = next;
    std::fill(x.begin(), x.end(), 0.0);
    x[column] = 1.0;
  }
  return estimate;
}

}  // namespace pwlsim::linalg
