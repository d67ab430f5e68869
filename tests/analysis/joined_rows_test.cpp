#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/joined_rows.hpp"

using namespace pwlsim;

namespace {

std::vector<double> with_minus_one_for_none(std::vector<double> values) {
  for (double& value : values)
    if (std::isnan(value)) value = -1.0;
  return values;
}

}  // namespace

TEST_CASE("rows of runs are joined: lines between a run's own rows, jumps kept, nothing outside of it", "[unit]") {
  const auto joined = analysis::join_rows({{{0, 2, 2, 4}, {{0, 20, 30, 50}}}, {{1, 2, 3}, {{5, 6, 7}}}});
  CHECK(joined.times == std::vector<double>{0, 1, 2, 2, 3, 4});
  REQUIRE(joined.columns.size() == 2);
  CHECK(joined.columns[0][0] == std::vector<double>{0, 10, 20, 30, 40, 50});
  CHECK(with_minus_one_for_none(joined.columns[1][0]) == std::vector<double>{-1, 5, 6, 6, 7, -1});
}

TEST_CASE("rows of runs on one grid are joined as they are; of no run there are none", "[unit]") {
  const auto joined = analysis::join_rows({{{0, 1, 1}, {{1, 2, 3}, {4, 5, 6}}}, {{0, 1, 1}, {{7, 8, 9}, {1, 1, 1}}}});
  CHECK(joined.times == std::vector<double>{0, 1, 1});
  CHECK(joined.columns[1][0] == std::vector<double>{7, 8, 9});
  CHECK(joined.columns[0][1] == std::vector<double>{4, 5, 6});
  CHECK(analysis::join_rows({}).times.empty());
}
