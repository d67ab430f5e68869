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

constexpr double pi = std::numbers::pi;

DeckRun deck(const std::string& name) {
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
  const DeckRun run = deck("ltspice_chopper.net");
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
  const DeckRun run = deck("ltspice_follower.net");
  const double gain = 1e3, rate = 2.0 * pi * 1e6;
  check(run, "V(out)", 1e-11, [&](double t) { return gain / (1.0 + gain) * (1.0 - std::exp(-rate * (1.0 + gain) / gain * t)); });
}

TEST_CASE("PSpice: what OrCAD's Capture writes", "[regression]") {
  const DeckRun run = deck("orcad_switch.net");
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
  const DeckRun run = deck("ngspice_rectifier.net");
  const auto out = [](double t) { return std::max(0.0, 10.0 * std::sin(2.0 * pi * 50.0 * t) - 0.7); };
  CHECK(run.rows.size() == 401);
  check(run, "v(out)", 1e-11, out);
  check(run, "@r1[i]", 1e-13, [&](double t) { return out(t) / 100.0; });
  check(run, "@d1[id]", 1e-13, [&](double t) { return out(t) / 100.0; });
}

// The truth tables of the gates: the card that the message gives in their place is run with every combination of inputs.
TEST_CASE("what the message gives in place of a gate of LTspice is that gate", "[regression]") {
  struct Gate {
    std::string card;
    bool (*value)(bool a, bool b, bool c);
  };
  const auto gate = GENERATE(Gate{"A1 a b c 0 0 0 y 0 AND", [](bool a, bool b, bool c) { return a && b && c; }},
                             Gate{"A1 a b 0 0 c y 0 0 AND", [](bool a, bool b, bool c) { return !(a && b && c); }},
                             Gate{"A1 a b c 0 0 0 y 0 OR", [](bool a, bool b, bool c) { return a || b || c; }},
                             Gate{"A1 0 b c 0 0 y 0 0 OR", [](bool, bool b, bool c) { return !(b || c); }},
                             Gate{"A1 a c 0 0 0 0 y 0 XOR", [](bool a, bool, bool c) { return a != c; }},
                             Gate{"A1 b 0 0 0 0 0 y 0 BUF", [](bool, bool b, bool) { return b; }},
                             Gate{"A1 b 0 0 0 0 0 y 0 INV", [](bool, bool b, bool) { return !b; }},
                             Gate{"A1 b 0 0 0 0 y 0 0 INV", [](bool, bool b, bool) { return b; }});
  INFO(gate.card);
  for (int inputs = 0; inputs < 8; ++inputs) {
    const bool a = (inputs & 1) != 0, b = (inputs & 2) != 0, c = (inputs & 4) != 0;
    const std::string sources = fmt::format("t\nVa a 0 {:d}\nVb b 0 {:d}\nVc c 0 {:d}\n.tran 1 1\n", a, b, c);
    const std::string told = run_text(sources + gate.card + "\n").messages;
    const std::size_t at = told.find("B1 y 0 V={");
    REQUIRE(at != std::string::npos);
    const DeckRun run = run_text(sources + told.substr(at, told.find('\n', at) - at) + "\n.save v(y)\n");
    REQUIRE(run.messages.empty());
    CHECK(run.rows.back()[1] == (gate.value(a, b, c) ? 1.0 : 0.0));
  }
}

// Set at 1 s, held from 1.5 s, reset at 2 s, held from 2.5 s.
TEST_CASE("what the message gives in place of LTspice's SR flip-flop remembers", "[regression]") {
  const std::string sources = "t\nVs s 0 PULSE(0 1 1 0 0 0.5 9)\nVr r 0 PULSE(0 1 2 0 0 0.5 9)\nVh high 0 1\nRq q 0 1k\n.tran 0.25 3\n";
  const std::string told = run_text(sources + "A1 s r 0 0 0 0 q 0 SRFLOP\n").messages;
  const std::size_t at = told.find("S1 high q s r latch"), model = told.find(".model latch"), end = told.find(')', model);
  REQUIRE(at != std::string::npos);
  REQUIRE(end != std::string::npos);
  const DeckRun run = run_text(sources + "S1 high q s r latch\n" + told.substr(model, end + 1 - model) + "\n.save v(q)\n");
  REQUIRE(run.messages.empty());
  for (const auto& row : run.rows) {
    INFO("t = " << row[0]);
    CHECK(row[1] == Approx(row[0] >= 1.0 && row[0] < 2.0 ? 1.0 : 0.0).margin(1e-15));
  }
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
