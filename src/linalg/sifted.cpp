#include "linalg/sifted.hpp"

#include <cstddef>
#include <numeric>
#include <utility>

namespace pwlsim::linalg {

Sifter::Sifter(const SparsePattern& pattern, const BlockOrder& order) : pattern_(pattern), order_(order) {
  const std::size_t n = index(pattern.size);
  by_rows_ = transposed(pattern, pattern.size, entry_by_rows_);
  block_of_row_.resize(n);
  row_in_order_.resize(n);
  column_in_order_.resize(n);
  block_in_order_.resize(n);
  for (std::size_t b = 0; b + 1 < order.block.size(); ++b)
    for (int k = order.block[b]; k < order.block[b + 1]; ++k) {
      const int row = order.row[index(k)], column = order.column[index(k)];
      row_in_order_[index(column)] = row;
      column_in_order_[index(row)] = column;
      block_in_order_[index(row)] = static_cast<int>(b);
    }
}

void Sifter::drop_zeros(Sifted& sifted) const {
  SparsePattern& kept = sifted.pattern;
  kept.size = pattern_.size;
  kept.start.resize(index(pattern_.size) + 1);
  kept.row.reserve(pattern_.entries());
  sifted.entry.reserve(pattern_.entries());
  for (int j = 0; j < pattern_.size; ++j) {
    for (int e = pattern_.start[index(j)]; e < pattern_.start[index(j) + 1]; ++e) {
      if (sifted.zeros.is_zero[index(e)] != 0) continue;
      kept.row.push_back(pattern_.row[index(e)]);
      sifted.entry.push_back(e);
    }
    kept.start[index(j) + 1] = static_cast<int>(kept.row.size());
  }
}

/// Rows with one entry left, each with its column.
void Sifter::take_single_rows(const Zeros& zeros) {
  const std::size_t n = index(pattern_.size);
  const char* const is_zero = zeros.is_zero.data();
  is_row_taken_.assign(n, 0);
  is_column_taken_.assign(n, 0);
  single_rows_.clear();
  single_columns_.clear();
  entries_left_ = zeros.entries_of_row;
  for (int i = 0; i < pattern_.size; ++i)
    if (entries_left_[index(i)] == 1) single_rows_.push_back(i);
  for (std::size_t k = 0; k < single_rows_.size(); ++k) {
    const int row = single_rows_[k];
    is_row_taken_[index(row)] = 1;
    int column = -1;
    for (int p = by_rows_.start[index(row)]; p < by_rows_.start[index(row) + 1]; ++p)
      if (is_zero[entry_by_rows_[index(p)]] == 0 && is_column_taken_[index(by_rows_.row[index(p)])] == 0) column = by_rows_.row[index(p)];
    single_columns_.push_back(column);
    if (column < 0) return;  // two rows with the same single entry
    is_column_taken_[index(column)] = 1;
    for (int e = pattern_.start[index(column)]; e < pattern_.start[index(column) + 1]; ++e) {
      const int other = pattern_.row[index(e)];
      if (is_zero[e] == 0 && --entries_left_[index(other)] == 1 && is_row_taken_[index(other)] == 0) single_rows_.push_back(other);
    }
  }
}

/// Single rows go with the only columns they can, and those that the order has in these places with each other.
bool Sifter::match_single_rows() {
  row_of_column_ = row_in_order_;
  column_of_row_ = column_in_order_;
  for (std::size_t k = 0; k < single_rows_.size(); ++k) {
    const int row = single_rows_[k], column = single_columns_[k];
    if (column < 0 || block_in_order_[index(row)] != block_in_order_[index(row_in_order_[index(column)])]) return false;
    const int other_column = column_of_row_[index(row)], other_row = row_of_column_[index(column)];
    row_of_column_[index(other_column)] = other_row;
    column_of_row_[index(other_row)] = other_column;
    row_of_column_[index(column)] = row;
    column_of_row_[index(row)] = column;
  }
  return true;
}

/// What is not taken in the blocks of the pattern's order, then the single rows.
RestOfOrder Sifter::order_rest(const Zeros& zeros) {
  take_single_rows(zeros);
  if (!match_single_rows()) return {order_, 0, false};
  RestOfOrder rest;
  BlockOrder& order = rest.order;
  order.block.assign(1, 0);
  order.row.reserve(index(pattern_.size));
  order.column.reserve(index(pattern_.size));
  for (std::size_t b = 0; b + 1 < order_.block.size(); ++b) {
    for (int k = order_.block[b]; k < order_.block[b + 1]; ++k) {
      const int column = order_.column[index(k)];
      if (is_column_taken_[index(column)] != 0) continue;
      order.column.push_back(column);
      order.row.push_back(row_of_column_[index(column)]);
    }
    const int end = static_cast<int>(order.row.size());
    if (end > order.block.back()) order.block.push_back(end);
  }
  rest.single_rows = static_cast<int>(single_rows_.size());
  for (std::size_t k = single_rows_.size(); k-- > 0;) {
    order.row.push_back(single_rows_[k]);
    order.column.push_back(single_columns_[k]);
    order.block.push_back(static_cast<int>(order.row.size()));
  }
  return rest;
}

void Sifter::count_entries(Sifted& sifted) {
  const BlockOrder& order = sifted.rest.order;
  const int blocks = static_cast<int>(order.block.size()) - 1;
  for (int b = 0; b < blocks; ++b)
    for (int k = order.block[index(b)]; k < order.block[index(b) + 1]; ++k) block_of_row_[index(order.row[index(k)])] = b;
  sifted.entries_of_block.assign(index(blocks), 1);
  for (int b = 0; b < blocks - sifted.rest.single_rows; ++b) {
    int count = 0;
    for (int k = order.block[index(b)]; k < order.block[index(b) + 1]; ++k) {
      const std::size_t j = index(order.column[index(k)]);
      for (int e = sifted.pattern.start[j]; e < sifted.pattern.start[j + 1]; ++e)
        count += block_of_row_[index(sifted.pattern.row[index(e)])] == b ? 1 : 0;
    }
    sifted.entries_of_block[index(b)] = count;
  }
  sifted.entries_above =
      static_cast<int>(sifted.pattern.entries()) - std::accumulate(sifted.entries_of_block.begin(), sifted.entries_of_block.end(), 0);
}

Sifted Sifter::sift(const std::vector<double>& values) {
  Sifted sifted;
  sifted.zeros = zeros_of(pattern_, values);
  sifted.rest = order_rest(sifted.zeros);
  if (sifted.rest.is_square) {
    drop_zeros(sifted);
  } else {
    sifted.zeros = zeros_of(pattern_, std::vector<double>(values.size(), 1.0));
    sifted.pattern = pattern_;
    sifted.entry.resize(pattern_.entries());
    std::iota(sifted.entry.begin(), sifted.entry.end(), 0);
  }
  count_entries(sifted);
  return sifted;
}

}  // namespace pwlsim::linalg
