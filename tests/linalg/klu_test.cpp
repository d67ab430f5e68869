/// Sparse LU against matrices whose inverses are known in closed form.
#include "linalg/klu.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <utility>

#include "linalg/sifted.hpp"

using namespace pwlsim::linalg;

namespace {

constexpr double rounding = 1e-13;

/// Second differences: solve(1, …, 1) has the solution x_i = i (n + 1 − i) / 2, i from 1.
struct SecondDifferences {
  explicit SecondDifferences(int n) : builder(n) {
    for (int i = 0; i < n; ++i) {
      add(i, i, 2.0);
      if (i > 0) add(i, i - 1, -1.0);
      if (i + 1 < n) add(i, i + 1, -1.0);
    }
    std::vector<int> entry;
    pattern = builder.take(entry);
    values.assign(pattern.entries(), 0.0);
    for (std::size_t k = 0; k < entry.size(); ++k) values[static_cast<std::size_t>(entry[k])] += added[k];
  }
  void add(int row, int column, double value) {
    builder.add(row, column);
    added.push_back(value);
  }
  PatternBuilder builder;
  std::vector<double> added, values;
  SparsePattern pattern;
};

SparsePattern full(int n) {
  PatternBuilder builder(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) builder.add(i, j);
  std::vector<int> entry;
  return builder.take(entry);
}

}  // namespace

TEST_CASE("entries of a pattern that are added twice are one", "[unit]") {
  PatternBuilder builder(2);
  builder.add(1, 0);
  builder.add(0, 1);
  builder.add(1, 0);
  std::vector<int> entry;
  const SparsePattern pattern = builder.take(entry);
  CHECK(pattern.row == std::vector<int>{1, 0});
  CHECK(pattern.start == std::vector<int>{0, 1, 2});
  CHECK(entry == std::vector<int>{0, 1, 0});
}

TEST_CASE("KLU solves second differences, several right-hand sides at once", "[unit]") {
  const int n = GENERATE(1, 2, 57, 1000);
  const SecondDifferences m(n);
  const KluOrdering ordering(m.pattern);
  REQUIRE(ordering.structurally_regular());
  KluFactor factor(ordering);
  REQUIRE(factor.factor(m.values) == Factored::good);
  std::vector<double> b(2 * static_cast<std::size_t>(n), 1.0);
  for (int i = 0; i < n; ++i) b[static_cast<std::size_t>(n + i)] = 2.0;
  factor.solve(b.data(), 2);
  for (int i = 0; i < n; ++i) {
    const double exact = 0.5 * (i + 1) * (n - i);
    CHECK(b[static_cast<std::size_t>(i)] == Approx(exact).epsilon(rounding * n));
    CHECK(b[static_cast<std::size_t>(n + i)] == Approx(2.0 * exact).epsilon(rounding * n));
  }
  CHECK(ordering.counts.solves == 2);
  CHECK(factor.entries() >= static_cast<std::size_t>(n));
}

// [[d, 1], [1, 0]] x = (1, 1) has x = (1, 1 − d).
TEST_CASE("kept pivots are given up when they have become bad", "[unit]") {
  const double nothing = 1e-30;  // a zero is no entry
  const KluOrdering ordering(full(2));
  KluFactor factor(ordering);
  REQUIRE(factor.refactor({5.0, 1.0, 1.0, nothing}) == Factored::good);
  CHECK(ordering.counts.factorizations == 1);
  REQUIRE(factor.refactor({4.0, 1.0, 1.0, nothing}) == Factored::good);
  CHECK(ordering.counts.refactorizations == 1);
  CHECK(ordering.counts.factorizations == 1);
  REQUIRE(factor.refactor({1e-14, 1.0, 1.0, nothing}) == Factored::good);
  CHECK(ordering.counts.factorizations == 2);
  std::vector<double> b{1.0, 1.0};
  factor.solve(b.data());
  CHECK(b[0] == Approx(1.0).epsilon(rounding));
  CHECK(b[1] == Approx(1.0).epsilon(rounding));
  REQUIRE(factor.refactor({0.0, 1.0, 1.0, nothing}) == Factored::good);
}

TEST_CASE("singular matrices are reported, by pattern and by value", "[unit]") {
  PatternBuilder builder(2);
  builder.add(0, 0);
  builder.add(0, 1);
  std::vector<int> entry;
  const KluOrdering half(builder.take(entry));
  CHECK_FALSE(half.structurally_regular());
  KluFactor of_half(half);
  CHECK(of_half.factor({1.0, 1.0}) == Factored::singular);

  const KluOrdering ordering(full(2));
  KluFactor factor(ordering);
  CHECK(factor.factor({1.0, 2.0, 2.0, 4.0}) == Factored::singular);
  CHECK(factor.singular_column() >= 0);
  CHECK(factor.factor({1.0, 2.0, 2.0, 3.0}) == Factored::good);
}

TEST_CASE("products with a sparse matrix", "[unit]") {
  const SecondDifferences m(3);
  const std::vector<double> x{1.0, -1.0, 2.0};
  std::vector<double> y(3);
  multiply(m.pattern, m.values, x.data(), y.data());
  CHECK(y == std::vector<double>{3.0, -5.0, 5.0});
  multiply_absolute(m.pattern, m.values, x.data(), y.data());
  CHECK(y == std::vector<double>{3.0, 5.0, 5.0});
}

// Of n second differences A⁻¹ has the column sums i (n + 1 − i) / 2, so that its norm is (n + 1)² / 8 for odd n.
TEST_CASE("pivots that are given: solutions, transposed ones, the norm of the inverse", "[unit]") {
  const int n = 57;
  const SecondDifferences m(n);
  auto pivots = std::make_shared<Pivots>();
  for (int k = 0; k < n; ++k) {
    for (auto* order : {&pivots->row, &pivots->column, &pivots->place}) order->push_back(k);
    if (k + 1 < n) pivots->lower_row.push_back(k + 1);
    if (k > 0) pivots->upper_row.push_back(k - 1);
    pivots->lower_start.push_back(static_cast<int>(pivots->lower_row.size()));
    pivots->upper_start.push_back(static_cast<int>(pivots->upper_row.size()));
  }
  pivots->block = {0, n};
  pivots->pattern = m.pattern;
  for (int e = 0; e < static_cast<int>(m.pattern.entries()); ++e) pivots->entry.push_back(e);
  FixedPivotFactor factor;
  std::vector<double> work;
  REQUIRE(factor.factor(m.values, pivots, work));
  CHECK(factor.entries() == 3 * static_cast<std::size_t>(n) - 2);
  CHECK(factor.inverse_norm(work) == Approx(0.125 * (n + 1) * (n + 1)).epsilon(rounding * n));
  std::vector<double> b(static_cast<std::size_t>(n), 1.0), c = b;
  factor.solve(b.data(), work);
  factor.solve_transposed(c.data(), work);
  for (int i = 0; i < n; ++i) {
    const double exact = 0.5 * (i + 1) * (n - i);
    CHECK(b[static_cast<std::size_t>(i)] == Approx(exact).epsilon(rounding * n));
    CHECK(c[static_cast<std::size_t>(i)] == Approx(exact).epsilon(rounding * n));
  }
  std::vector<double> zero(m.values.size(), 0.0);
  CHECK_FALSE(factor.factor(zero, pivots, work));
}

// [[2, 3, 0], [0, 4, 5], [0, 1, 1]] x = (8, 23, 5) has x = (1, 2, 3): a block of one and one of two.
TEST_CASE("the pivots of one factor serve another of the same pattern", "[unit]") {
  PatternBuilder builder(3);
  for (const auto& [row, column] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1), std::pair(1, 2), std::pair(2, 1), std::pair(2, 2)})
    builder.add(row, column);
  std::vector<int> entry;
  const KluOrdering ordering(builder.take(entry));
  const auto values = [&](const std::vector<double>& added) {
    std::vector<double> result(added.size());
    for (std::size_t k = 0; k < added.size(); ++k) result[static_cast<std::size_t>(entry[k])] = added[k];
    return result;
  };
  KluFactor first(ordering), second(ordering);
  REQUIRE(first.factor(values({2.0, 3.0, 4.0, 5.0, 1.0, 1.0})) == Factored::good);
  REQUIRE(second.refactor_as(first, values({20.0, 30.0, 44.0, 50.0, 10.0, 10.0})) == Factored::good);
  CHECK(ordering.counts.factorizations == 1);
  CHECK(ordering.counts.refactorizations == 1);
  std::vector<double> b{8.0, 23.0, 5.0}, c{80.0, 238.0, 50.0};
  first.solve(b.data());
  second.solve(c.data());
  for (int i = 0; i < 3; ++i) {
    CHECK(b[static_cast<std::size_t>(i)] == Approx(i + 1.0).epsilon(rounding));
    CHECK(c[static_cast<std::size_t>(i)] == Approx(i + 1.0).epsilon(rounding));
  }
}

namespace {

/// The matrix of a full pattern, given by rows.
std::vector<double> by_columns(const std::vector<std::vector<double>>& rows) {
  std::vector<double> values;
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (const auto& row : rows) values.push_back(row[j]);
  return values;
}

}  // namespace

// Row 2 holds x₂ alone, then row 0 x₀, row 1 x₃ and row 3 x₁.
TEST_CASE("rows that zeros leave with a single entry come last", "[unit]") {
  const SparsePattern pattern = full(4);
  const BlockOrder order{{0, 1, 2, 3}, {0, 1, 2, 3}, {0, 4}};
  Sifter sifter(pattern, order);
  const std::vector<double> values = by_columns({{1.0, 0.0, 2.0, 0.0}, {3.0, 0.0, 1.0, 2.0}, {0.0, 0.0, 2.0, 0.0}, {1.0, 4.0, 0.0, 1.0}});
  const Sifted sifted = sifter.sift(values);
  CHECK(sifted.pattern.entries() == 9);
  CHECK(sifted.left_out.size() == 7);
  CHECK(sifted.order.block == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(sifted.order.row == std::vector<int>{3, 1, 0, 2});
  CHECK(sifted.order.column == std::vector<int>{1, 3, 0, 2});
  CHECK(sifted.single_rows == 4);
  CHECK(sifted.entries_above == 5);

  const KluOrdering ordering(pattern);
  KluFactor factor(ordering);
  REQUIRE(factor.factor(values) == Factored::good);
  std::vector<double> b{5.0, 11.0, 4.0, 12.0};  // x = (1, 2, 2, 3)
  factor.solve(b.data());
  const std::vector<double> exact{1.0, 2.0, 2.0, 3.0};
  for (std::size_t i = 0; i < 4; ++i) CHECK(b[i] == Approx(exact[i]).epsilon(rounding));
}

// (1, 2, 3) again, by a matrix of the same pattern in which what was zero is not.
TEST_CASE("pivots of a matrix without its zeros are given up where these are no longer zero", "[unit]") {
  const KluOrdering ordering(full(3));
  KluFactor factor(ordering);
  REQUIRE(factor.refactor(by_columns({{2.0, 0.0, 0.0}, {0.0, 4.0, 5.0}, {0.0, 1.0, 1.0}})) == Factored::good);
  REQUIRE(factor.refactor(by_columns({{3.0, 0.0, 0.0}, {0.0, 2.0, 5.0}, {0.0, 1.0, 2.0}})) == Factored::good);
  CHECK(ordering.counts.factorizations == 1);
  REQUIRE(factor.refactor(by_columns({{2.0, 0.0, 1.0}, {0.0, 4.0, 5.0}, {0.0, 1.0, 1.0}})) == Factored::good);
  CHECK(ordering.counts.factorizations == 2);
  std::vector<double> b{5.0, 23.0, 5.0};
  factor.solve(b.data());
  for (std::size_t i = 0; i < 3; ++i) CHECK(b[i] == Approx(static_cast<double>(i) + 1.0).epsilon(rounding));
}

TEST_CASE("zeros that leave two rows the same single entry make a matrix singular", "[unit]") {
  const KluOrdering ordering(full(3));
  KluFactor factor(ordering);
  CHECK(factor.factor(by_columns({{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {1.0, 1.0, 1.0}})) == Factored::singular);
  CHECK(factor.singular_column() >= 0);
}
