/// Ranks of incidence numbers beside entries of any size, and of numbers that are known to a few places.
#include "linalg/careful_elimination.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace pwlsim;
using linalg::CarefulElimination;
using linalg::Wide;
using linalg::WideMatrix;

namespace {

constexpr Wide last_place = 1e-18L;

/// Conductances along a ring of nodes: row sums are zero but for a leak to ground at the first node. `rest` is what rounding leaves of the sums.
struct Ring {
  WideMatrix m, rest;
};

Ring ring(Eigen::Index nodes, Wide conductance, Wide leak) {
  Ring r{WideMatrix::Zero(nodes, nodes), WideMatrix::Zero(nodes, nodes)};
  const auto add = [&r](Eigen::Index i, Eigen::Index j, Wide term) {
    linalg::Doubled sum{r.m(i, j), r.rest(i, j)};
    sum.add(term);
    r.m(i, j) = sum.value;
    r.rest(i, j) = sum.rest;
  };
  for (Eigen::Index i = 0; i < nodes; ++i) {
    const Eigen::Index j = (i + 1) % nodes;
    const Wide g = conductance / static_cast<Wide>(i + 3);
    add(i, i, g);
    add(j, j, g);
    add(i, j, -g);
    add(j, i, -g);
  }
  add(0, 0, leak);
  return r;
}

}  // namespace

// The null vector of a floating ring is (1, …, 1): all potentials may move together.
TEST_CASE("a floating network is singular and a leak of any size holds it", "[unit]") {
  for (const Wide leak : {1e-3L, 1e-12L, 1e-18L, 1e-22L}) {
    const Ring held = ring(6, 1, leak), floating = ring(6, 1, 0);
    const CarefulElimination regular(held.m, held.rest, {}), singular(floating.m, floating.rest, {});
    CHECK(regular.rank() == 6);
    REQUIRE(singular.rank() == 5);
    const WideMatrix kernel = singular.kernel(), left = singular.left_kernel();
    for (Eigen::Index i = 0; i < 6; ++i) {
      CHECK(std::abs(kernel(i, 0) - 1) <= last_place);
      CHECK(std::abs(left(i, 0) - 1) <= last_place);
    }
    CHECK(singular.free_rows().size() == 1);
    // A current of `leak` into any node leaves through the leak: 1 V at the first node.
    WideMatrix current = WideMatrix::Zero(6, 1);
    current(3, 0) = leak;
    CHECK(std::abs(regular.solve(current)(0, 0) - 1) <= 1e-6L);
  }
}

TEST_CASE("what is known to a few places is singular within them", "[unit]") {
  WideMatrix m(2, 2);
  m << 1, 3, 1.0L / 3, 1 + 1e-16L;
  CHECK(CarefulElimination(m, {}, {}).rank() == 2);
  CHECK(CarefulElimination(m, {}, 1e-15L * m.cwiseAbs()).rank() == 1);
  m(1, 1) = 1 + 1e-12L;
  CHECK(CarefulElimination(m, {}, 1e-15L * m.cwiseAbs()).rank() == 2);
}

// Rows and columns in units that lie twenty decades apart.
TEST_CASE("ranks do not depend on units", "[unit]") {
  std::mt19937_64 engine(5);
  const auto whole = [&engine](int most) { return static_cast<int>(engine() % static_cast<unsigned>(2 * most + 1)) - most; };
  for (int round = 0; round < 50; ++round) {
    const Eigen::Index rank = 1 + round % 5;
    WideMatrix left(6, rank), right(rank, 7);
    for (Eigen::Index i = 0; i < left.size(); ++i) left.data()[i] = whole(3);
    for (Eigen::Index i = 0; i < right.size(); ++i) right.data()[i] = whole(3);
    WideMatrix m = left * right;
    const Eigen::Index expected = CarefulElimination(m, {}, {}).rank();
    for (auto row : m.rowwise()) row *= std::ldexp(1.0L, whole(33));
    for (auto column : m.colwise()) column *= std::ldexp(1.0L, whole(33));
    const CarefulElimination elimination(m, {}, {});
    CHECK(elimination.rank() == expected);
    CHECK(expected <= rank);
    CHECK((m * elimination.kernel()).cwiseAbs().maxCoeff() <=
          last_place * m.cwiseAbs().maxCoeff() * elimination.kernel().cwiseAbs().maxCoeff());
    CHECK(CarefulElimination(WideMatrix::Zero(3, 3), {}, {}).rank() == 0);
  }
}
