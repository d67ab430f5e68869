#include "linalg/refined_solution.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "linalg/doubled.hpp"
#include "linalg/last_places.hpp"

using namespace pwlsim::linalg;
using pwlsim::test::last_places;

// A current of 1 flows through 10¹² and 1/3 in series to ground: by Ohm's law the node between is at 3. The sum 10¹² + 1/3, rounded, is off by
// 10⁻⁸, a leak of 10⁻⁷ of the small conductance.
TEST_CASE("what rounding left of a matrix counts in a refined solution", "[unit]") {
  const Wide large = 1e12L, small = 1.0L / 3.0L;
  Doubled sum{large, 0};
  sum.add(small);
  WideMatrix g(2, 2), rest = WideMatrix::Zero(2, 2), right(2, 1);
  g << large, -large, -large, sum.value;
  rest(1, 1) = sum.rest;
  right << 1, 0;
  const WideMatrix inverse = Eigen::PartialPivLU<WideMatrix>(g).inverse();
  const WideMatrix x = refined_solution(g, rest, inverse, right);
  CHECK(std::abs(x(1, 0) * small - 1) < last_places);
  const WideMatrix without = refined_solution(g, WideMatrix::Zero(2, 2), inverse, right);
  CHECK(std::abs(without(1, 0) * small - 1) > 1e-10L);
}

// The inverse of the Hilbert matrix has integer entries: that of order 6 begins with 36, −630 (Choi, Tricks or treats with the Hilbert matrix,
// American Mathematical Monthly 90, 1983).
TEST_CASE("a badly conditioned system is solved to the last place", "[unit]") {
  WideMatrix hilbert(6, 6);
  // Times lcm(1 … 11), so that the entries are integers.
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) hilbert(i, j) = 27720 / (i + j + 1);
  const WideMatrix inverse = Eigen::PartialPivLU<WideMatrix>(hilbert).inverse().cast<double>().cast<Wide>();
  const WideMatrix x = refined_solution(hilbert, WideMatrix::Zero(6, 6), inverse, WideMatrix::Identity(6, 6) * 27720);
  CHECK(std::abs(x(0, 0) - 36) < 36 * last_places);
  CHECK(std::abs(x(1, 0) + 630) < 630 * last_places);
}

// Two parts that share no current: a chain of three resistors and one of two. No current of one part moves a node of the other.
TEST_CASE("what refinements leave of a zero is zero", "[unit]") {
  WideMatrix g = WideMatrix::Zero(5, 5), right = WideMatrix::Zero(5, 1);
  g.topLeftCorner(3, 3) << 1.1L, -1, 0, -1, 1.3L, -0.3L, 0, -0.3L, 0.7L;
  g.bottomRightCorner(2, 2) << 2.1L, -0.1L, -0.1L, 0.2L;
  right(4, 0) = 1;
  WideMatrix inverse = Eigen::PartialPivLU<WideMatrix>(g).inverse();
  inverse(0, 4) = 1e-20L;  // rounding
  const WideMatrix x = refined_solution(g, WideMatrix::Zero(5, 5), inverse, right);
  CHECK(x.topRows(3).isZero(0));
  CHECK(std::abs(x(4, 0) * (2.1L * 0.2L - 0.01L) - 2.1L) < last_places);
}
