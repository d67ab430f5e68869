#include "linalg/columns.hpp"

#include <catch2/catch.hpp>

using namespace pwlsim::linalg;

namespace {

/// Small whole numbers, whose sums have no rounding; some columns are zero.
Eigen::MatrixXd whole_numbers(Eigen::Index rows, Eigen::Index columns) {
  return Eigen::MatrixXd::NullaryExpr(
      rows, columns, [](Eigen::Index i, Eigen::Index j) { return j % 5 == 3 ? 0.0 : static_cast<double>((7 * i + 3 * j) % 11 - 5); });
}

}  // namespace

TEST_CASE("products with columns are those of Eigen, whatever is left of fours", "[unit]") {
  for (const Eigen::Index rows : {0, 1, 3, 4, 7, 16, 33})
    for (const Eigen::Index count : {0, 1, 2, 4, 6, 9}) {
      const Eigen::MatrixXd m = whole_numbers(rows, count + 2);
      const DenseColumns columns = first_columns(m, count);
      const Eigen::VectorXd x = whole_numbers(count, 1), z = whole_numbers(rows, 1);
      Eigen::VectorXd sum = whole_numbers(rows, 1), dots = whole_numbers(count, 1);
      const Eigen::VectorXd expected = sum + m.leftCols(count) * x, expected_dots = dots + m.leftCols(count).transpose() * z;
      add_product(columns, x.data(), sum.data());
      add_transposed_product(columns, z.data(), dots.data());
      CHECK(sum == expected);
      CHECK(dots == expected_dots);
    }
}

// Columns that stand apart, as those of a block do.
TEST_CASE("a block has its own columns", "[unit]") {
  const Eigen::MatrixXd m = whole_numbers(9, 6);
  const Eigen::VectorXd x = whole_numbers(5, 1);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(4);
  add_product(first_columns(m.middleRows(2, 4), 5), x.data(), sum.data());
  CHECK(sum == m.block(2, 0, 4, 5) * x);
}
