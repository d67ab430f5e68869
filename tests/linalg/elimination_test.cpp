/// Elimination with full pivoting on matrices whose rank and null spaces are known.
#include "linalg/elimination.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <random>

using namespace pwlsim;
using linalg::Wide;
using linalg::WideElimination;
using linalg::WideMatrix;

namespace {

constexpr Wide wide_rounding = 1e-16L;
constexpr Wide tolerance = 1e-13L;

WideMatrix random(std::mt19937_64& engine, Eigen::Index rows, Eigen::Index columns) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  WideMatrix m(rows, columns);
  for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = uniform(engine);
  return m;
}

}  // namespace

// A product of a q × r and an r × q matrix has rank r.
TEST_CASE("elimination finds rank, null spaces and solutions", "[unit]") {
  std::mt19937_64 engine(7);
  for (Eigen::Index q = 1; q <= 8; ++q)
    for (Eigen::Index rank = 0; rank <= q; ++rank) {
      INFO(q << " rows, rank " << rank);
      const WideMatrix m = rank > 0 ? WideMatrix(random(engine, q, rank) * random(engine, rank, q)) : WideMatrix(WideMatrix::Zero(q, q));
      const WideElimination elimination(m, tolerance);
      REQUIRE(elimination.rank() == rank);
      const WideMatrix right_null = elimination.kernel(), left_null = elimination.left_kernel();
      REQUIRE(right_null.cols() == q - rank);
      REQUIRE(left_null.cols() == q - rank);
      if (rank < q) {
        CHECK((m * right_null).norm() <= wide_rounding * right_null.norm() * static_cast<Wide>(q));
        CHECK((left_null.transpose() * m).norm() <= wide_rounding * left_null.norm() * static_cast<Wide>(q));
        CHECK(Eigen::FullPivLU<WideMatrix>(right_null.transpose() * right_null).rank() == q - rank);
        CHECK(Eigen::FullPivLU<WideMatrix>(left_null.transpose() * left_null).rank() == q - rank);
      }
      const WideMatrix wanted = m * random(engine, q, 3);
      const WideMatrix solution = elimination.solve(wanted);
      CHECK((m * solution - wanted).norm() <= wide_rounding * (1 + solution.norm()) * static_cast<Wide>(q));
      if (rank == q)
        CHECK((elimination.inverse() * m - WideMatrix::Identity(q, q)).norm() <=
              wide_rounding * elimination.inverse().norm() * static_cast<Wide>(q));
    }
}

TEST_CASE("elimination takes the largest entry first and stops at the tolerance", "[unit]") {
  WideMatrix m(2, 2);
  m << 1e-14L, 0, 0, -4;
  const WideElimination elimination(m, tolerance);
  CHECK(elimination.rank() == 1);
  CHECK(elimination.largest_pivot() == 4);
  CHECK(elimination.smallest_pivot() == 4);
  CHECK(elimination.kernel()(0, 0) == 1);
  CHECK(WideElimination(WideMatrix::Zero(2, 2), 0).rank() == 0);
}
