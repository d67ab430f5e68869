/// Sparse LU against matrices whose inverses are known in closed form.
#include "linalg/klu.hpp"

#include <algorithm>
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
  pivots->zeros.is_zero.assign(m.pattern.entries(), 0);
  FixedPivotFactor factor;
  std::vector<double> work;
  REQUIRE(factor.factor(m.pattern, m.values, pivots, work));
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
  CHECK_FALSE(factor.factor(m.pattern, zero, pivots, work));
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
  CHECK(sifted.rest.order.block == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(sifted.rest.order.row == std::vector<int>{3, 1, 0, 2});
  CHECK(sifted.rest.order.column == std::vector<int>{1, 3, 0, 2});
  CHECK(sifted.rest.single_rows == 4);
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

namespace {

/// A chain of resistors with a switch from each node to ground: node equations  −x_{i−1} + 3 x_i − x_{i+1} + s_i = b_i  and, of each switch,  s_i = c_i  where it is open,
/// x_i + r_i s_i = c_i  where it is closed. A source drives the middle through a block of its own.
struct SwitchedChain {
  explicit SwitchedChain(int length) : nodes(length), is_closed(static_cast<std::size_t>(length), false) {
    PatternBuilder builder(2 * nodes + 1);
    for (int i = 0; i < nodes; ++i) {
      builder.add(i, i);
      builder.add(i, nodes + i);
      if (i > 0) builder.add(i, i - 1);
      if (i + 1 < nodes) builder.add(i, i + 1);
      builder.add(nodes + i, i);
      builder.add(nodes + i, nodes + i);
    }
    builder.add(nodes / 2, 2 * nodes);
    builder.add(2 * nodes, 2 * nodes);
    std::vector<int> entry;
    pattern = builder.take(entry);
    size = 2 * nodes + 1;
  }
  /// By columns and rows.
  [[nodiscard]] double at(int row, int column) const {
    if (row < nodes) return column == row ? 3.0 : column == nodes + row ? 1.0 : column == 2 * nodes ? 0.5 : column < nodes ? -1.0 : 0.0;
    if (row == 2 * nodes) return 2.0;
    const bool closed = is_closed[static_cast<std::size_t>(row - nodes)];
    return column < nodes ? (closed ? 1.0 : 0.0) : closed ? 0.1 * (row - nodes) : 1.0;
  }
  [[nodiscard]] std::vector<double> values() const {
    std::vector<double> result;
    for (int j = 0; j < size; ++j)
      for (int e = pattern.start[static_cast<std::size_t>(j)]; e < pattern.start[static_cast<std::size_t>(j) + 1]; ++e)
        result.push_back(at(pattern.row[static_cast<std::size_t>(e)], j));
    return result;
  }
  /// The largest error of a solution whose right-hand side is made from it.
  [[nodiscard]] double error(const KluFactor& factor) const {
    std::vector<double> exact, b(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) exact.push_back(1.0 + 0.25 * (i % 5));
    multiply(pattern, values(), exact.data(), b.data());
    factor.solve(b.data());
    double worst = 0.0;
    for (std::size_t i = 0; i < b.size(); ++i) worst = std::max(worst, std::abs(b[i] - exact[i]));
    return worst;
  }
  int nodes, size = 0;
  std::vector<bool> is_closed;
  SparsePattern pattern;
};

}  // namespace

TEST_CASE("a factor by that of a matrix with other switches closed", "[unit]") {
  SwitchedChain chain(40);
  const KluOrdering ordering(chain.pattern);
  std::vector<KluFactor> factors(2, KluFactor(ordering));
  REQUIRE(factors[0].factor(chain.values()) == Factored::good);
  CHECK(chain.error(factors[0]) < rounding);
  for (int event = 0; event < 200; ++event) {  // of one to three switches, each from what the one before has left
    for (int k = 0; k <= event % 3; ++k) {
      const auto i = static_cast<std::size_t>((7 * event + 13 * k) % chain.nodes);
      chain.is_closed[i] = !chain.is_closed[i];
    }
    const auto now = static_cast<std::size_t>(event % 2);
    REQUIRE(factors[1 - now].factor_near(factors[now], chain.values()) == Factored::good);
    CHECK(chain.error(factors[1 - now]) < 10.0 * rounding);
    KluFactor anew(ordering);
    REQUIRE(anew.factor(chain.values()) == Factored::good);
    CHECK(factors[1 - now].entries() == anew.entries());
  }
  CHECK(ordering.counts.partial_factorizations == 200);
}

TEST_CASE("a factor by that of a matrix at another scale of rows, and of one that becomes singular", "[unit]") {
  const KluOrdering ordering(full(3));
  KluFactor first(ordering), second(ordering);
  REQUIRE(first.factor(by_columns({{4.0, 0.0, 1.0}, {1.0, 2.0, 0.0}, {0.0, 1.0, 1.0}})) == Factored::good);
  REQUIRE(second.factor_near(first, by_columns({{4.0, 0.0, 1.0}, {1.0, 2.0, 0.0}, {0.0, 1e9, 1e6}})) == Factored::good);
  std::vector<double> b{7.0, 5.0, 2.003e9};  // x = (1, 2, 3)
  second.solve(b.data());
  for (std::size_t i = 0; i < 3; ++i) CHECK(b[i] == Approx(static_cast<double>(i) + 1.0).epsilon(rounding));
  KluFactor third(ordering);
  CHECK(third.factor_near(second, by_columns({{4.0, 0.0, 1.0}, {1.0, 2.0, 0.0}, {4.0, 0.0, 1.0}})) == Factored::singular);
  REQUIRE(third.factor_near(second, by_columns({{4.0, 0.0, 1.0}, {1.0, 2.0, 0.0}, {0.0, 1.0, 1.0}})) == Factored::good);
  std::vector<double> c{7.0, 5.0, 5.0};
  third.solve(c.data());
  for (std::size_t i = 0; i < 3; ++i) CHECK(c[i] == Approx(static_cast<double>(i) + 1.0).epsilon(rounding));
}

// Kept pivots may have let entries grow: columns are not taken over from there.
TEST_CASE("a factor with the pivots of another matrix gives none on", "[unit]") {
  SwitchedChain chain(10);
  const KluOrdering ordering(chain.pattern);
  KluFactor first(ordering), second(ordering), third(ordering);
  REQUIRE(first.factor(chain.values()) == Factored::good);
  REQUIRE(second.refactor_as(first, chain.values()) == Factored::good);
  CHECK(first.has_own_pivots());
  CHECK_FALSE(second.has_own_pivots());
  chain.is_closed[3] = true;
  REQUIRE(third.factor_near(second, chain.values()) == Factored::good);
  CHECK(ordering.counts.partial_factorizations == 0);
  CHECK(chain.error(third) < rounding);
}
