#include "linalg/partial_factor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

namespace pwlsim::linalg {

namespace {

constexpr int none = -1;
constexpr std::size_t compared_at_once = 16;

}  // namespace

PartialFactor::PartialFactor(Sifter& sifter)
    : sifter_(sifter),
      column_(index(sifter.pattern().size), 0.0),
      rows_left_(index(sifter.pattern().size)),
      reached_(index(sifter.pattern().size)),
      mark_(index(sifter.pattern().size), 0),
      visits_(index(sifter.pattern().size)) {
  const SparsePattern& pattern = sifter.pattern();
  column_of_entry_.reserve(pattern.entries());
  for (int j = 0; j < pattern.size; ++j) column_of_entry_.resize(index(pattern.start[index(j) + 1]), j);
}

/// Columns with another entry, or in a row whose scale is another.
void PartialFactor::find_changes(const FactoredMatrix& other, const std::vector<double>& values) {
  const std::size_t n = index(sifter_.pattern().size);
  is_changed_.assign(n, 0);
  is_changed_row_.assign(n, 0);
  changed_rows_.clear();
  pivots_->zeros = other.factor.pivots()->zeros;
  const double *const now = values.data(), *const before = other.values.data();
  for (std::size_t first = 0; first < values.size(); first += compared_at_once) {
    const std::size_t end = std::min(first + compared_at_once, values.size());
    if (std::memcmp(now + first, before + first, (end - first) * sizeof(double)) == 0) continue;
    for (std::size_t e = first; e < end; ++e)
      if (now[e] != before[e]) note_change(e, now[e] == 0.0);
  }
  values_.row_size = other.factor.values().row_size;
  values_.row_factor = other.factor.values().row_factor;
  for (const int row : changed_rows_) scale_again(row, values);
}

void PartialFactor::note_change(std::size_t entry, bool is_zero) {
  const std::size_t row = index(sifter_.pattern().row[entry]);
  Zeros& zeros = pivots_->zeros;
  zeros.entries_of_row[row] += (zeros.is_zero[entry] != 0 ? 1 : 0) - (is_zero ? 1 : 0);
  zeros.is_zero[entry] = is_zero ? 1 : 0;
  is_changed_[index(column_of_entry_[entry])] = 1;
  if (std::exchange(is_changed_row_[row], 1) == 0) changed_rows_.push_back(static_cast<int>(row));
}

void PartialFactor::scale_again(int row, const std::vector<double>& values) {
  const SparsePattern& by_rows = sifter_.by_rows();
  const auto each = [&](auto&& use) {
    for (int p = by_rows.start[index(row)]; p < by_rows.start[index(row) + 1]; ++p)
      use(by_rows.row[index(p)], values[index(sifter_.entry_by_rows()[index(p)])]);
  };
  double most = 0.0;
  each([&](int, double value) { most = std::max(most, std::abs(value)); });
  const double size = most > 0.0 ? most : 1.0;
  if (size == std::exchange(values_.row_size[index(row)], size)) return;
  values_.row_factor[index(row)] = 1.0 / size;
  each([&](int column, double value) {
    if (value != 0.0) is_changed_[index(column)] = 1;
  });
}

/// Whether the elimination of a column goes as it went: through the same pivots, of columns that were taken over, and with the same rows left.
bool PartialFactor::may_take_over(int column, const Pivots& other) const {
  const int k = place_before_[index(column)];
  if (is_changed_[index(column)] != 0 || k >= first_single_before_) return false;
  const int *const place = pivots_->place.data(), *const lower = other.lower_row.data(), *const upper = other.upper_row.data();
  if (place[other.row[index(k)]] != none) return false;
  for (int l = other.lower_start[index(k)]; l < other.lower_start[index(k) + 1]; ++l)
    if (place[lower[l]] != none) return false;
  const char* const is_taken_over = is_taken_over_.data();
  for (int u = other.upper_start[index(k)]; u < other.upper_start[index(k) + 1]; ++u)
    if (is_taken_over[upper[u]] == 0) return false;
  return true;
}

/// A row with a single entry is no part of any elimination: what stands above in its column stays as it is.
bool PartialFactor::may_keep_single(int row, int column, const Pivots& other) const {
  const int k = place_before_[index(column)];
  return is_changed_[index(column)] == 0 && k >= first_single_before_ && other.row[index(k)] == row;
}

/// Columns that follow on each other in the other factor as well are copied together.
void PartialFactor::take_over(int column, const FixedPivotFactor& other) {
  const int k = place_before_[index(column)], row = other.pivots()->row[index(k)];
  if (k != end_copied_) {
    copy_columns(other);
    first_copied_ = k;
  }
  end_copied_ = k + 1;
  is_taken_over_[index(row)] = 1;
  pivots_->place[index(row)] = static_cast<int>(pivots_->column.size()) + k - first_copied_;
}

/// Those that wait.
void PartialFactor::copy_columns(const FixedPivotFactor& other) {
  if (first_copied_ == none) return;
  const Pivots& from = *other.pivots();
  const std::size_t first = index(first_copied_), end = index(end_copied_);
  const auto copy = [](const auto& of, std::size_t begin, std::size_t past, auto& to) {
    to.insert(to.end(), of.begin() + static_cast<std::ptrdiff_t>(begin), of.begin() + static_cast<std::ptrdiff_t>(past));
  };
  const auto copy_entries = [&](const std::vector<int>& start, const std::vector<int>& rows, const std::vector<double>& values,
                                std::vector<int>& to_start, std::vector<int>& to_rows, std::vector<double>& to_values) {
    const int moved = static_cast<int>(to_rows.size()) - start[first];
    copy(rows, index(start[first]), index(start[end]), to_rows);
    copy(values, index(start[first]), index(start[end]), to_values);
    for (std::size_t k = first + 1; k <= end; ++k) to_start.push_back(start[k] + moved);
  };
  copy_entries(from.lower_start, from.lower_row, other.values().lower, pivots_->lower_start, pivots_->lower_row, values_.lower);
  copy_entries(from.upper_start, from.upper_row, other.values().upper, pivots_->upper_start, pivots_->upper_row, values_.upper);
  copy(from.row, first, end, pivots_->row);
  copy(from.column, first, end, pivots_->column);
  copy(other.values().inverse_pivot, first, end, values_.inverse_pivot);
  first_copied_ = end_copied_ = none;
}

/// Entries above the block into U, the others into the column, with all rows that they reach.
void PartialFactor::scatter(int column, const std::vector<double>& values) {
  const SparsePattern& pattern = sifter_.pattern();
  const int block = sifter_.block_of_column(column);
  ++present_;
  left_ = reached_count_ = 0;
  for (std::size_t e = index(pattern.start[index(column)]); e < index(pattern.start[index(column) + 1]); ++e) {
    if (values[e] == 0.0) continue;
    const int row = pattern.row[e];
    const double value = values[e] / values_.row_size[index(row)];
    if (sifter_.block_of_row()[index(row)] != block) {
      pivots_->upper_row.push_back(row);
      values_.upper.push_back(value);
      continue;
    }
    reach(row);
    column_[index(row)] = value;
  }
}

/// Depth first, through the columns of L of rows that are pivots.
void PartialFactor::reach(int first) {
  const int *const place = pivots_->place.data(), *const start = pivots_->lower_start.data(), *const lower = pivots_->lower_row.data();
  int* const mark = mark_.data();
  Visit *const bottom = visits_.data(), *top = bottom;
  const auto enter = [&](int row) {
    if (mark[row] == present_) return;
    mark[row] = present_;
    const int k = place[row];
    if (k == none)
      rows_left_[left_++] = row;
    else
      *top++ = {row, start[k], start[k + 1]};
  };
  enter(first);
  while (top != bottom) {
    Visit& visit = top[-1];
    if (visit.next < visit.end) {
      enter(lower[visit.next++]);
    } else {
      reached_[reached_count_++] = visit.row;
      --top;
    }
  }
}

void PartialFactor::eliminate() {
  double* const column = column_.data();
  for (std::size_t i = reached_count_; i-- > 0;) {
    const int row = reached_[i];
    const double u = std::exchange(column[row], 0.0);
    pivots_->upper_row.push_back(row);
    values_.upper.push_back(u);
    if (u == 0.0) continue;
    const std::size_t k = index(pivots_->place[index(row)]);
    for (std::size_t l = index(pivots_->lower_start[k]); l < index(pivots_->lower_start[k + 1]); ++l)
      column[pivots_->lower_row[l]] -= values_.lower[l] * u;
  }
}

/// Of the rows that are left; the others become the column of L. None: nothing that can be divided by is left.
int PartialFactor::choose_pivot(int preferred, double diagonal_share) {
  int pivot = none;
  double most = 0.0;
  const std::span<const int> rows_left(rows_left_.data(), left_);
  for (const int row : rows_left)
    if (const double size = std::abs(column_[index(row)]); size > most) {
      most = size;
      pivot = row;
    }
  const bool is_left = mark_[index(preferred)] == present_ && pivots_->place[index(preferred)] == none;
  if (is_left && std::abs(column_[index(preferred)]) >= diagonal_share * most) pivot = preferred;
  const double value = pivot == none ? 0.0 : column_[index(pivot)], inverse = 1.0 / value;
  for (const int row : rows_left) {
    const double left = std::exchange(column_[index(row)], 0.0);
    if (row == pivot) continue;
    pivots_->lower_row.push_back(row);
    values_.lower.push_back(left / value);
  }
  if (!(std::abs(inverse) > 0.0 && std::abs(inverse) < std::numeric_limits<double>::infinity())) return none;
  values_.inverse_pivot.push_back(inverse);
  return pivot;
}

void PartialFactor::end_column(int row, int column) {
  pivots_->place[index(row)] = static_cast<int>(pivots_->column.size());
  pivots_->row.push_back(row);
  pivots_->column.push_back(column);
  pivots_->lower_start.push_back(static_cast<int>(pivots_->lower_row.size()));
  pivots_->upper_start.push_back(static_cast<int>(pivots_->upper_row.size()));
}

void PartialFactor::take_single(int row, int column, const std::vector<double>& values) {
  const SparsePattern& pattern = sifter_.pattern();
  for (std::size_t e = index(pattern.start[index(column)]); e < index(pattern.start[index(column) + 1]); ++e) {
    if (values[e] == 0.0) continue;
    const double value = values[e] / values_.row_size[index(pattern.row[e])];
    if (pattern.row[e] == row) {
      values_.inverse_pivot.push_back(1.0 / value);
    } else {
      pivots_->upper_row.push_back(pattern.row[e]);
      values_.upper.push_back(value);
    }
  }
  end_column(row, column);
}

void PartialFactor::begin(const FactoredMatrix& other, const std::vector<double>& values) {
  const Pivots& before = *other.factor.pivots();
  const std::size_t n = before.row.size();
  pivots_ = std::make_shared<Pivots>();
  pivots_->place.assign(n, none);
  for (auto* indices : {&pivots_->row, &pivots_->column, &pivots_->lower_start, &pivots_->upper_start}) indices->reserve(n + 1);
  pivots_->lower_row.reserve(before.lower_row.size());
  pivots_->upper_row.reserve(before.upper_row.size());
  values_ = {};
  values_.lower.reserve(before.lower_row.size());
  values_.upper.reserve(before.upper_row.size());
  values_.inverse_pivot.reserve(n);
  is_taken_over_.assign(n, 0);
  preferred_of_.resize(n);
  place_before_.resize(n);
  for (std::size_t k = 0; k < n; ++k) place_before_[index(before.column[k])] = static_cast<int>(k);
  first_single_before_ = static_cast<int>(n) - before.single_rows;
  first_copied_ = end_copied_ = none;
  eliminated_columns_ = 0;
  find_changes(other, values);
}

/// Where another row is the k-th pivot, the one that the order has there goes to that one's place, as in KLU.
void PartialFactor::exchange_preferred(std::vector<int>& preferred, std::size_t k, int pivot) {
  const int left = preferred[k];
  if (pivot == left) return;
  const int place = preferred_of_[index(pivot)];
  preferred[index(place)] = left;
  preferred_of_[index(left)] = place;
}

std::optional<FixedPivotFactor> PartialFactor::factor(const FactoredMatrix& other, const std::vector<double>& values,
                                                      double diagonal_share) {
  begin(other, values);
  RestOfOrder rest = sifter_.order_rest(pivots_->zeros);
  if (!rest.is_square) return std::nullopt;
  for (std::size_t k = 0; k < rest.order.row.size(); ++k) preferred_of_[index(rest.order.row[k])] = static_cast<int>(k);
  const std::size_t n = rest.order.row.size(), first_single = n - index(rest.single_rows);
  for (std::size_t k = 0; k < n; ++k) {
    const int column = rest.order.column[k];
    const Pivots& before = *other.factor.pivots();
    if (k < first_single ? may_take_over(column, before) : may_keep_single(rest.order.row[k], column, before)) {
      take_over(column, other.factor);
      exchange_preferred(rest.order.row, k, before.row[index(place_before_[index(column)])]);
      continue;
    }
    copy_columns(other.factor);
    if (k >= first_single) {
      take_single(rest.order.row[k], column, values);
      continue;
    }
    scatter(column, values);
    eliminate();
    const int pivot = choose_pivot(rest.order.row[k], diagonal_share);
    if (pivot == none) return std::nullopt;
    end_column(pivot, column);
    ++eliminated_columns_;
    exchange_preferred(rest.order.row, k, pivot);
  }
  copy_columns(other.factor);
  pivots_->block = std::move(rest.order.block);
  pivots_->single_rows = rest.single_rows;
  return FixedPivotFactor(std::move(pivots_), std::move(values_));
}

}  // namespace pwlsim::linalg
