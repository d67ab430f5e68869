#include "base/remainder.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using pwlsim::remainder_after;

TEST_CASE("what is left of a geometric ladder is its sum", "[unit]") {
  // Changes 1, 1/4, 1/16 of a series with ratio 4 leave 1/64 + 1/256 + … = 1/48 = (1/16)/3.
  CHECK(remainder_after({1.0, 0.25, 0.0625}).size == Approx(1.0 / 48.0).epsilon(1e-14));
  CHECK(remainder_after({1.0, 0.25, 0.0625}).geometric);
  CHECK(remainder_after({1.0, 0.5}).size == Approx(0.5).epsilon(1e-14));  // 1/4 + 1/8 + …
  CHECK(remainder_after({1.0, 0.0}).size == 0.0);
}

TEST_CASE("a ratio better than the method's order is not believed", "[unit]") {
  CHECK(remainder_after({1.0, 0.01}).size == Approx(0.01 / 3.0).epsilon(1e-14));
}

TEST_CASE("a ladder that does not shrink has twice its larger change left, and says so", "[unit]") {
  CHECK(remainder_after({1.0, 2.0}).size == 4.0);
  CHECK(remainder_after({1.0, 0.9}).size == 2.0);
  CHECK_FALSE(remainder_after({1.0, 0.9}).geometric);
  CHECK_FALSE(remainder_after({1.0}).geometric);
  CHECK(std::isinf(remainder_after({}).size));
}
