/// Markov parameters, relative degrees and what leads, of systems where they are known.
#include "model/markov.hpp"

#include <catch2/catch.hpp>

#include "model/handmade_systems.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::Matrix;

namespace {

model::Markov of(const model::System& s) { return model::markov_parameters(s.a, s.b, s.c, s.d); }

}  // namespace

// ẍ1 = −2x1 + x2 + u, y = x1: u acts on the second derivative of y (paper, eq. (4.20)).
TEST_CASE("two carts: relative degree two, leading parameter one over the mass", "[unit]") {
  const model::Markov m = of(carts());
  CHECK(m.uniform_degree == 2);
  REQUIRE(m.parameters.size() == 3);
  CHECK(m.parameters[0](0, 0) == 0.0);
  CHECK(m.parameters[1](0, 0) == 0.0);
  CHECK(m.parameters[2](0, 0) == 1.0);
  CHECK(model::has_positive_leading_minors(m));
}

TEST_CASE("triple integrator: relative degree three", "[unit]") {
  const model::Markov m = of(triple_integrator());
  CHECK(m.uniform_degree == 3);
  CHECK(m.parameters.size() == 4);
}

// A relay's D = [[0,1],[−1,0]] is regular, so that the degree is zero, but its own minors vanish: P0 and not P.
TEST_CASE("a relay has degree zero and no positive minors", "[unit]") {
  const model::Markov m = of(relay(-1.0));
  CHECK(m.uniform_degree == 0);
  CHECK(m.degree == std::vector<std::vector<int>>{{1, 0}, {0, -1}});
  CHECK_FALSE(model::has_positive_leading_minors(m));
}

// Two chains side by side, y1'' = 1e6² u1 and y2' = u2, the first in rates of 1e6: no uniform degree, leading rows diag(1e12, 1).
TEST_CASE("chains of different length have no uniform degree, and leading rows that certify", "[unit]") {
  Matrix a = Matrix::Zero(3, 3), b = Matrix::Zero(3, 2), c = Matrix::Zero(2, 3);
  a(0, 1) = 1e6;
  b(1, 0) = 1e6;
  b(2, 1) = 1.0;
  c(0, 0) = c(1, 2) = 1.0;
  const model::Markov m = model::markov_parameters(a, b, c, Matrix::Zero(2, 2));
  CHECK(m.uniform_degree == -1);
  CHECK(m.degree == std::vector<std::vector<int>>{{2, -1}, {-1, 1}});
  REQUIRE(m.parameters.size() == 3);
  CHECK(m.parameters[2](0, 0) == Approx(1e12).epsilon(1e-14));
  CHECK(model::has_positive_leading_minors(m));
}

// y1 = x1 − x2 of two equal chains driven alike: what cancels exactly is zero, not rounding.
TEST_CASE("exact cancellation leaves no degree", "[unit]") {
  Matrix a(2, 2), b(2, 1), c(1, 2);
  a << -0.1, 0, 0, -0.1;
  b << 0.3, 0.1;
  c << 0.1, -0.3;
  CHECK(model::markov_parameters(a, b, c, Matrix::Zero(1, 1)).degree[0][0] == -1);
}
