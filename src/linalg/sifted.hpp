#pragma once
/// A sparse matrix without its zeros, and what that leaves of its block triangular form.
///
/// A pattern that many matrices share holds entries that are zero in each of them: the row of a port has its voltage and its current, of which a position holds one at zero. A row
/// with a single entry left is a block of its own: it comes last, and its column is out of the other rows. So are rows that then have a single entry.

#include <vector>

#include "linalg/fixed_pivots.hpp"
#include "linalg/sparse.hpp"

namespace pwlsim::linalg {

/// An order of rows and columns in which a matrix is upper triangular by blocks.
struct BlockOrder {
  std::vector<int> row, column;  ///< of the matrix, by place
  std::vector<int> block;        ///< bounds of the diagonal blocks
};

/// What zeros leave of an order.
struct RestOfOrder {
  BlockOrder order;
  int single_rows = 0;    ///< blocks at the end
  bool is_square = true;  ///< each block; the order is that of the pattern otherwise, and the matrix is singular
};

struct Sifted {
  SparsePattern pattern;
  Zeros zeros;             ///< of the whole pattern
  std::vector<int> entry;  ///< of the whole pattern, of each entry
  RestOfOrder rest;
  std::vector<int> entries_of_block;
  int entries_above = 0;  ///< outside the blocks
};

/// Takes matrices of one pattern apart, in the blocks of its own order.
class Sifter {
 public:
  /// Both must outlive it.
  Sifter(const SparsePattern& pattern, const BlockOrder& order);
  /// All of the matrix where the blocks that are left are not square.
  [[nodiscard]] Sifted sift(const std::vector<double>& values);
  [[nodiscard]] RestOfOrder order_rest(const Zeros& zeros);

  [[nodiscard]] const SparsePattern& pattern() const { return pattern_; }
  /// Rows of the pattern as columns, and for each of their entries its number in the pattern.
  [[nodiscard]] const SparsePattern& by_rows() const { return by_rows_; }
  [[nodiscard]] const std::vector<int>& entry_by_rows() const { return entry_by_rows_; }
  /// Of each row in the order of the pattern.
  [[nodiscard]] const std::vector<int>& block_of_row() const { return block_in_order_; }
  [[nodiscard]] int block_of_column(int column) const { return block_in_order_[index(row_in_order_[index(column)])]; }

 private:
  void drop_zeros(Sifted& sifted) const;
  void take_single_rows(const Zeros& zeros);
  [[nodiscard]] bool match_single_rows();
  void count_entries(Sifted& sifted);

  const SparsePattern& pattern_;
  const BlockOrder& order_;
  SparsePattern by_rows_;
  std::vector<int> entry_by_rows_;
  std::vector<int> entries_left_;  ///< of each row, in columns that are not taken
  std::vector<char> is_row_taken_, is_column_taken_;
  std::vector<int> single_rows_, single_columns_;    ///< in the order in which they were found
  std::vector<int> row_in_order_, column_in_order_;  ///< of each column the row in the same place of the order, and the other way round
  std::vector<int> block_in_order_;                  ///< of each row
  std::vector<int> row_of_column_, column_of_row_;   ///< as in the order, but for single rows
  std::vector<int> block_of_row_;
};

}  // namespace pwlsim::linalg
