#include "linalg/constraint_basis.hpp"

#include <catch2/catch.hpp>

#include "linalg/last_places.hpp"

using namespace pwlsim::linalg;
using pwlsim::test::last_places;

namespace {

WideMatrix constraints() {
  WideMatrix h(2, 5);
  h << 1e-6L, 0, 1, 2e-3L, 0,  //
      3e-4L, 0, 2e-3L, 5, 1;
  return h;
}

}  // namespace

TEST_CASE("a basis of what constraints leave free is orthonormal and meets them", "[unit]") {
  const WideMatrix h = constraints(), n = ConstraintBasis(h).null();
  REQUIRE(n.cols() == 3);
  CHECK((n.transpose() * n - WideMatrix::Identity(3, 3)).cwiseAbs().maxCoeff() < last_places);
  CHECK((h * n).cwiseAbs().maxCoeff() < 5 * last_places);
}

TEST_CASE("an unknown that no constraint holds is a vector of the basis", "[unit]") {
  const WideMatrix n = ConstraintBasis(constraints()).null();
  CHECK((n.row(1).array() != 0).count() == 1);
  CHECK(n.row(1).cwiseAbs().maxCoeff() == 1);
}

// One constraint h·x = 0 with a large entry p: the reflection e_j − h_j (h + e_p)/(1 + h_p), for |h| = 1, has entries −h_i h_j/(1 + h_p).
TEST_CASE("small entries of the basis keep their digits", "[unit]") {
  WideMatrix h(1, 3);
  h << 1e-9L, 1, 3e-12L;
  h /= h.norm();
  const WideMatrix n = ConstraintBasis(h).null();
  const Wide expected = h(0, 0) * h(0, 2) / (1 + h(0, 1));
  CHECK(std::abs(std::abs(n(0, 1)) - expected) < last_places * expected);
}

// Of one row h the least x with h·x = b is hᵀ b/|h|².
TEST_CASE("the least solution of constraints", "[unit]") {
  const WideMatrix h = constraints().row(0);
  WideMatrix b(1, 1);
  b << 7;
  const WideMatrix x = ConstraintBasis(h).least(b);
  CHECK((x - 7 * h.transpose() / h.squaredNorm()).cwiseAbs().maxCoeff() < 7 * last_places);
}

TEST_CASE("the pivots are unknowns in which the constraints are large", "[unit]") {
  CHECK(ConstraintBasis(constraints()).pivots() == std::vector<Eigen::Index>{3, 2});
}
