#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "deck.hpp"

using namespace pwlsim;
using test::compile_deck;
using test::named;
using test::node_named;

TEST_CASE("subcircuits nest, with parameters, local models and definitions", "[unit]") {
  const auto deck = compile_deck(R"(V1 in 0 10
.param scale=2
X1 in mid divider rtop=3
X2 mid 0 DIVIDER
.subckt divider a b params: rtop=1k rbot={rtop*scale}
R1 a m {rtop}
X1 m b inner r={rbot}
.subckt inner p n r=7
R1 p n {r}
D1 p n DL
.model DL D(Vfwd={r})
.ends inner
.ends
.model DL D
.tran 1u 1m
.end
)");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  const model::Network& network = deck.network();
  // By hand: X1 gives rtop = 3, hence rbot = 3·scale = 6; X2 keeps 1000 and 2000; each inner model takes the r of its call.
  CHECK(named(network.resistors, "X1.R1").resistance == 3.0);
  CHECK(named(network.resistors, "X1.X1.R1").resistance == 6.0);
  CHECK(named(network.resistors, "X2.R1").resistance == 1000.0);
  CHECK(named(network.resistors, "X2.X1.R1").resistance == 2000.0);
  CHECK(named(network.diodes, "X1.X1.D1").drop == 6.0);
  CHECK(named(network.diodes, "X2.X1.D1").drop == 2000.0);
  CHECK(named(network.resistors, "X1.R1").p == node_named(network, "in"));
  CHECK(named(network.resistors, "X1.R1").n == node_named(network, "X1.m"));
  CHECK(named(network.resistors, "X2.X1.R1").n == model::ground);
  CHECK(test::columns(network) == std::vector<std::string>{"v(in)", "v(mid)", "v(X1.m)", "v(X2.m)", "i(V1)", "i(X1.X1.D1)", "i(X2.X1.D1)"});
}

// Rashid's textbook writes its thyristor as `.SUBCKT SCR 1 2 3 2`.
TEST_CASE("a port that stands twice in a subcircuit's list takes one node", "[unit]") {
  const auto deck = compile_deck("V1 a 0 1\nX1 a k 0 k s\nR2 k 0 1\n.subckt s 1 2 3 2\nR1 1 2 3\nR3 2 3 5\n.ends\n.tran 1m\n");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  CHECK(named(deck.network().resistors, "X1.R1").n == node_named(deck.network(), "k"));
  CHECK(named(deck.network().resistors, "X1.R3").p == node_named(deck.network(), "k"));
}

TEST_CASE("Xyce's global parameters and PSpice's ~ are read", "[unit]") {
  const auto deck = compile_deck("V1 a 0 1\n.global_param r={2+!0} s=~0\nR1 a 0 {r+s+~5}\n.tran 1m\n");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  CHECK(named(deck.network().resistors, "R1").resistance == 4.0);  // 2 + 1, and 1, and 0
}

TEST_CASE("a value of the call rules over .param in the body, and the outer parameters are seen from inside", "[unit]") {
  const auto deck = compile_deck(R"(V1 a 0 1
.param top=5
X1 a 0 s p=3
X2 a 0 s
.subckt s x y
.param p={top*2}
R1 x y {p}
.ends
.tran 1m
)");
  REQUIRE(deck.compiled.has_value());
  CHECK(named(deck.network().resistors, "X1.R1").resistance == 3.0);
  CHECK(named(deck.network().resistors, "X2.R1").resistance == 10.0);
}

// The example of LTspice's manual, and of its help on .params.
TEST_CASE("a call may give what the subcircuit reads and does not declare", "[unit]") {
  const auto deck = compile_deck(R"(X1 in out 0 divider top=9K bot=1K
V1 in 0 pulse(0 1 0 .5m .5m 0 1m)
.params x=y y=z z=1k*tan(pi/4+.1)
X2 in low 0 divider top=x bot=z
X3 in 0 outer p=3
.param p=7
.subckt divider A B C
R1 A B {top}
R2 B C {bot}
.ends divider
.subckt outer a b
.param q={2*p}
.subckt inner a b
R1 a b {q}
.ends
X1 a b inner
.ends
.tran 3m
)");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  CHECK(named(deck.network().resistors, "X1.R1").resistance == 9e3);
  CHECK(named(deck.network().resistors, "X1.R2").resistance == 1e3);
  CHECK(named(deck.network().resistors, "X2.R1").resistance == Approx(1e3 * std::tan(0.25 * std::numbers::pi + 0.1)).epsilon(1e-14));
  CHECK(named(deck.network().resistors, "X3.X1.R1").resistance == 6.0);
  // What it reads counts, not what it comes to read: a branch not taken, a default that is overruled, a model that nothing uses.
  const auto unread = compile_deck(R"(V1 a 0 1
X1 a 0 s sel=0 p=2 q=3 r=5 v=1
.subckt s a b sel=1 r={2*q}
.model d D(Ron={v})
R1 a b {if(sel>0, p, 5)}
R2 a b {r}
.ends
.tran 1m
)");
  INFO(unread.messages());
  REQUIRE(unread.compiled.has_value());
  CHECK(named(unread.network().resistors, "X1.R1").resistance == 5.0);
  CHECK(named(unread.network().resistors, "X1.R2").resistance == 5.0);
  const auto two = compile_deck("V1 a 0 1\nX1 a 0 s rtp=2 rtpp=3\n.subckt s a b rtop=1\nR1 a b {rtop}\n.ends\n.tran 1m\n");
  CHECK(two.count("E-unknown-parameter") == 2);
  CHECK(two.messages().find("'rtpp'; try 'rtop'") != std::string::npos);
  const auto wrong = compile_deck("V1 a 0 1\nX1 a 0 s rtp=2\n.subckt s a b rtop=1\nR1 a b {rtop}\n.ends\n.tran 1m\n");
  CHECK(wrong.count("E-unknown-parameter") == 1);
  CHECK(wrong.messages().find("has no parameter 'rtp'; try 'rtop'") != std::string::npos);
}

TEST_CASE("global nodes and ground are one everywhere, others are local to their call", "[unit]") {
  const auto deck = compile_deck(R"(.global VCC
V1 vcc 0 1
X1 s
X2 s
.subckt s
R1 vcc n 1
R2 n gnd 1
R3 n GND 1
R4 $g_b n 1
.ends
V2 $G_B 0 1
.tran 1m
)");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  const model::Network& network = deck.network();
  CHECK(network.nodes.size() == 4);
  CHECK(named(network.resistors, "X1.R4").p == named(network.branches, "V2").p);  // LTspice's help, "Label a node name"
  CHECK(named(network.resistors, "X1.R1").p == named(network.resistors, "X2.R1").p);
  CHECK(named(network.resistors, "X1.R1").n != named(network.resistors, "X2.R1").n);
  CHECK(named(network.resistors, "X1.R2").n == model::ground);
  CHECK(named(network.resistors, "X1.R3").n == model::ground);
}

TEST_CASE("a hundred levels of subcircuits are allowed and no more, also where definitions are shared", "[unit]") {
  const auto levels = [](int count) {
    std::string cards = fmt::format("V1 a 0 1\nX1 a 0 s{}\n.subckt s1 p q\nR1 p q 1\n.ends\n.tran 1m\n", count);
    for (int k = 2; k <= count; ++k) cards += fmt::format(".subckt s{} p q\nX1 p q s{}\n.ends\n", k, k - 1);
    return cards;
  };
  CHECK(compile_deck(levels(100)).compiled.has_value());
  CHECK(compile_deck(levels(101)).count("E-too-deep") == 1);
  CHECK(compile_deck(levels(1000) + ".options max_subcircuit_depth=1000\n").compiled.has_value());
  CHECK(compile_deck(levels(1001) + ".options max_subcircuit_depth=1000\n").count("E-too-deep") == 1);
  // Each call is shallow where it is counted first, but together they are deeper than allowed.
  CHECK(compile_deck(levels(100) + "X2 a 0 t\n.subckt t p q\nX1 p q s100\n.ends\n").count("E-too-deep") == 1);
}

TEST_CASE("exponential growth is found before anything is expanded", "[unit]") {
  std::string cards = "V1 a 0 1\nX1 a 0 s60\n.subckt s0 p q\nR1 p q 1\n.ends\n.tran 1m\n";
  for (int k = 1; k <= 60; ++k) cards += fmt::format(".subckt s{0} p q\nX1 p q s{1}\nX2 p q s{1}\n.ends\n", k, k - 1);
  CHECK(compile_deck(cards).count("E-too-many-elements") == 1);
}

TEST_CASE("what is never called need not be understood", "[unit]") {
  const auto deck = compile_deck(R"(V1 a 0 1
.subckt library_part a b
M1 a b 0 0 NM
.model NM NMOS(VTO=1)
.ends
.model QX NPN(BF=100)
.tran 1m
)");
  INFO(deck.messages());
  CHECK(deck.compiled.has_value());
  CHECK(deck.diagnostics.all().empty());
}

TEST_CASE("one mistake in a subcircuit is one message, however often it is called", "[unit]") {
  std::string cards = "V1 a 0 1\n.subckt s p q\nR1 p q {1/0}\nF1 p q Vx 1\n.ends\n.tran 1m\n";
  for (int k = 0; k < 50; ++k) cards += fmt::format("X{} a 0 s\n", k);
  const auto deck = compile_deck(cards);
  CHECK(deck.count("E-not-finite") == 1);
  CHECK(deck.count("E-unknown-element") == 1);
  CHECK(deck.diagnostics.all().size() == 2);
}

TEST_CASE("after a thousand errors the rest is not shown", "[unit]") {
  std::string cards = ".tran 1m\n";
  for (int k = 0; k < 1500; ++k) cards += fmt::format("R{} a 0\n", k);
  const auto deck = compile_deck(cards);
  CHECK(deck.count("E-missing-value") == 1000);
  CHECK(deck.count("E-too-many-errors") == 1);
}

TEST_CASE("both forms of .tran, and times as decimal text", "[unit]") {
  const auto transient = [](const std::string& card) {
    const auto deck = compile_deck("V1 a 0 1\n.param T=2m\n" + card + "\n");
    INFO(deck.messages());
    return deck.compiled.value().analyses.transient.value();
  };
  const auto full = transient(".tran 1u 5m 1m 10n UIC");
  CHECK(full.step.seconds == 1e-6);
  CHECK(full.stop.seconds == 5e-3);
  CHECK(full.start.seconds == 1e-3);
  CHECK(full.use_initial_conditions);
  CHECK(!full.step.decimal.empty());
  const auto brief = transient(".tran 5m");
  CHECK(brief.step.seconds == 0.0);
  CHECK(brief.stop.seconds == 5e-3);
  CHECK(brief.start.seconds == 0.0);
  CHECK(brief.start.decimal == "0");
  CHECK_FALSE(brief.use_initial_conditions);
  const auto zero = transient(".tran 0 {T*2} uic");
  CHECK(zero.step.seconds == 0.0);
  CHECK(zero.stop.seconds == 4e-3);
  CHECK(zero.stop.decimal.empty());
  CHECK(zero.use_initial_conditions);
}

TEST_CASE("the number of output rows has a limit that an option raises", "[unit]") {
  CHECK(compile_deck("V1 a 0 1\n.tran 1n 2\n").count("E-too-many-rows") == 1);
  CHECK(compile_deck("V1 a 0 1\n.tran 1n 2\n.options max_rows=1e10\n").compiled.has_value());
  CHECK(compile_deck("V1 a 0 1\n.tran 1n 0.9\n").compiled.has_value());
  // 1e-6/1e-9 is a little less than 1000, as numbers go.
  CHECK(compile_deck("V1 a 0 1\n.tran 1n 1u\n.options max_rows=1000\n").count("E-too-many-rows") == 1);
  CHECK(compile_deck("V1 a 0 1\n.tran 1n 1u\n.options max_rows=1001\n").compiled.has_value());
}

TEST_CASE("options of the run are handed on", "[unit]") {
  const auto deck = compile_deck("V1 a 0 1\n.op\n.options reltol=1e-6 nonunique=STAY method=gear\n");
  REQUIRE(deck.compiled.has_value());
  const circuit::Analyses& analyses = deck.compiled->analyses;
  CHECK(analyses.operating_point);
  CHECK_FALSE(analyses.transient.has_value());
  CHECK(analyses.relative_tolerance == 1e-6);
  CHECK(analyses.non_unique == circuit::NonUniqueChoice::stay);
}

TEST_CASE("a deck without an analysis is an error unless none is needed", "[unit]") {
  CHECK(compile_deck("V1 a 0 1\n").count("E-no-analysis") == 1);
  CHECK(compile_deck("V1 a 0 1\n", {false}).compiled.has_value());
}

TEST_CASE("a model of the deck rules over one of a library", "[unit]") {
  SourceStore sources;
  Diagnostics diagnostics;
  netlist::Deck deck = netlist::parse("main.net", "title\nV1 a 0 1\nD1 a 0 DX\n.model DX D(Vfwd=1)\n.tran 1m\n", sources, diagnostics);
  const netlist::Deck library = netlist::parse("lib.net", "title\n.model DX D(Vfwd=2)\n", sources, diagnostics);
  deck.cards.insert(deck.cards.begin(), library.cards.begin(), library.cards.end());
  const auto compiled = circuit::compile(deck, sources, diagnostics);
  REQUIRE(compiled.has_value());
  CHECK(named(compiled->network.diodes, "D1").drop == 1.0);
  REQUIRE(diagnostics.all().size() == 1);
  CHECK(diagnostics.all()[0].id == "W-second-model");
  CHECK(diagnostics.all()[0].span.file == deck.cards[0].span.file);
}
