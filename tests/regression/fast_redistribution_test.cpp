/// Charges that move at once at an edge, on the sparse engine beside the exact one: which diodes conduct on the way decides where they end.
#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "regression/comparison.hpp"
#include "regression/deck_run.hpp"

using namespace pwlsim::test;

namespace {

/// Rows at an edge itself hold what the steps after it extrapolate to.
constexpr double tolerances = 30.0;

void check_agreement(const std::string& deck, double reltol) {
  INFO(deck << " at " << reltol);
  const DeckRun exact = run_text(deck), sparse = run_text_sparse(deck, reltol);
  REQUIRE(exact.answer.outcome == pwlsim::engine::Outcome::completed);
  REQUIRE(sparse.answer.outcome == pwlsim::engine::Outcome::completed);
  REQUIRE(exact.rows.size() == sparse.rows.size());
  CHECK(largest_difference(exact, sparse) <= tolerances * reltol);
}

/// Time constants of 2e-10 s in a run of 10.5 ms.
std::string cockcroft_walton(const char* ramp, const char* width, const char* uic) {
  std::string deck = fmt::format("multiplier\nV1 in 0 PULSE(-3.5 3.5 0 {} {} {} 526u)\n", ramp, ramp, width);
  for (int k = 1; k <= 5; ++k) {
    const std::string left = k == 1 ? "in" : fmt::format("a{}", k - 1), right = k == 1 ? "0" : fmt::format("b{}", k - 1);
    deck += fmt::format("CA{0} {1} a{0} 19n\nCB{0} {2} b{0} 19n\nDA{0} {2} a{0} DX\nDB{0} a{0} b{0} DX\n", k, left, right);
  }
  return deck + "RL b5 0 117k\n.model DX D(Ron=10m Roff=1e9 Vfwd=0.7)\n.save v(b5) v(a1) v(b1) v(a3) v(b3)\n.tran 26.3u 10.52m" + uic +
         "\n.end\n";
}

}  // namespace

TEST_CASE("the sparse engine follows charges that redistribute at once at every edge", "[regression]") {
  for (const double reltol : {1e-4, 1e-6, 1e-7})
    for (const char* uic : {"", " uic"}) {
      check_agreement(cockcroft_walton("0", "263u", uic), reltol);
      check_agreement(cockcroft_walton("1u", "262u", uic), reltol);
    }
}

// A position reached from the factor of another lost the difference of what impulses deliver in short steps.
TEST_CASE("a jump beside a ramp on the sparse engine", "[regression]") {
  std::string deck =
      "pump\nVD in 0 8.4\nV1 p1 0 PULSE(-8.4 8.4 0 0 0 156.25n 312.5n)\nV2 p2 0 PULSE(-8.4 8.4 156.25n 3.125p 3.125p 156.246875n 312.5n)\n"
      "D0 in n1 DX\n";
  for (int k = 1; k <= 5; ++k)
    deck += fmt::format("C{0} n{0} p{1} 110p\nD{0} n{0} {2} DX\n", k, 1 + k % 2, k < 5 ? fmt::format("n{}", k + 1) : "out");
  deck += "CO out 0 110p\nRL out 0 51k\n.model DX D(Ron=0 Roff=1e6 Vfwd=0.3)\n.save v(out) v(n1) v(n2)\n.tran 15.625n 3.125u\n.end\n";
  for (const double reltol : {1e-4, 1e-6}) check_agreement(deck, reltol);
}

// A lattice of diodes: currents that flow for long are a millionth of the first ones.
TEST_CASE("small currents behind a surge change sides on the sparse engine", "[regression]") {
  constexpr int side = 4;
  std::string deck = "mesh\nV1 s 0 SIN(0 10 1k)\nRS s n0_0 1\n";
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      if (j + 1 < side) deck += fmt::format("DH{0}_{1} n{0}_{1} n{0}_{2} DI\n", i, j, j + 1);
      if (i + 1 < side) deck += fmt::format("DV{0}_{1} n{0}_{1} n{2}_{1} DI\n", i, j, i + 1);
      deck += fmt::format("C{0}_{1} n{0}_{1} 0 {2}u ic={3}\nR{0}_{1} n{0}_{1} 0 5k\n", i, j, 1 + (7 * i + 3 * j) % 5, 5.0 - 0.4 * (i + j));
    }
  deck += ".model DI D\n.save v(n0_0) v(n3_3)\n.tran 10u 2m uic\n.end\n";
  for (const double reltol : {1e-4, 1e-6, 1e-7}) check_agreement(deck, reltol);
}
