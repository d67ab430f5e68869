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
