#include "linalg/shallow_order.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

namespace pwlsim::linalg {

namespace {

constexpr std::size_t most_work = 400;  ///< operations for each entry: a chain of cells takes 150

/// Rows that are cliques of columns: eliminating a column makes one of all that hold it.
class CliqueElimination {
 public:
  explicit CliqueElimination(const SparsePattern& pattern);

  [[nodiscard]] std::optional<std::vector<int>> order();

 private:
  template <class Use>
  void each_neighbour(int column, const Use& use);
  void eliminate(int column);
  void measure(int column);

  std::vector<std::vector<int>> columns_of_, rows_of_;  ///< of each row, and each column
  std::vector<int> neighbours_, depth_;                 ///< of each column
  std::vector<char> is_eliminated_;
  std::vector<int> mark_;
  int present_ = 0;
  std::size_t work_ = 0, allowed_;
  using Candidate = std::tuple<int, int, int>;  ///< neighbours and depth together, depth, column
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates_;
};

CliqueElimination::CliqueElimination(const SparsePattern& pattern)
    : columns_of_(index(pattern.size)),
      rows_of_(index(pattern.size)),
      neighbours_(index(pattern.size), 0),
      depth_(index(pattern.size), 0),
      is_eliminated_(index(pattern.size), 0),
      mark_(index(pattern.size), 0),
      allowed_(most_work * pattern.entries()) {
  for (int j = 0; j < pattern.size; ++j)
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j) + 1]; ++e) {
      columns_of_[index(pattern.row[index(e)])].push_back(j);
      rows_of_[index(j)].push_back(pattern.row[index(e)]);
    }
}

template <class Use>
void CliqueElimination::each_neighbour(int column, const Use& use) {
  mark_[index(column)] = ++present_;
  for (const int row : rows_of_[index(column)])
    for (const int other : columns_of_[index(row)])
      if (std::exchange(mark_[index(other)], present_) != present_) use(other);
}

/// Counts the neighbours of a column.
void CliqueElimination::measure(int column) {
  int found = 0;
  each_neighbour(column, [&](int) { ++found; });
  for (const int row : rows_of_[index(column)]) work_ += columns_of_[index(row)].size();
  neighbours_[index(column)] = found;
  candidates_.emplace(found + depth_[index(column)], depth_[index(column)], column);
}

void CliqueElimination::eliminate(int column) {
  is_eliminated_[index(column)] = 1;
  std::vector<int> clique;
  each_neighbour(column, [&](int other) { clique.push_back(other); });
  for (const int row : rows_of_[index(column)]) columns_of_[index(row)].clear();
  if (clique.empty()) return;
  const int row = rows_of_[index(column)].front();
  columns_of_[index(row)] = std::move(clique);
  for (const int other : columns_of_[index(row)]) {
    std::vector<int>& rows = rows_of_[index(other)];
    std::erase_if(rows, [&](int old) { return columns_of_[index(old)].empty() || old == row; });
    rows.push_back(row);
    depth_[index(other)] = std::max(depth_[index(other)], depth_[index(column)] + 1);
  }
  for (const int other : columns_of_[index(row)]) measure(other);
}

std::optional<std::vector<int>> CliqueElimination::order() {
  std::vector<int> order;
  for (int j = 0; j < static_cast<int>(rows_of_.size()); ++j) measure(j);
  while (!candidates_.empty()) {
    const auto [cost, depth, column] = candidates_.top();
    candidates_.pop();
    if (is_eliminated_[index(column)] != 0 || depth != depth_[index(column)] || cost != neighbours_[index(column)] + depth) continue;
    if (work_ > allowed_) return std::nullopt;
    order.push_back(column);
    eliminate(column);
  }
  return order;
}

}  // namespace

std::optional<std::vector<int>> shallow_order(const SparsePattern& pattern) { return CliqueElimination(pattern).order(); }

}  // namespace pwlsim::linalg
