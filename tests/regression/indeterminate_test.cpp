/// Signals that a circuit leaves open are named; the others are not.
#include <algorithm>
#include <catch2/catch.hpp>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

/// What the note says before its colon; empty without one.
std::string open_signals(const DeckRun& run) {
  for (const auto& remark : run.answer.remarks)
    if (remark.id == "N-indeterminate") return remark.text.substr(0, remark.text.find(':'));
  return {};
}

}  // namespace

TEST_CASE("25: the currents around a ring of diodes are open, its voltages are not", "[hard]") {
  const DeckRun run =
      run_text("ring\nD1 a 0 DI\nD2 0 c DI\nD3 c a DI\nI1 0 c 1\n.model DI D\n.save i(D1) i(D2) i(D3) v(a) v(c)\n.tran 0.1 1 uic\n.end\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(open_signals(run) == "i(D1), i(D2), i(D3)");
}

TEST_CASE("26: the node between two blocking diodes is open", "[hard]") {
  const DeckRun run = run_text(
      "peak\nV1 s 0 SIN(0 1 {1/(2*pi)})\nD1 s m DI\nD2 m a DI\nC1 a 0 1 ic=0\nR1 a 0 2\n.model DI D\n.save v(a) v(m) i(D1)\n.tran 0.2 20 "
      "uic\n.end\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(open_signals(run) == "v(m)");
}

TEST_CASE("27: parallel diodes share an open current; their sum is not open", "[hard]") {
  const DeckRun run = run_text(
      "parallel\nV1 s 0 SIN(0 1 {1/(2*pi)})\nR1 s a 1\nD1 a b DI\nD2 a b DI\nC1 b 0 1\nR2 b 0 2\n.model DI D\n.save i(D1) i(D2) i(R1) "
      "v(b)\n.tran 0.2 20 uic\n.end\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(open_signals(run) == "i(D1), i(D2)");
}

TEST_CASE("a rectifier with a load leaves nothing open", "[unit]") {
  const DeckRun run = run_text(
      "half wave\nV1 s 0 SIN(0 10 50)\nR1 s a 1\nD1 a b DI\nC1 b 0 1m\nR2 b 0 50\n.model DI D\n.save v(b) i(D1) v(a)\n.tran 0.2m 0.1 "
      "uic\n.end\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(open_signals(run).empty());
}

// V2, D6 and R1 close a loop in which C1 and L3 hold all other currents: i(D6) = 2.25 V/10.5 Ω and a share that charge conservation gives.
// The two diodes in parallel beside it share theirs in any way.
TEST_CASE("a current in series with parallel diodes is determined", "[unit]") {
  const DeckRun run = run_text(
      "random network 70416\nL1 0 n1 53.1 ic=0\nD1 n1 n2 DI\nD2 n1 n2 DI\nS1 n3 n2 gS1 0 SWI\n"
      "VGS1 gS1 0 PULSE(0 1 6.53e-05 8.95e-06 8.95e-06 6.59e-05 0.000179)\nL2 n4 0 0.0141 ic=0\nD3 n3 n5 DI\nD4 n6 0 DI\n"
      "V1 n7 n3 DC -3.4 Rser=3860\nD5 n5 n8 DI\nS2 n2 n8 gS2 0 SWI\nVGS2 gS2 0 PULSE(0 1 1.26e-05 3.81e-06 3.81e-06 1.63e-05 7.63e-05)\n"
      "C1 n7 n1 1.22e-05 ic=0\nR1 n7 n8 10.5\nD6 n4 n7 DI\nV2 n4 n8 DC 2.25 Rser=0\nL3 n5 n4 2.87 ic=0\n.model DI D\n"
      ".model SWI SW(Vt=0.5)\n.save i(D1) i(D6) i(V2)\n.tran 1e-05 1e-3 uic\n.end\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(open_signals(run) == "i(D1)");
}
