#include "analysis/row_grid.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>
#include <vector>

using namespace pwlsim;

namespace {

circuit::TimeValue written(const std::string& decimal) { return {std::strtod(decimal.c_str(), nullptr), decimal}; }
circuit::TimeValue computed(double seconds) { return {seconds, ""}; }

std::vector<double> times(const circuit::TimeValue& step, const circuit::TimeValue& stop, const circuit::TimeValue& start = written("0")) {
  circuit::TransientAnalysis transient;
  transient.step = step;
  transient.stop = stop;
  transient.start = start;
  const engine::RowGrid grid = analysis::row_grid(transient);
  std::vector<double> result;
  for (std::uint64_t k = 0; k < grid.rows; ++k) result.push_back(grid.time(k));
  return result;
}

using Times = std::vector<double>;

}  // namespace

// The expected times are decimal literals: the compiler rounds each of them once, as the contract asks ("step 0.1, row 3 prints 0.3").

TEST_CASE("rows stand at the decimal multiples of the step", "[unit]") {
  CHECK(times(written("0.1"), written("0.5")) == Times{0, 0.1, 0.2, 0.3, 0.4, 0.5});
  CHECK(times(written("1e-7"), written("7e-7")) == Times{0, 1e-7, 2e-7, 3e-7, 4e-7, 5e-7, 6e-7, 7e-7});
}

TEST_CASE("rows are counted from the start", "[unit]") {
  CHECK(times(written("0.1"), written("1.3"), written("1")) == Times{1, 1.1, 1.2, 1.3});
  CHECK(times(written("1e-3"), written("0.0025"), written("0.0005")) == Times{0.0005, 0.0015, 0.0025});
}

TEST_CASE("the stop time is added when it is off the grid", "[unit]") {
  CHECK(times(written("0.4"), written("1")) == Times{0, 0.4, 0.8, 1});
  CHECK(times(written("3"), written("1")) == Times{0, 1});
  CHECK(times(written("0.3"), written("1"), written("0.2")) == Times{0.2, 0.5, 0.8, 1});
}

TEST_CASE("an omitted step stands for a thousand equal ones from the start", "[unit]") {
  const Times from_zero = times(written("0"), written("5e-3"));
  REQUIRE(from_zero.size() == 1001);
  CHECK(from_zero[0] == 0.0);
  CHECK(from_zero[1] == 5e-6);
  CHECK(from_zero[333] == 1.665e-3);
  CHECK(from_zero[1000] == 5e-3);
  const Times from_one = times(written("0"), written("4"), written("1"));
  REQUIRE(from_one.size() == 1001);
  CHECK(from_one[0] == 1.0);
  CHECK(from_one[7] == 1.021);
  CHECK(from_one[1000] == 4.0);
}

TEST_CASE("a step that an expression gave is rounded and does not double the last row", "[unit]") {
  CHECK(times(computed(1.0 / 3.0), written("1")) == Times{0, 1.0 / 3.0, 0.6666666666666666, 1});
  CHECK(times(computed(0.1), computed(0.3)) == Times{0, 0.1, 0.2, 0.3});
  CHECK(times(computed(1e-6 / 3.0), computed(1e-5)).size() == 31);
}

TEST_CASE("every row time is the one nearest to the decimal value", "[property]") {
  // strtod of the decimal text rounds correctly (C11 7.22.1.3 with IEEE arithmetic); k * 0.0001 is written exactly by shifting digits.
  circuit::TransientAnalysis transient;
  transient.step = written("1e-4");
  transient.stop = written("10");
  transient.start = written("0");
  const engine::RowGrid grid = analysis::row_grid(transient);
  REQUIRE(grid.rows == 100001);
  std::size_t wrong = 0;
  for (std::uint64_t k = 0; k < grid.rows; ++k) {
    wrong += grid.time(k) == std::strtod((std::to_string(k) + "e-4").c_str(), nullptr) ? 0 : 1;
  }
  CHECK(wrong == 0);
}

TEST_CASE("a thousand million rows are counted without being made", "[unit]") {
  circuit::TransientAnalysis transient;
  transient.step = written("1e-9");
  transient.stop = written("1");
  const engine::RowGrid grid = analysis::row_grid(transient);
  CHECK(grid.rows == 1000000001);
  CHECK(grid.time(123456789) == 0.123456789);
  CHECK(grid.time(1000000000) == 1.0);
}
