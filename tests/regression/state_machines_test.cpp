/// LTspice's .machine beside what its rules say, by hand.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "regression/deck_run.hpp"

using pwlsim::test::DeckRun;
using pwlsim::test::run_text;

TEST_CASE("a state machine divides by two, and a rule from any state resets it", "[regression]") {
  // LTspice's help, ".MACHINE". The clock rises at each ms and falls half a ms later; the reset holds from 0 to 5 ms and from 10 to 15 ms. Freed at 5 ms,
  // while the clock is high, the machine waits for it to fall and rise: high from 6 to 7 ms, 8 to 9 ms. At 10 ms the clock and the reset rise together.
  const DeckRun run = run_text(
      "divide by 2\nV1 1 0 PULSE(0 1 0 1u 1u .5m 1m)\nV2 c 0 PULSE(0 1 0 1u 1u 5m 10m)\nR1 2 0 1k\nR2 3 0 1k\nR3 4 0 2k\n.machine 1n\n"
      ".state S0a 0\n.state S0b 0\n.state S1a {one}\n.state S1b {one}\n.rule S0a S0b V(1) < .5\n.rule S0b S1a V(1) > .5\n"
      ".rule S1a S1b V(1) < .5\n.rule S1b S0a V(1) > .5\n.rule * S0a V(c) > .5\n.output (2) state\n.output (3) if(state==1, V(1), 2)\n"
      ".output (4) V(1) < .5\n.endmachine\n.param one=1\n.save v(2) v(3) v(4)\n.tran 0.1m 20m 0.05m\n.end\n");
  REQUIRE(run.messages.empty());
  REQUIRE(run.rows.size() == 201);
  for (const auto& row : run.rows) {
    const double t = row[0], phase = std::fmod(t, 1e-3);
    if (t > 19.99e-3) continue;  // the last row stands at an edge
    const bool is_high = (t > 6e-3 && t < 10e-3 && static_cast<int>(t * 1e3) % 2 == 0) || (t > 16e-3 && static_cast<int>(t * 1e3) % 2 == 0);
    const bool clock = phase < 0.501e-3;
    INFO(t);
    CHECK(row[1] == Approx(is_high ? 1.0 : 0.0).margin(1e-12));
    CHECK(row[2] == Approx(!is_high ? 2.0 : clock ? 1.0 : 0.0).margin(1e-12));
    CHECK(row[3] == Approx(clock ? 0.0 : 2.0).margin(1e-12));
  }
}

TEST_CASE("of rules that hold together the first one leads on, and the rules of the new state follow at the same instant", "[regression]") {
  // The step at 1 ms makes all conditions true: from a the first rule leads to b, from there one to c; d is never reached. No output without a state.
  const DeckRun run = run_text(
      "order\nV1 in 0 PULSE(0 1 1m 0 0 1)\nR1 out 0 1k\nX1 in inner m\n.subckt m x y\nR1 y 0 1k\n.mach\n.state a 3\n.state b 4\n.state c "
      "5\n.state d 6\n"
      ".rule a b V(x)>0.5\n.rule a d V(x)>0.5\n.rule b c V(x)>0.5 & state>3.5\n.rule b d V(x)>0.5\n.output (y) "
      "state+V(x)\n.endmach\n.ends\n"
      ".machine\n.output (out) !(V(in)>0.5)\n.endmachine\n.save v(inner) v(out)\n.tran 0.3m 2m\n.end\n");
  REQUIRE(run.messages.empty());
  for (const auto& row : run.rows) {
    INFO(row[0]);
    CHECK(row[1] == Approx(row[0] < 1e-3 ? 3.0 : 6.0).margin(1e-12));
    CHECK(row[2] == Approx(row[0] < 1e-3 ? 1.0 : 0.0).margin(1e-12));
  }
}

TEST_CASE("a state machine in the loop of a converter keeps its voltage between two levels", "[regression]") {
  // An RC that is charged through 1 kohm from 10 V below 4 V and discharged above 6 V: both take tau ln(6/4) (from 4 to 6 V: the rest to 10 V falls from 6 to 4).
  const DeckRun run = run_text(
      "two levels\nVin in 0 10\nS1 in x g 0 SWM\nS2 x 0 ng 0 SWM\nBn ng 0 V=1-V(g)\nR1 x out 1k\nC1 out 0 1u ic=5\n.model SWM "
      "SW(Vt=0.5)\n"
      "Rg g 0 1k\n.machine\n.state off 0\n.state on 1\n.rule off on V(out)<4\n.rule on off V(out)>6\n.output (g) state\n.endmachine\n"
      ".save v(out)\n.tran 10u "
      "5m uic\n.end\n");
  REQUIRE(run.messages.empty());
  double low = 10.0, high = 0.0;
  for (const auto& row : run.rows) low = std::min(low, row[1]), high = std::max(high, row[1]);
  CHECK(low > 4.0 - 1e-9);
  CHECK(high < 6.0 + 1e-9);
  CHECK(low < 4.0 + 0.06);  // a row is at most 10 us, 1 % of tau, from each end, and the rates there are 6 V in tau at most
  CHECK(high > 6.0 - 0.06);
  // At 2 ms: from 5 V down to 4 V in tau ln(5/4), then up and down again.
  const double tau = 1e-3, first = tau * std::log(5.0 / 4.0), half = tau * std::log(1.5);
  const double since = std::fmod(2e-3 - first, 2.0 * half);
  const double expected = since < half ? 10.0 - 6.0 * std::exp(-since / tau) : 6.0 * std::exp(-(since - half) / tau);
  CHECK(run.rows[200][1] == Approx(expected).epsilon(1e-9));
}
