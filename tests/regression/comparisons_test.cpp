/// Comparisons outside loops are two-valued, as written: false or true at equality too, where the argument rests there.
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "regression/cards.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

/// 1 V for a second, -1 V for two, on 1 H behind a diode: the current goes up to 1 A, down to zero, and rests there for a second.
const std::string pauses = "V1 a 0 PULSE(1 -1 1 0 0 2 3)\nL1 a b 1\n";

double current(double t) { return std::max(0.0, 1.0 - std::abs(std::fmod(t, 3.0) - 1.0)); }

DeckRun run_on(bool sparse, const std::string& cards) {
  if (!sparse) return run_cards(cards);
  DeckRun run = run_text_sparse("t\n" + cards, 1e-6);
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  return run;
}

/// Rows a good way off the instants at which something changes, for the sparse engine's events.
bool is_clear(double t) { return std::abs(2.0 * t - std::round(2.0 * t)) > 0.1; }

}  // namespace

TEST_CASE("a comparison whose argument rests at its level is decided as written", "[regression]") {
  const bool sparse = false;  // the sparse engine does not see an argument that a diode stops within a step
  struct Comparison {
    const char* text;
    double above, at_zero;  ///< where the current is positive, and where it rests at zero
  };
  const Comparison comparisons[] = {{"if(I(L1)>0,5,0)", 5, 0},
                                    {"if(I(L1)>=0,5,0)", 5, 5},
                                    {"if(I(L1)<0,5,0)", 0, 0},
                                    {"if(I(L1)<=0,5,0)", 0, 5},
                                    {"if(0<I(L1),5,0)", 5, 0},
                                    {"if(0>=I(L1),5,0)", 0, 5},
                                    {"sgn(I(L1))", 1, 0},
                                    {"sgn(-2*I(L1))", -1, 0},
                                    {"u(I(L1))", 1, 0},
                                    {"u(-I(L1))", 0, 0},
                                    {"if(!(I(L1)>0),5,0)", 0, 5},
                                    {"if(I(L1)>0,v(p),v(q))", 3, 7},
                                    {"if(I(L1)>=0,v(p),v(q))", 3, 3},
                                    {"if(I(L1)<=0,v(p),v(q))", 7, 3},
                                    {"if(I(L1)>0 & v(p)>1,5,0)", 5, 0},
                                    {"if(I(L1)>0 | v(p)<1,5,0)", 5, 0}};
  std::string cards = pauses + "D1 b 0 D\n.model D D()\nVp p 0 3\nRp q 0 7\nIq 0 q 1\n", saved = ".save";
  int count = 0;
  for (const auto& c : comparisons) {
    const std::string number = std::to_string(++count);
    cards += "B" + number + " z" + number + " 0 V={" + c.text + "}\n";
    saved += " v(z" + number + ")";
  }
  const DeckRun run = run_on(sparse, cards + saved + "\n.tran 0.1 8.9 uic\n");
  for (const auto& row : run.rows) {
    if (!is_clear(row[0])) continue;
    for (std::size_t k = 0; k < std::size(comparisons); ++k) {
      INFO(comparisons[k].text << " at t = " << row[0]);
      CHECK(row[k + 1] == Approx(current(row[0]) > 0.0 ? comparisons[k].above : comparisons[k].at_zero).margin(1e-9));
    }
  }
}

TEST_CASE("chains of comparators hand on what is decided at a level", "[regression]") {
  const bool sparse = false;
  const DeckRun run = run_on(sparse, pauses +
                                         "D1 b 0 D\n.model D D()\nB1 z 0 V={if(I(L1)>0,5,0)}\nB2 y 0 V={if(v(z)>2.5,0,1)}\n"
                                         "B3 x 0 V={if(v(y)>0 & v(a)<0,1,0)}\nB4 w 0 V={if(v(z)>=5,1,0)}\nC1 y c 1n\nR1 c 0 1\n"
                                         ".save v(y) v(x) v(w)\n.tran 0.1 8.9 uic\n");
  for (const auto& row : run.rows) {
    if (!is_clear(row[0])) continue;
    const double rests = current(row[0]) > 0.0 ? 0.0 : 1.0;
    INFO("t = " << row[0]);
    CHECK(row[1] == Approx(rests).margin(1e-9));
    CHECK(row[2] == Approx(rests).margin(1e-9));
    CHECK(row[3] == Approx(1.0 - rests).margin(1e-9));
  }
}

TEST_CASE("a synchronous rectifier that a zero-current detector drives opens when the current is zero", "[regression]") {
  // Before it closes the diode takes the current, with its drop, for no time at all.
  const bool sparse = GENERATE(false, true);
  const DeckRun run = run_on(sparse, pauses +
                                         "D1 b 0 D\n.model D D(Vfwd=0.1)\nS1 b 0 z 0 SX\n.model SX SW(Vt=2.5)\nB1 z 0 V={if(I(L1)>0,5,0)}\n"
                                         ".save i(L1)\n.tran 0.1 8.9 uic\n");
  for (const auto& row : run.rows) {
    INFO("t = " << row[0]);
    CHECK(row[1] == Approx(current(row[0])).margin(sparse ? 1e-4 : exact));
  }
}

TEST_CASE("a converter at the boundary of continuous conduction closes its switch when the current has come to zero", "[regression]") {
  // 2 V or 0 V before 1 H, 1 V behind it: a triangle between 0 and 1 A with slopes of 1 A/s.
  const DeckRun run = run_cards(
      "V1 in 0 2\nS1 in a q 0 SX\n.model SX SW(Vt=0.5)\nD1 0 a D\n.model D D()\nL1 a o 1\nVo o 0 1\nB1 s 0 V={if(I(L1)<=0,1,0)}\n"
      "B2 r 0 V={if(I(L1)>=1,1,0)}\nA1 s r 0 0 0 0 q 0 SRFLOP\n.save i(L1)\n.tran 0.07 20 uic\n");
  check_signal(run, 1, 1.0, [](double t) { return 1.0 - std::abs(std::fmod(t, 2.0) - 1.0); });
}

TEST_CASE("a comparison in a loop stays set-valued at its level", "[regression]") {
  // x' = -sgn(x) from 1 reaches zero at t = 1 and slides there: sgn is what holds it. With a drive of 0.3 it is 0.3.
  const DeckRun run =
      run_cards("B1 g 0 V={sgn(v(x))}\nG1 x 0 g 0 1\nI1 0 x PULSE(0 0.3 2 0 0 10)\nC1 x 0 1 ic=1\n.save v(x) v(g)\n.tran 0.13 4 uic\n");
  check_signal(run, 1, 1.0, [](double t) { return std::max(0.0, 1.0 - t); });
  check_signal(run, 2, 1.0, [](double t) { return t < 1.0 ? 1.0 : t < 2.0 ? 0.0 : 0.3; });
}

TEST_CASE("levels called on and off count where the control reaches them", "[regression]") {
  const bool sparse = GENERATE(false, true);
  // Up to 5 V at t = 1, there until 2, down to 0 V at 3, there until 4; and a control that peaks at 5 V at t = 1.
  const DeckRun run = run_on(sparse,
                             "Vc c 0 PULSE(0 5 0 1 1 1 4)\nVd d 0 PWL(0 0 1 5 2 0 2.2 0 10 4)\nV1 a 0 1\n"
                             "S1 a x c 0 SV\nRx x 0 1\nS2 a y d 0 SV\nRy y 0 1\nS3 a z c 0 SI\nRz z 0 1\n"
                             ".model SV VSWITCH(Ron=1 Roff=1e9 Von=5 Voff=0)\n.model SI VSWITCH(Ron=1 Roff=1e9 Von=0 Voff=5)\n"
                             ".save v(x) v(y) v(z)\n.tran 0.1 7.9\n");
  for (const auto& row : run.rows) {
    const double t = row[0], phase = std::fmod(t, 4.0);
    if (!is_clear(t)) continue;
    INFO("t = " << t);
    CHECK(row[1] == Approx(phase > 1.0 && phase < 3.0 ? 0.5 : 0.0).margin(1e-8));
    CHECK(row[2] == Approx(t > 1.0 && t < 2.0 ? 0.5 : 0.0).margin(1e-8));
    CHECK(row[3] == Approx(phase > 1.0 && phase < 3.0 ? 0.0 : 0.5).margin(1e-8));
  }
}

TEST_CASE("a switch without hysteresis is off where its control rests at the threshold, one with hysteresis keeps its state",
          "[regression]") {
  const bool sparse = GENERATE(false, true);
  // The control falls from 1 V to 0.5 V until t = 1, rests there until t = 2, and rises to 1 V.
  const DeckRun run = run_on(sparse,
                             "Vc c 0 PWL(0 1 1 0.5 2 0.5 3 1)\nE1 d 0 c 0 1\nRd d e 1\nCd e 0 1n\nV1 a 0 1\n"
                             "S1 a x c 0 S0\nRx x 0 1\nS2 a y c 0 SH on\nRy y 0 1\nS3 a z d 0 S0\nRz z 0 1\nS4 a w c 0 SB\nRw w 0 1\n"
                             ".model S0 SW(Ron=1 Vt=0.5)\n.model SH SW(Ron=1 Vt=0.75 Vh=0.25)\n.model SB SW(Ron=3 Roff=1 Vt=0.5)\n"
                             ".save v(x) v(y) v(z) v(w)\n.tran 0.1 2.9\n");
  for (const auto& row : run.rows) {
    if (!is_clear(row[0])) continue;
    INFO("t = " << row[0]);
    const bool rests = row[0] > 1.0 && row[0] < 2.0;
    CHECK(row[1] == Approx(rests ? 0.0 : 0.5).margin(1e-9));
    CHECK(row[2] == Approx(0.5).margin(1e-9));
    CHECK(row[3] == Approx(rests ? 0.0 : 0.5).margin(1e-9));
    CHECK(row[4] == Approx(rests ? 0.5 : 0.25).margin(1e-9));
  }
}

// Both diodes of the secondary block, and hold the current of L1 at zero: the latch is set again at once. On the slow motion of that mode, split off from the decay of the
// transformer's current through Roff, the row of i(L1) was rounding, and positive for one order of the cards, so that the converter stopped; in others it did not.
TEST_CASE("a comparison whose argument rests at zero beside fast decays", "[regression]") {
  const std::string deck = R"(forward converter in boundary conduction
L7 in L7m 1m
Rx cx 0 0.1
Dr rr in DX
Bcr cr 0 V={if(v(is)>v(rf),1,0)}
.model SX SW(Ron=50m Roff=1Meg Vt=0.5)
RL7 L7m dr 5m
L1 sw L1m 10u
Bq q 0 V={if(v(n1)>0.5,1,0)}
An2 d0 0 0 0 0 n2 0 0 INV
Ad0 cs cr 0 0 0 0 d0 0 SRFLOP
D2 0 sw DX
Lr 0 rr 1m
K3 Lr Ls -0.999
Bis is 0 V=i(L1)
.model DX D(Ron=0 Roff=inf Vfwd=0)
K2 L7 Ls 0.999
Istep out 0 PULSE(0 0.6 0.0001015 1n 1n 1 2)
D3 sec sw DX
RL1 L1m out 5m
R1 out 0 5
Ls sec 0 1m
C1 out cx 22u
Vr rf 0 3.64217
Bcs cs 0 V={if(v(is)<=0,1,0)}
Bn1 n1 0 V={if(v(n2)>0.5,0,1)}
Vin in 0 12
S1 dr 0 q 0 SX
K1 L7 Lr -0.999
.tran 5.01585e-07 0.0002 uic
.save v(out) i(L1)
.end
)";
  const DeckRun run = run_text(deck);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const DeckRun sparse = run_text_sparse(deck, 1e-7);
  REQUIRE(sparse.answer.outcome == engine::Outcome::completed);
  CHECK(run.rows.back()[1] == Approx(sparse.rows.back()[1]).epsilon(1e-4));
  CHECK(run.rows.back()[2] == Approx(sparse.rows.back()[2]).epsilon(1e-3));
}
