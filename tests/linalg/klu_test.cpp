/// Sparse LU against matrices whose inverses are known in closed form.
#include "linalg/klu.hpp"

#include <catch2/catch.hpp>
#include <cmath>

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
  const KluOrdering ordering(full(2));
  KluFactor factor(ordering);
  REQUIRE(factor.refactor({5.0, 1.0, 1.0, 0.0}) == Factored::good);
  CHECK(ordering.counts.factorizations == 1);
  REQUIRE(factor.refactor({4.0, 1.0, 1.0, 0.0}) == Factored::good);
  CHECK(ordering.counts.refactorizations == 1);
  CHECK(ordering.counts.factorizations == 1);
  REQUIRE(factor.refactor({1e-14, 1.0, 1.0, 0.0}) == Factored::good);
  CHECK(ordering.counts.factorizations == 2);
  std::vector<double> b{1.0, 1.0};
  factor.solve(b.data());
  CHECK(b[0] == Approx(1.0).epsilon(rounding));
  CHECK(b[1] == Approx(1.0).epsilon(rounding));
  REQUIRE(factor.refactor({0.0, 1.0, 1.0, 0.0}) == Factored::good);
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
