/// Parts that nothing but leaks joins to ground, by Krylov segments: their potential, and what a run from given values begins with.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "regression/deck_run.hpp"

namespace {

using namespace pwlsim;

constexpr double visible = 1e-3;  ///< V below its drop a diode blocks for sure

/// By segments, to its end.
test::DeckRun segments_to_end(const std::string& deck) {
  test::DeckRun run = test::run_text_segments(deck);
  INFO(run.messages << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  return run;
}

/// Null where there is none.
const engine::Remark* remark_of(const test::DeckRun& run, const std::string& id) {
  const auto found = std::find_if(run.answer.remarks.begin(), run.answer.remarks.end(), [&](const auto& r) { return r.id == id; });
  return found == run.answer.remarks.end() ? nullptr : &*found;
}

/// Rows in which all diodes block. Their leaks are alike, and what flows in through those from dp flows out through those to ground: Σ (v(dp) − v(p)) = Σ v(p) over the phases, by Kirchhoff's law.
/// Signals: those of the phases, then v(dp). Returns their number.
int check_blocked_rows(const test::DeckRun& run, double drop, double most) {
  int found = 0;
  for (const auto& row : run.rows) {
    const double dp = row.back(), count = static_cast<double>(row.size() - 2);
    double sum = 0.0, nearest = -INFINITY;
    for (std::size_t k = 1; k + 1 < row.size(); ++k) {
      sum += row[k];
      nearest = std::max({nearest, row[k] - dp, -row[k]});
    }
    if (!(nearest < drop - visible)) continue;
    ++found;
    INFO("t = " << row[0]);
    CHECK(2.0 * sum - count * dp == Approx(0.0).margin(1e-9 * most));
  }
  return found;
}

}  // namespace

TEST_CASE("the leaks of a blocked bridge hold the potential of its source", "[regression]") {
  struct Bridge {
    std::string what, cards;
    double drop, most;
  };
  const auto bridge = GENERATE(values<Bridge>({
      {"through 15 mΩ",
       "V1 s p1 SIN(0 622 60)\nR1 s p0 0.0149\nC1 dp 0 4.61e-05\nR9 dp 0 490\n"
       ".model DX D(Ron=0.00131 Roff=100000000 Vfwd=0.85)\n.tran 0.0020583 0.082332 uic\n",
       0.85, 622.0},
      {"through 6 µH, beside a capacitor with 2.2 Ω",
       "V1 s p1 SIN(0 17 60 0 0 35.5)\nL1 s p0 6.24e-06\nR2 p0 x 2.2\nC2 x p1 2.84e-08\nC1 dp 0 0.000626\nR9 dp 0 102\n"
       ".model DX D(Ron=0.00623 Roff=10000000000 Vfwd=0.55)\n.tran 0.0020704 0.082816 uic\n",
       0.55, 17.0},
  }));
  INFO(bridge.what);
  const auto run =
      segments_to_end("t\n" + bridge.cards + "D1 p0 dp DX\nD2 0 p0 DX\nD3 p1 dp DX\nD4 0 p1 DX\n.save v(p0) v(p1) v(dp)\n.end\n");
  CHECK(check_blocked_rows(run, bridge.drop, bridge.most) > 5);
}

TEST_CASE("the leaks of a blocked bridge of three phases hold the potential of their star", "[regression]") {
  const auto run = segments_to_end(
      "t\nV1 s0 nn SIN(0 5.7 50 0 0 -0.0646)\nR1 s0 p0 0.279\nV2 s1 nn SIN(0 5.7 50 0 0 -120.0646)\nR2 s1 p1 0.279\n"
      "V3 s2 nn SIN(0 5.7 50 0 0 -240.0646)\nR3 s2 p2 0.279\nD1 p0 dp DX\nD2 0 p0 DX\nD3 p1 dp DX\nD4 0 p1 DX\nD5 p2 dp DX\nD6 0 p2 DX\n"
      "L1 dp out 0.000732\nC1 out 0 3.36e-05\nR4 out 0 218\n.model DX D(Ron=0.0982 Roff=10000000000 Vfwd=0.3)\n"
      ".save v(p0) v(p1) v(p2) v(dp)\n.tran 0.1m 4m uic\n.end\n");
  CHECK(check_blocked_rows(run, 0.3, 5.7) > 5);
}

// Without current in its inductors a part has no voltage across its leaks: v(a) = Roff i = 0, though that rises to the drop of a diode within L/Roff, 10 fs. At 1 GΩ and 15 mH that takes 0.2 ps, of
// which the currents, at 3 kA/s, must not be taken for those of the start.
TEST_CASE("a run from given values begins before its leaks are charged", "[regression]") {
  const std::string sepic =
      "t\nVg g 0 PULSE(0 1 8.58e-08 4.29e-08 4.29e-08 9.5667e-07 4.29e-06)\nV1 in 0 24\nL1 in a 7.92e-07\nS1 a 0 g 0 SX\nC1 a b 6.53e-05\n"
      "L2 b 0 1.33e-06\nD1 b out DX\nC2 out 0 0.000256\nR1 out 0 0.716\n.model DX D(Ron=0.0278 Vfwd=0.7)\n"
      ".model SX SW(Ron=0.0278 Roff=100000000 Vt=0.5)\n.save v(a) v(b) i(L1) i(L2)\n.tran 2.5u 100u uic\n.end\n";
  const std::string cuk =
      "t\nVg g 0 PULSE(0 1 1.924e-06 0 0 2.0683e-05 9.62e-05)\nV1 in 0 48\nL1 in a 0.0154\nS1 a 0 g 0 SX\nC1 a b 1.38e-06\nD1 b 0 DX\n"
      "L2 b out 0.0296\nC2 out 0 9.78e-06\nR1 out 0 121\nK1 L1 L2 0.5\n.model DX D(Ron=0.0237 Vfwd=0.7)\n"
      ".model SX SW(Ron=0.0237 Roff=1000000000 Vt=0.5)\n.save v(a) v(b) i(L1) i(L2)\n.tran 50u 2m uic\n.end\n";
  for (const std::string& deck : {sepic, cuk}) {
    const auto run = segments_to_end(deck);
    CHECK(remark_of(run, "W-start-projected") == nullptr);
    for (std::size_t k = 1; k <= 4; ++k) CHECK(run.rows.front()[k] == Approx(0.0).margin(1e-9));
  }
}

// Two ideal diodes in parallel carry 1 A together, by Kirchhoff's law, and nothing says how they divide it. When the source of a bridge without leaks is below what its capacitor holds, all four diodes block: the source floats.
TEST_CASE("segments tell which signals the circuit leaves open", "[regression]") {
  const auto open = [](const test::DeckRun& run) {
    const engine::Remark* remark = remark_of(run, "N-indeterminate");
    return remark != nullptr ? remark->signals : std::vector<std::string>{};
  };
  const std::vector<std::string> shared{"i(D1)", "i(D2)"}, floating{"v(p0)", "v(p1)"};
  CHECK(
      open(segments_to_end(
          "t\nI1 0 a 1\nD1 a b DI\nD2 a b DI\nR1 b 0 2\nC1 b 0 1u\n.model DI D\n.save i(D1) i(D2) v(b) i(R1)\n.tran 1u 10u uic\n.end\n")) ==
      shared);
  CHECK(open(segments_to_end(
            "t\nV1 p0 p1 SIN(0 10 50)\nD1 p0 dp DI\nD2 0 p0 DI\nD3 p1 dp DI\nD4 0 p1 DI\nC1 dp 0 100u\nR1 dp 0 1k\n.model DI D(Vfwd=0.5)\n"
            ".save v(p0) v(p1) v(p0,p1) v(dp)\n.tran 1m 20m uic\n.end\n")) == floating);
  // With leaks it is held.
  CHECK(open(segments_to_end("t\nV1 p0 p1 SIN(0 10 50)\nD1 p0 dp DI\nD2 0 p0 DI\nD3 p1 dp DI\nD4 0 p1 DI\nC1 dp 0 100u\nR1 dp 0 "
                             "1k\n.model DI D(Vfwd=0.5 Roff=1G)\n"
                             ".save v(p0) v(p1) v(p0,p1) v(dp)\n.tran 1m 20m uic\n.end\n"))
            .empty());
}

// While all four switches of a charge pump are off, their leaks, which are alike, hold the potential of its capacitor: (v(i) − v(a)) + (v(i) − v(b)) = v(b) + v(a) − v(out) by Kirchhoff's law.
TEST_CASE("what flowed through switches that have opened leaves no rounding in their leaks", "[regression]") {
  const auto run = segments_to_end(
      "t\nVg0 g0 0 PULSE(0 1 6.9e-06 1.4e-08 1.4e-08 6.3086e-05 0.00014)\nVg1 g1 0 PULSE(0 1 7.69e-05 1.4e-08 1.4e-08 6.3086e-05 0.00014)\n"
      "V1 in 0 5\nR1 in i 0.0864\nS1 i a g0 0 SX\nS2 b 0 g0 0 SX\nS3 i b g1 0 SX\nS4 a out g1 0 SX\nC1 a b 0.000382\nC2 out 0 0.00334\nR2 "
      "out 0 45.4\n"
      ".model SX SW(Ron=0.041 Roff=17000000 Vt=0.5)\n.save v(g0) v(g1) v(i) v(a) v(b) v(out)\n.tran 1u 0.7m uic\n.end\n");
  int found = 0;
  for (const auto& row : run.rows) {
    if (row[1] > 0.0 || row[2] > 0.0) continue;
    ++found;
    INFO("t = " << row[0]);
    CHECK(2.0 * row[3] - 2.0 * (row[4] + row[5]) + row[6] == Approx(0.0).margin(1e-9));
  }
  CHECK(found > 50);
}

// a1 joins a capacitor and diodes that block: at rest it may be anywhere between the drop of D1 below ground and that of D2 above b1. A leak decides it.
TEST_CASE("segments tell where a floating capacitor leaves the operating point open", "[regression]") {
  const auto is_open = [](const std::string& leak) {
    const auto run = segments_to_end(
        "t\nV1 a0 0 -145\nC1 a0 a1 98.5n\nD1 0 a1 DI\nD2 a1 b1 DI\nC2 b1 0 98.5n\nV2 s 0 37\nR2 s b1 1k\n.model DI D(Ron=0.01 Vfwd=0.7)\n" +
        leak + ".save v(a1) v(b1)\n.tran 1u 10u\n.end\n");
    return remark_of(run, "W-op-not-unique") != nullptr;
  };
  CHECK(is_open(""));
  CHECK_FALSE(is_open("R1 a1 0 1G\n"));
}
