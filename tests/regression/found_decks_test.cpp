/// Decks that once ended the program (found by tests/random_decks), each as small as it can be.
#include <catch2/catch.hpp>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

// Nothing stores energy and no source drives: the control of the switch reads nothing. Open at 0 V with Vt = 1, all is 0.
TEST_CASE("a switch whose control no state and no source can move", "[regression]") {
  const DeckRun run = run_text("static\nR1 a 0 1\nS1 a 0 0 0 M\n.model M SW(Vt=1)\n.save v(a)\n.tran 1m 2m\n");
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (const auto& row : run.rows) CHECK(row[1] == 0.0);
}

// W19 opens and closes every 6e-19 s around a current that nothing else sees: 10^11 flips to the end of the run.
TEST_CASE("a switch that flips on and on with no effect ends the run with a message", "[regression]") {
  const DeckRun run = run_text(
      "idle flips\nV1 a in PULSE(0 1.58 14.5n 0 2.2e-09 10.2n 59.2n)\nR2 a 0 280k\n.model mCAP4 CAP(C=2.34)\nC3 b a 1.28e-12 mCAP4\n"
      "R5 out b 1.15k\nR7 a n1 351\nL8 0 n1 181u\nV11 out b EXP(10.2 2.62 1.93e-08 2.23e-08) Rser=41.9k\n"
      ".model mD12 D(Roff=0.000245 Vfwd=0.601 Rrev=1.76)\nD13 0 a mD12\nR15 o14 in 18k Rser=683\nH16 o14 0 C3 0.824\nR17 a n1 1.34k\n"
      ".model mCSW18 CSW\nW19 in o14 H16 mCSW18 on\nW20 in 0 R5 mCSW18\nL21 n1 a 14.3u\n.subckt sub1 t0 t1\nR24 0 t0 1.08e+04\n"
      "C25 m t0 5.54e-13\nC26 t1 t0 2.97e-13\n.ends\nX1002 out a sub1\n.tran 950p 52.8n\n");
  CHECK(run.answer.outcome == engine::Outcome::accumulation);
  CHECK(run.answer.id == "E-accumulation");
}
