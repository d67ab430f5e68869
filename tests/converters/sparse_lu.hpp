#pragma once
/// A = L·U of a small sparse matrix, with an order of pivots that keeps it sparse (Markowitz) and multipliers at most `threshold`⁻¹ (threshold pivoting).
/// The order that was found for one matrix serves others of the same pattern while their pivots stay large.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pwlsim::test::converters {

using Real = long double;

/// std::complex looks for infinities in every product.
struct Complex {
  Real re = 0, im = 0;
  Complex() = default;
  Complex(Real real, Real imaginary = 0) : re(real), im(imaginary) {}
  friend Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }
  friend Complex operator*(const Complex& a, const Complex& b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
  friend Complex operator/(const Complex& a, const Complex& b) {
    const Real size = b.re * b.re + b.im * b.im;
    return {(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
  }
  Complex& operator-=(const Complex& b) { return *this = *this - b; }
};

inline Real magnitude(Real x) { return std::abs(x); }
inline Real magnitude(const Complex& x) { return std::abs(x.re) + std::abs(x.im); }

/// Row after row: column and value.
template <class Scalar>
struct Entry {
  std::size_t column;
  Scalar value;
};
template <class Scalar>
using SparseMatrix = std::vector<std::vector<Entry<Scalar>>>;

struct PivotOrder {
  std::vector<std::size_t> rows, columns;
};

template <class Scalar>
class SparseLu {
 public:
  /// False where no pivot is left.
  bool factor(const SparseMatrix<Scalar>& matrix, std::optional<PivotOrder>& order) {
    if (order && eliminate(matrix, &*order)) return true;
    if (!eliminate(matrix, nullptr)) return false;
    order = order_;
    return true;
  }

  /// In place.
  void solve(std::vector<Scalar>& right) const {
    const std::size_t n = order_.rows.size();
    std::vector<Scalar> y(n);
    for (std::size_t k = 0; k < n; ++k) {
      Scalar value = right[order_.rows[k]];
      for (const auto& [column, factor] : lower_[k]) value -= factor * y[column];
      y[k] = value;
    }
    for (std::size_t k = n; k-- > 0;) {
      Scalar value = y[k];
      for (const auto& [column, entry] : upper_[k]) value -= entry * right[column];
      right[order_.columns[k]] = value / pivots_[k];
    }
  }

 private:
  static constexpr Real threshold = 0.1L, reuse_threshold = 1e-3L;

  bool eliminate(const SparseMatrix<Scalar>& matrix, const PivotOrder* given) {
    const std::size_t n = matrix.size();
    work_.assign(n * n, Scalar(0));
    rows_.assign(n, {});
    columns_.assign(n, {});
    for (std::size_t i = 0; i < n; ++i)
      for (const auto& [j, value] : matrix[i])
        if (magnitude(value) != 0) add(i, j, value, n);
    done_row_.assign(n, 0);
    done_column_.assign(n, 0);
    order_.rows.clear();
    order_.columns.clear();
    lower_by_row_.assign(n, {});
    upper_.assign(n, {});
    pivots_.assign(n, Scalar(0));
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t row = 0, column = 0;
      if (given != nullptr) {
        row = given->rows[k];
        column = given->columns[k];
        if (!large_enough(row, column, n)) return false;
      } else if (!choose(row, column, n)) {
        return false;
      }
      pivot(k, row, column, n);
    }
    lower_.resize(n);
    for (std::size_t k = 0; k < n; ++k) lower_[k] = lower_by_row_[order_.rows[k]];
    return true;
  }

  void add(std::size_t i, std::size_t j, const Scalar& value, std::size_t n) {
    Scalar& entry = work_[i * n + j];
    if (!contains(rows_[i], j)) {
      rows_[i].push_back(j);
      columns_[j].push_back(i);
    }
    entry = entry + value;
  }

  static bool contains(const std::vector<std::size_t>& list, std::size_t item) {
    for (const std::size_t other : list)
      if (other == item) return true;
    return false;
  }

  [[nodiscard]] Real column_size(std::size_t j, std::size_t n) const {
    Real result = 0;
    for (const std::size_t i : columns_[j])
      if (done_row_[i] == 0) result = std::max(result, magnitude(work_[i * n + j]));
    return result;
  }

  [[nodiscard]] bool large_enough(std::size_t row, std::size_t column, std::size_t n) const {
    const Real size = magnitude(work_[row * n + column]);
    return size > 0 && size >= reuse_threshold * column_size(column, n);
  }

  bool choose(std::size_t& row, std::size_t& column, std::size_t n) const {
    std::size_t best = n * n + 1;
    Real best_size = 0;
    for (std::size_t j = 0; j < n; ++j) {
      if (done_column_[j] != 0) continue;
      const Real size = column_size(j, n);
      if (size == 0) return false;
      const std::size_t in_column = count(columns_[j], done_row_);
      for (const std::size_t i : columns_[j]) {
        const Real here = magnitude(work_[i * n + j]);
        if (done_row_[i] != 0 || here < threshold * size) continue;
        const std::size_t cost = (count(rows_[i], done_column_) - 1) * (in_column - 1);
        if (cost > best || (cost == best && here <= best_size)) continue;
        best = cost;
        best_size = here;
        row = i;
        column = j;
      }
    }
    return best <= n * n;
  }

  static std::size_t count(const std::vector<std::size_t>& list, const std::vector<char>& done) {
    std::size_t result = 0;
    for (const std::size_t item : list) result += done[item] == 0;
    return result;
  }

  void pivot(std::size_t k, std::size_t row, std::size_t column, std::size_t n) {
    order_.rows.push_back(row);
    order_.columns.push_back(column);
    done_row_[row] = done_column_[column] = 1;
    const Scalar value = work_[row * n + column];
    pivots_[k] = value;
    for (const std::size_t j : rows_[row])
      if (done_column_[j] == 0 && magnitude(work_[row * n + j]) != 0) upper_[k].push_back({j, work_[row * n + j]});
    for (const std::size_t i : columns_[column]) {
      if (done_row_[i] != 0 || magnitude(work_[i * n + column]) == 0) continue;
      const Scalar factor = work_[i * n + column] / value;
      lower_by_row_[i].push_back({k, factor});
      for (const auto& [j, entry] : upper_[k]) add(i, j, Scalar(0) - factor * entry, n);
    }
  }

  std::vector<Scalar> work_;
  std::vector<std::vector<std::size_t>> rows_, columns_;
  std::vector<char> done_row_, done_column_;
  std::vector<std::vector<Entry<Scalar>>> lower_by_row_, lower_, upper_;
  std::vector<Scalar> pivots_;
  PivotOrder order_;
};

}  // namespace pwlsim::test::converters
