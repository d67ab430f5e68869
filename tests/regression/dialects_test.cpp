/// Decks as LTspice, PSpice and ngspice users write them (tests/decks), unmodified, against closed forms.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "regression/deck_run.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

using std::numbers::pi;

DeckRun run_dialect(const std::string& name) {
  DeckRun run = run_deck(std::string(PWLSIM_SOURCE_DIR "/tests/decks/") + name);
  INFO(run.messages << run.answer.message);
  REQUIRE(run.messages.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  return run;
}

std::size_t column(const DeckRun& run, const std::string& name) {
  const auto found = std::find(run.signals.begin(), run.signals.end(), name);
  REQUIRE(found != run.signals.end());
  return static_cast<std::size_t>(found - run.signals.begin()) + 1;
}

void check(const DeckRun& run, const std::string& name, double margin, const std::function<double(double)>& expected) {
  const std::size_t k = column(run, name);
  for (const auto& row : run.rows) {
    INFO(name << " at t = " << row[0]);
    CHECK(row[k] == Approx(expected(row[0])).margin(margin));
  }
}

}  // namespace

TEST_CASE("LTspice: a chopper of its own transistor and Schottky models", "[regression]") {
  const DeckRun run = run_dialect("ltspice_chopper.net");
  // tau = 1 ms; towards 10 A while on, towards -Vfwd/R = -0.5 A while off. The edges of 1 ps shift events by 0.7 ps.
  const auto current = [](double t) {
    double i = 0.0;
    for (double start = 0.0;; start += 1.0) {
      if (t < start + 0.5) return 10.0 + (i - 10.0) * std::exp(start - t);
      i = 10.0 + (i - 10.0) * std::exp(-0.5);
      if (t < start + 1.0) return -0.5 + (i + 0.5) * std::exp(start + 0.5 - t);
      i = -0.5 + (i + 0.5) * std::exp(-0.5);
    }
  };
  const auto is_edge = [](double t) { return std::abs(std::remainder(t, 0.5e-3)) < 1e-9; };
  check(run, "I(L1)", 1e-7, [&](double t) { return current(1e3 * t); });
  const std::size_t drain = column(run, "Id(M1)"), coil = column(run, "I(L1)");
  for (const auto& row : run.rows)
    if (!is_edge(row[0])) CHECK(row[drain] == Approx(std::fmod(1e3 * row[0], 1.0) < 0.5 ? row[coil] : 0.0).margin(1e-10));
}

TEST_CASE("LTspice: its opamp with Aol and GBW, nodes in its order", "[regression]") {
  const DeckRun run = run_dialect("ltspice_follower.net");
  const double gain = 1e3, rate = 2.0 * pi * 1e6;
  check(run, "V(out)", 1e-11, [&](double t) { return gain / (1.0 + gain) * (1.0 - std::exp(-rate * (1.0 + gain) / gain * t)); });
}

TEST_CASE("PSpice: what OrCAD's Capture writes", "[regression]") {
  const DeckRun run = run_dialect("orcad_switch.net");
  // 1 uF from 2 V beside 1 Mohm; from 1 ms on towards 10 V behind 500 ohm times 2 and 1 mohm.
  const double leak = 1e6, series = 1000.001, target = 10.0 * leak / (leak + series), tau = 1e-6 / (1.0 / leak + 1.0 / series);
  const double off = 1.0 / (1.0 / leak + 1.0 / 1e9), floor = 10.0 * leak / (leak + 1e9);
  const double before = floor + (2.0 - floor) * std::exp(-1e-3 / (off * 1e-6));
  check(run, "v(N3)", 1e-5, [&](double t) {
    if (t <= 1e-3) return floor + (2.0 - floor) * std::exp(-t / (off * 1e-6));
    return target + (before - target) * std::exp(-(t - 1e-3) / tau);
  });
}

TEST_CASE("ngspice: a deck that a control block runs", "[regression]") {
  const DeckRun run = run_dialect("ngspice_rectifier.net");
  const auto out = [](double t) { return std::max(0.0, 10.0 * std::sin(2.0 * pi * 50.0 * t) - 0.7); };
  CHECK(run.rows.size() == 401);
  check(run, "v(out)", 1e-11, out);
  check(run, "@r1[i]", 1e-13, [&](double t) { return out(t) / 100.0; });
  check(run, "@d1[id]", 1e-13, [&](double t) { return out(t) / 100.0; });
}

// The truth tables.
TEST_CASE("LTspice: each gate with every combination of its inputs", "[regression]") {
  struct Gate {
    std::string card;
    bool (*value)(bool a, bool b, bool c);
  };
  const auto gate = GENERATE(Gate{"A1 a b c 0 0 0 y 0 AND", [](bool a, bool b, bool c) { return a && b && c; }},
                             Gate{"A1 a b 0 0 c y 0 0 AND", [](bool a, bool b, bool c) { return !(a && b && c); }},
                             Gate{"A1 a b c 0 0 0 y 0 OR", [](bool a, bool b, bool c) { return a || b || c; }},
                             Gate{"A1 0 b c 0 0 y 0 0 OR", [](bool, bool b, bool c) { return !(b || c); }},
                             Gate{"A1 a c 0 0 0 0 y 0 XOR", [](bool a, bool, bool c) { return a != c; }},
                             Gate{"A1 a b c 0 0 0 y 0 XOR", [](bool a, bool b, bool c) { return a + b + c == 1; }},
                             Gate{"A1 b 0 0 0 0 0 y 0 BUF", [](bool, bool b, bool) { return b; }},
                             Gate{"A1 b 0 0 0 0 y 0 0 BUF", [](bool, bool b, bool) { return !b; }},
                             Gate{"A1 b 0 0 0 0 0 y 0 INV", [](bool, bool b, bool) { return !b; }},
                             Gate{"A1 b 0 0 0 0 y 0 0 INV", [](bool, bool b, bool) { return !b; }},
                             Gate{"A1 b 0 0 0 0 0 y 0 SCHMITT Vt=0.9", [](bool, bool b, bool) { return b; }},
                             Gate{"A1 b c 0 0 0 0 y 0 SCHMITT", [](bool, bool b, bool c) { return b && !c; }});
  INFO(gate.card);
  for (int inputs = 0; inputs < 8; ++inputs) {
    const bool a = (inputs & 1) != 0, b = (inputs & 2) != 0, c = (inputs & 4) != 0;
    const std::string sources = fmt::format("t\nVa a 0 {:d}\nVb b 0 {:d}\nVc c 0 {:d}\n.tran 1 1\n", a, b, c);
    for (const DeckRun& run :
         {run_text(sources + gate.card + "\n.save v(y)\n"), run_text_sparse(sources + gate.card + "\n.save v(y)\n", 1e-6)}) {
      INFO(run.messages << run.answer.message);
      REQUIRE(run.rows.size() == 2);
      CHECK(run.rows.back()[1] == (gate.value(a, b, c) ? 1.0 : 0.0));
    }
  }
}

// A 3 V ramp over 3 s against a common at 10 V: above the middle of the levels, 1 V, from 2 s on.
TEST_CASE("LTspice: a gate's levels, its threshold between them, and its common", "[regression]") {
  const std::string deck =
      "t\nVc c 0 10\nVr r c PWL(0 -1 3 2)\nA1 r 0 c c c n q c AND Vhigh=5 Vlow=-3\nA2 r c c c c c l c BUF Ref=0.5 Vhigh={2*2}\n.tran 0.3 "
      "3\n"
      ".save v(q,c) v(n,c) v(l,c)\n";
  // The node 0 is no common here: an input at -10 V, which is low.
  const DeckRun run = run_text(deck);
  INFO(run.messages);
  REQUIRE(run.rows.size() == 11);
  check(run, "v(q,c)", 1e-12, [](double) { return -3.0; });
  check(run, "v(n,c)", 1e-12, [](double) { return 5.0; });
  check(run, "v(l,c)", 1e-12, [](double t) { return t >= 1.5 ? 4.0 : 0.0; });
}

// Set at 1 s, held from 1.5 s, reset at 2 s, held from 2.5 s; at 4 s both inputs rise, and reset wins.
TEST_CASE("LTspice: the SR flip-flop remembers", "[regression]") {
  const std::string deck =
      "t\nVs s 0 PULSE(0 1 1 0 0 0.5 3)\nVr r 0 PULSE(0 1 2 0 0 0.5 2)\nA1 s r 0 0 0 n q 0 SRFLOP\n.tran 0.25 4.75\n.save v(q) v(n)\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages);
    REQUIRE(run.rows.size() == 20);
    check(run, "v(q)", 1e-12, [](double t) { return t >= 1.0 && t < 2.0 ? 1.0 : 0.0; });
    check(run, "v(n)", 1e-12, [](double t) { return t >= 1.0 && t < 2.0 ? 0.0 : 1.0; });
  }
}

// The clock rises at 1, 3, 5, 7 s. D is high from 0.5 to 3 s, where it falls with the clock: the high before is taken. Preset from 6 to 6.5 s, clear from 8.5 to 8.75 s.
TEST_CASE("LTspice: the D flip-flop takes what is there before the edge", "[regression]") {
  const std::string deck =
      "t\nVd d 0 PULSE(0 1 0.5 0 0 2.5)\nVk k 0 PULSE(0 1 1 0 0 1 2)\nVp p 0 PULSE(0 1 6 0 0 0.5)\nVc c 0 PULSE(0 1 8.5 0 0 0.25)\n"
      "A1 d 0 k p c 0 q 0 DFLOP\nA2 half 0 k 0 0 half by2 0 DFLOP\n.tran 0.125 9\n.save v(q) v(by2)\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages);
    REQUIRE(run.rows.size() == 73);
    check(run, "v(q)", 1e-12, [](double t) { return (t >= 1.0 && t < 5.0) || (t >= 6.0 && t < 7.0) ? 1.0 : 0.0; });
    check(run, "v(by2)", 1e-12, [](double t) { return std::fmod(t, 4.0) >= 1.0 && std::fmod(t, 4.0) < 3.0 ? 1.0 : 0.0; });
  }
}

// Every edge comes 0.5 s later, those of pulses that are shorter too; and the output of a second one as well.
TEST_CASE("LTspice: a gate's delay", "[regression]") {
  const std::string deck =
      "t\nVa a 0 PWL(0 0 1 0 1 1 3 1 3 0 4 0 4 1 4.25 1 4.25 0)\nA1 a 0 0 0 0 0 y 0 BUF Td=0.5\nA2 y 0 0 0 0 n 0 0 BUF Td={1/4} Vhigh=5 "
      "Ref=0.5\nA3 y 0 0 0 0 0 z 0 BUF Td={0*2}\n"
      ".tran 0.1 6\n.save v(y) v(n) v(z)\n";
  const auto is_high = [](double t) { return (t > 1.5 && t < 3.5) || (t > 4.5 && t < 4.75); };
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages);
    REQUIRE(run.rows.size() == 61);
    const auto is_edge = [](double t) { return std::abs(std::remainder(t, 0.25)) < 1e-6; };
    for (const auto& row : run.rows) {
      INFO("t = " << row[0]);
      if (is_edge(row[0])) continue;
      CHECK(row[1] == Approx(is_high(row[0]) ? 1.0 : 0.0).margin(1e-9));
      CHECK(row[2] == Approx(is_high(row[0] - 0.25) ? 0.0 : 5.0).margin(1e-9));
      CHECK(row[3] == Approx(row[1]).margin(1e-9));
    }
  }
}

// An edge goes twice round the ring of 10, 10 and 12 ns in a period. It starts when the gate lets it.
TEST_CASE("LTspice: a ring of inverters oscillates", "[regression]") {
  const std::string deck =
      "t\nVe e 0 PULSE(0 1 100n)\nA1 e a 0 0 0 b 0 0 AND Td=10n\nA2 b 0 0 0 0 0 c 0 INV Td=10n\nA3 c 0 0 0 0 0 a 0 INV Td=12n\n"
      ".tran 1n 700n\n.save v(a)\n";
  for (const DeckRun& run : {run_text(deck, true), run_text_sparse(deck, 1e-6, true)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    std::vector<double> rises;
    for (std::size_t k = 1; k < run.rows.size(); ++k)
      if (run.rows[k - 1][1] < 0.5 && run.rows[k][1] > 0.5) rises.push_back(run.rows[k][0]);
    REQUIRE(rises.size() > 6);
    CHECK(rises[rises.size() - 1] - rises[rises.size() - 2] == Approx(64e-9).epsilon(1e-9));
  }
}

// Thirty inverters answer in the instant of the clock, and so do eight flip-flops, each of which halves the one before: rises at 1, 3, 5 … s.
TEST_CASE("LTspice: a long chain of gates, and a ripple counter", "[regression]") {
  std::string deck = "t\nVk k 0 PULSE(0 1 1 0 0 1 2)\n", saved = ".save v(c29)";
  for (int i = 0; i < 30; ++i) deck += fmt::format("Ai{0} {1} 0 0 0 0 0 c{0} 0 INV\n", i, i == 0 ? "k" : fmt::format("c{}", i - 1));
  for (int i = 0; i < 8; ++i) {
    deck += fmt::format("Ad{0} n{0} 0 {1} 0 0 n{0} q{0} 0 DFLOP\n", i, i == 0 ? "k" : fmt::format("n{}", i - 1));
    saved += fmt::format(" v(q{})", i);
  }
  deck += ".tran 1 600\n" + saved + "\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.rows.size() == 601);
    for (const auto& row : run.rows) {
      INFO("t = " << row[0]);
      CHECK(row[1] == Approx(std::fmod(row[0], 2.0)).margin(1e-9));
      int count = 0;
      for (int i = 0; i < 8; ++i) count += row[static_cast<std::size_t>(2 + i)] > 0.5 ? 1 << i : 0;
      CHECK(count == static_cast<int>((row[0] + 1.0) / 2.0) % 256);
    }
  }
}

// Twenty of them leave a high input high. Without uic the run starts at rest: nothing moves.
TEST_CASE("LTspice: a chain of delayed gates is at rest at the start", "[regression]") {
  std::string deck = "t\nV1 c0 0 1\n";
  for (int i = 0; i < 20; ++i) deck += fmt::format("A{0} c{0} 0 0 0 0 0 c{1} 0 INV Td=10n\n", i, i + 1);
  deck += ".tran 100n 400n\n.save v(c19) v(c20)\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.rows.size() == 5);
    CHECK(run.answer.remarks.empty() == (run.answer.statistics.klu_solves == 0));  // the sparse engine says that it does not examine
    check(run, "v(c19)", 1e-9, [](double) { return 0.0; });
    check(run, "v(c20)", 1e-9, [](double) { return 1.0; });
  }
}

TEST_CASE("a block of XSPICE may have a model named like a gate of LTspice", "[regression]") {
  const DeckRun run = run_text("t\nV1 a 0 3\nA1 %vd a 0 %vd o 0 inv\n.model inv gain(gain=-1)\n.tran 1 1\n.save v(o)\n");
  REQUIRE(run.messages.empty());
  CHECK(run.rows.back()[1] == Approx(-3.0));
}

// 1 A has no way but through the switch, which its own source closes: 10 V across 10 ohm.
TEST_CASE("the operating point is found through a position that has none", "[regression]") {
  const std::string deck = "t\nI1 0 a 1\nS1 a b c 0 SX\n.model SX SW(Vt=0.5)\nR1 b 0 10\nC1 a 0 1u\nVc c 0 1\n.tran 1u 4u\n.save v(a)\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.rows.size() == 5);
    check(run, "v(a)", 1e-6, [](double) { return 10.0; });
  }
}

TEST_CASE("LTspice: what lies within a gate is not saved by default", "[regression]") {
  const std::string deck = "t\nV1 a 0 5\nA1 a 0 0 0 0 0 y 0 BUF Vhigh=5\n.tran 1 1\n";
  CHECK(run_text(deck).signals == std::vector<std::string>{"v(a)", "v(y)", "i(V1)"});
}

// 1 ohm beyond 1 V up to 4 A, 1 ohm beyond -5 V down to -2 A, and 1 kohm; two of them in parallel.
TEST_CASE("LTspice: a diode's limits of current", "[regression]") {
  const std::string deck =
      "t\nV1 a 0 PWL(0 -10 20 10)\nD1 a 0 DL m=2\n.model DL D(Ron=1 Vfwd=1 Ilimit=4 Vrev=5 Rrev=1 Revilimit=2 Roff=1k)\n.tran 0.25 "
      "20\n.save i(D1)\n";
  for (const DeckRun& run : {run_text(deck), run_text_sparse(deck, 1e-6)}) {
    INFO(run.messages);
    REQUIRE(run.rows.size() == 81);
    // Ron and Rrev are those of the whole characteristic, whose slopes hold 1/Roff: contacts of 1/(1 - 1/1000) ohm.
    check(run, "i(D1)", 1e-9, [](double t) {
      const double v = t - 10.0, contact = 1.0 - 1e-3;
      return 2.0 * (v / 1e3 + std::clamp(contact * (v - 1.0), 0.0, 4.0) - std::clamp(contact * (-v - 5.0), 0.0, 2.0));
    });
  }
}

// Between a third and two thirds of 10 V: up through 6 kohm, down through 4 kohm towards the divider of 2 kohm and the contact's 10 ohm.
TEST_CASE("LTspice: a timer of its own comparators and flip-flop", "[regression]") {
  const DeckRun run = run_dialect("ltspice_555.net");
  const double up = 6e3 * 100e-9, low = 10.0 * 10.0 / 2010.0, down = (4e3 + 2e3 * 10.0 / 2010.0) * 100e-9;
  const double first = up * std::log(3.0), fall = down * std::log((20.0 / 3.0 - low) / (10.0 / 3.0 - low)), rise = up * std::log(2.0);
  // The contacts' 1 Gohm takes 2e-6 of the current, which adds up to 2e-7 s.
  check(run, "V(cap)", 3e-4, [&](double t) {
    if (t < first) return 10.0 * (1.0 - std::exp(-t / up));
    t = std::fmod(t - first, fall + rise);
    if (t < fall) return low + (20.0 / 3.0 - low) * std::exp(-t / down);
    return 10.0 - 20.0 / 3.0 * std::exp(-(t - fall) / up);
  });
}

// Each period of 10 us the clock closes the switch 0.2 us late; at 3 A the comparator opens it, 0.2 us late as well. 0.8 A/us up, 0.4 A/us down.
TEST_CASE("LTspice: a converter in current mode, with its flip-flop and a delay", "[regression]") {
  const DeckRun run = run_dialect("ltspice_current_mode.net");
  check(run, "I(L1)", 1e-7, [](double t) {
    double begin = 1.2, valley = 0.0, peak = 0.0, open = 0.0;
    const double at = 1e6 * t;
    while (at >= begin) {
      open = begin + (3.0 - valley) / 0.8 + 0.2;
      if (at <= open) return valley + 0.8 * (at - begin);
      peak = valley + 0.8 * (open - begin);
      begin += 10.0;
      valley = peak - 0.4 * (begin - open);
    }
    return open > 0.0 ? peak - 0.4 * (at - open) : 0.0;
  });
}

// LTspice writes .ic for nodes that sources hold. v(c) falls from 5 V by 1 Ω and 1 F towards the source's 2 V.
TEST_CASE(".ic of a node that sources hold at that value says nothing new", "[regression]") {
  const std::string cards = "t\nV1 a 0 PULSE(2 9 5)\nV2 b a 1\nR1 a c 1\nC1 c 0 1\n.tran 0.5 1\n.save v(c) v(b)\n";
  const std::string given = ".ic v(a)=2 v(b)=3 v(c)=5 v(B)=3\n";
  for (const DeckRun& run : {run_text(cards + given), run_text_sparse(cards + given, 1e-6)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    check(run, "v(c)", 1e-5, [](double t) { return 2.0 + 3.0 * std::exp(-t); });
  }
  for (const std::string wrong : {".ic v(a)=2.1\n", ".ic v(b)=2\n", ".ic v(a)=9\n"})
    CHECK(run_text(cards + wrong).answer.id == "E-ic-contradiction");
}

// 0.1 + 0.2 − 0.3 is 5.6e-17 in doubles: rounding of the sources, and no potential. v(d) falls from 5 V to it by 1 Ω and 1 F.
TEST_CASE(".ic of zero agrees with sources in series that cancel to rounding", "[regression]") {
  const std::string cards = "t\nV1 a 0 0.1\nV2 b a 0.2\nV3 c b -0.3\nR1 c d 1\nC1 d 0 1\n.tran 0.5 1\n.save v(d)\n.ic v(d)=5\n";
  const std::string given = ".ic v(c)=0\n", wrong = ".ic v(c)=1e-9\n";
  for (const DeckRun& run : {run_text(cards + given), run_text_sparse(cards + given, 1e-6)}) {
    INFO(run.messages << run.answer.message);
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    check(run, "v(d)", 1e-5, [](double t) { return 5.0 * std::exp(-t); });
  }
  for (const DeckRun& run : {run_text(cards + wrong), run_text_sparse(cards + wrong, 1e-6)}) CHECK(run.answer.id == "E-ic-contradiction");
}

// The source's 1 V charges the capacitor that ic=0 says is empty.
TEST_CASE("an initial value of zero that was given and contradicts the circuit is told", "[regression]") {
  const auto told = [](const std::string& initial) {
    const DeckRun run = run_text("t\nV1 a 0 1\nC1 a b 1\nC2 b 0 1 " + initial + "\n.tran 1 1 uic\n.save v(b)\n");
    REQUIRE(run.rows.size() == 2);
    CHECK(run.rows[0][1] == Approx(0.5));
    return std::any_of(run.answer.remarks.begin(), run.answer.remarks.end(), [](const auto& r) { return r.id == "W-start-projected"; });
  };
  CHECK(told("ic=0"));
  CHECK_FALSE(told(""));
}
