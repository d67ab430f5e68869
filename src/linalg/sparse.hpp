#pragma once
/// Square sparse matrices: one pattern, any number of value arrays that go with it.

#include <cstddef>
#include <vector>

namespace pwlsim::linalg {

/// Of a vector: numbers of rows, columns and entries are those of KLU.
[[nodiscard]] constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Compressed columns: the entries of column j are row[start[j]] … row[start[j + 1] − 1], ascending.
struct SparsePattern {
  int size = 0;
  std::vector<int> start{0};
  std::vector<int> row;
  [[nodiscard]] std::size_t entries() const { return row.size(); }
};

/// Collects places of entries; equal ones become one.
class PatternBuilder {
 public:
  explicit PatternBuilder(int size) : size_(size) {}
  void add(int row, int column) { places_.push_back({column, row}); }
  /// The pattern, and for the i-th place added the index of its entry.
  [[nodiscard]] SparsePattern take(std::vector<int>& entry_of_place) const;

 private:
  struct Place {
    int column, row;
  };
  int size_;
  std::vector<Place> places_;
};

/// A matrix with its pattern.
struct SparseMatrix {
  SparsePattern pattern;
  std::vector<double> values;
};
/// Without the entries that are zero.
[[nodiscard]] SparseMatrix without_zeros(const SparsePattern& pattern, const std::vector<double>& values);
/// The first rows of a pattern as columns, and for each entry of them the number of the same one in the pattern.
[[nodiscard]] SparsePattern transposed(const SparsePattern& pattern, int rows, std::vector<int>& entry);
/// Its first rows as columns.
[[nodiscard]] SparseMatrix transposed(const SparseMatrix& matrix, int rows);

/// y = A x. y must not alias x.
void multiply(const SparsePattern& pattern, const std::vector<double>& values, const double* x, double* y);
/// y = Aᵀ x, of as many entries as A has columns.
void multiply_transposed(const SparseMatrix& a, const double* x, double* y);
/// y = |A| |x|.
void multiply_absolute(const SparsePattern& pattern, const std::vector<double>& values, const double* x, double* y);

/// y = b − A x, with sums in extended precision, which `work` keeps. y may alias b.
void wide_residual(const SparsePattern& pattern, const std::vector<double>& values, const std::vector<double>& x,
                   const std::vector<double>& b, std::vector<long double>& work, std::vector<double>& y);

}  // namespace pwlsim::linalg
