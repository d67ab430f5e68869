#include "linalg/sparse.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pwlsim::linalg {

SparsePattern PatternBuilder::take(std::vector<int>& entry_of_place) const {
  std::vector<int> order(places_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](int i) -> const Place& { return places_[static_cast<std::size_t>(i)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return place(a).column != place(b).column ? place(a).column < place(b).column : place(a).row < place(b).row;
  });
  SparsePattern pattern;
  pattern.size = size_;
  pattern.start.assign(static_cast<std::size_t>(size_) + 1, 0);
  entry_of_place.assign(places_.size(), 0);
  const Place* last = nullptr;
  for (const int i : order) {
    const Place& now = place(i);
    if (!last || last->column != now.column || last->row != now.row) {
      pattern.row.push_back(now.row);
      ++pattern.start[static_cast<std::size_t>(now.column) + 1];
    }
    last = &now;
    entry_of_place[static_cast<std::size_t>(i)] = static_cast<int>(pattern.row.size()) - 1;
  }
  std::partial_sum(pattern.start.begin(), pattern.start.end(), pattern.start.begin());
  return pattern;
}

SparseMatrix without_zeros(const SparsePattern& pattern, const std::vector<double>& values) {
  SparseMatrix result;
  result.pattern.size = pattern.size;
  for (std::size_t j = 0; j < static_cast<std::size_t>(pattern.size); ++j) {
    for (auto k = static_cast<std::size_t>(pattern.start[j]); k < static_cast<std::size_t>(pattern.start[j + 1]); ++k) {
      if (values[k] == 0.0) continue;
      result.pattern.row.push_back(pattern.row[k]);
      result.values.push_back(values[k]);
    }
    result.pattern.start.push_back(static_cast<int>(result.values.size()));
  }
  return result;
}

SparsePattern transposed(const SparsePattern& pattern, int rows, std::vector<int>& entry) {
  SparsePattern result;
  result.size = rows;
  result.start.assign(index(rows) + 1, 0);
  for (const int row : pattern.row)
    if (row < rows) ++result.start[index(row) + 1];
  std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
  std::vector<int> next = result.start;
  result.row.resize(index(next.back()));
  entry.resize(index(next.back()));
  for (int j = 0; j < pattern.size; ++j)
    for (int k = pattern.start[index(j)]; k < pattern.start[index(j) + 1]; ++k) {
      const int row = pattern.row[index(k)];
      if (row >= rows) continue;
      const std::size_t place = index(next[index(row)]++);
      result.row[place] = j;
      entry[place] = k;
    }
  return result;
}

SparseMatrix transposed(const SparseMatrix& matrix, int rows) {
  std::vector<int> entry;
  SparseMatrix result{transposed(matrix.pattern, rows, entry), {}};
  result.values.reserve(entry.size());
  for (const int k : entry) result.values.push_back(matrix.values[index(k)]);
  return result;
}

void multiply(const SparsePattern& pattern, const std::vector<double>& values, const double* x, double* y) {
  const int *const start = pattern.start.data(), *const row = pattern.row.data();
  const double* const value = values.data();
  std::fill(y, y + pattern.size, 0.0);
  for (int j = 0; j < pattern.size; ++j) {
    const double factor = x[j];
    if (factor == 0.0) continue;
    for (int k = start[j]; k < start[j + 1]; ++k) y[row[k]] += value[k] * factor;
  }
}

void multiply_transposed(const SparseMatrix& a, const double* x, double* y) {
  const int *const start = a.pattern.start.data(), *const row = a.pattern.row.data();
  const double* const value = a.values.data();
  for (int j = 0; j < a.pattern.size; ++j) {
    double sum = 0.0;
    int k = start[j];
    for (; k + 1 < start[j + 1]; k += 2) sum = (sum + value[k] * x[row[k]]) + value[k + 1] * x[row[k + 1]];
    y[j] = k < start[j + 1] ? sum + value[k] * x[row[k]] : sum;
  }
}

void multiply_absolute(const SparsePattern& pattern, const std::vector<double>& values, const double* x, double* y) {
  const int *const start = pattern.start.data(), *const row = pattern.row.data();
  const double* const value = values.data();
  std::fill(y, y + pattern.size, 0.0);
  for (int j = 0; j < pattern.size; ++j) {
    const double factor = x[j];
    if (factor == 0.0) continue;
    for (int k = start[j]; k < start[j + 1]; ++k) y[row[k]] += std::abs(value[k] * factor);
  }
}

void wide_residual(const SparsePattern& pattern, const std::vector<double>& values, const std::vector<double>& x,
                   const std::vector<double>& b, std::vector<long double>& work, std::vector<double>& y) {
  work.assign(b.begin(), b.end());
  for (std::size_t j = 0; j < x.size(); ++j)
    for (std::size_t e = index(pattern.start[j]); e < index(pattern.start[j + 1]); ++e)
      work[index(pattern.row[e])] -= static_cast<long double>(values[e]) * x[j];
  y.assign(work.begin(), work.end());
}

}  // namespace pwlsim::linalg
