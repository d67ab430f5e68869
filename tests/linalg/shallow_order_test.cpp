#include "linalg/shallow_order.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "linalg/klu.hpp"

using namespace pwlsim;
using linalg::SparsePattern;

namespace {

SparsePattern pattern_of(const std::vector<std::vector<int>>& rows_of_columns) {
  SparsePattern pattern;
  pattern.size = static_cast<int>(rows_of_columns.size());
  for (const auto& rows : rows_of_columns) {
    pattern.row.insert(pattern.row.end(), rows.begin(), rows.end());
    pattern.start.push_back(static_cast<int>(pattern.row.size()));
  }
  return pattern;
}

/// Each cell beside the one before and the one behind.
SparsePattern chain(int size) {
  std::vector<std::vector<int>> rows;
  for (int j = 0; j < size; ++j) {
    std::vector<int>& column = rows.emplace_back();
    for (int i = std::max(j - 1, 0); i <= std::min(j + 1, size - 1); ++i) column.push_back(i);
  }
  return pattern_of(rows);
}

SparsePattern grid(int side) {
  std::vector<std::vector<int>> rows;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      std::vector<int>& column = rows.emplace_back();
      for (const auto& [dy, dx] : {std::pair(-1, 0), {0, -1}, {0, 0}, {0, 1}, {1, 0}})
        if (y + dy >= 0 && y + dy < side && x + dx >= 0 && x + dx < side) column.push_back((y + dy) * side + x + dx);
    }
  return pattern_of(rows);
}

/// The longest chain of columns of the Cholesky factor of AᵀA that depend on each other, by its definition.
int depth_in(const SparsePattern& pattern, const std::vector<int>& order) {
  const auto n = static_cast<std::size_t>(pattern.size);
  std::vector<std::set<int>> beside(n);
  std::vector<std::vector<int>> columns_of(n);
  for (int j = 0; j < pattern.size; ++j)
    for (int e = pattern.start[static_cast<std::size_t>(j)]; e < pattern.start[static_cast<std::size_t>(j) + 1]; ++e)
      columns_of[static_cast<std::size_t>(pattern.row[static_cast<std::size_t>(e)])].push_back(j);
  for (const auto& columns : columns_of)
    for (const int a : columns)
      for (const int b : columns)
        if (a != b) beside[static_cast<std::size_t>(a)].insert(b);
  std::vector<int> depth(n, 1);
  for (const int column : order) {
    const std::set<int> left = beside[static_cast<std::size_t>(column)];
    for (const int a : left) {
      auto& of_other = beside[static_cast<std::size_t>(a)];
      of_other.erase(column);
      for (const int b : left)
        if (a != b) of_other.insert(b);
      depth[static_cast<std::size_t>(a)] = std::max(depth[static_cast<std::size_t>(a)], depth[static_cast<std::size_t>(column)] + 1);
    }
  }
  return *std::max_element(depth.begin(), depth.end());
}

}  // namespace

TEST_CASE("in the shallow order a column depends on few others", "[unit]") {
  constexpr int size = 512;
  const SparsePattern pattern = chain(size);
  const auto order = linalg::shallow_order(pattern);
  REQUIRE(order);
  std::vector<int> sorted = *order, from_one_end(size);
  std::sort(sorted.begin(), sorted.end());
  std::iota(from_one_end.begin(), from_one_end.end(), 0);
  CHECK(sorted == from_one_end);
  CHECK(depth_in(pattern, from_one_end) == size);
  CHECK(depth_in(pattern, *order) <=
        4 * std::log2(size));  // by halves of halves, each cut off by the two columns that rows of a chain reach
}

TEST_CASE("the search for a shallow order ends where it takes too long", "[unit]") {
  CHECK(linalg::shallow_order(grid(10)));
  CHECK_FALSE(linalg::shallow_order(grid(100)));
}

// Each factor is of a matrix of which a few columns differ from the one before: the order changes on the way.
TEST_CASE("factors that follow each other change to a shallow order, and stay right", "[unit]") {
  constexpr int size = 200, count = 300;
  const SparsePattern pattern = chain(size);
  const linalg::KluOrdering ordering(pattern);
  linalg::KluFactor before(ordering);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  std::vector<double> values(pattern.entries());
  for (double& value : values) value = entry(random);
  REQUIRE(before.factor(values) == linalg::Factored::good);
  for (int run = 0; run < count; ++run) {
    for (int change = 0; change < 3; ++change) values[random() % values.size()] = entry(random);
    linalg::KluFactor factor(ordering);
    REQUIRE(factor.factor_near(before, values) == linalg::Factored::good);
    std::vector<double> x(size), b(size);
    for (double& value : x) value = entry(random);
    linalg::multiply(pattern, values, x.data(), b.data());
    std::vector<double> residual = b;
    factor.solve(b.data());
    std::vector<double> product(size);
    linalg::multiply(pattern, values, b.data(), product.data());
    double error = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      error = std::max(error, std::abs(product[i] - residual[i]));
      largest = std::max(largest, std::abs(b[i]));
    }
    CHECK(error <= 1e-12 * (1.0 + largest));
    std::swap(before, factor);
  }
  CHECK(ordering.counts.partial_factorizations >= count - 2);
}
