#include <catch2/catch.hpp>

#include "circuit/assemble.hpp"
#include "deck.hpp"

using namespace pwlsim;
using model::Term;
using test::compile_deck;
using test::named;

namespace {

const model::LinearForm& signal(const model::Network& network, const std::string& column) {
  for (const model::Signal& one : network.signals) {
    if (one.name == column) return one.form;
  }
  throw std::runtime_error("no column " + column);
}

double coefficient(const model::LinearForm& form, Term::Kind kind, int index) {
  double sum = 0.0;
  for (const Term& term : form) {
    if (term.kind == kind && (kind == Term::Kind::one || term.index == index)) sum += term.coefficient;
  }
  return sum;
}

}  // namespace

TEST_CASE("without .save every node voltage and then every current of L V E H D S are columns", "[unit]") {
  const auto deck = compile_deck(R"(V1 In 0 1
R1 in Out 1
C1 out 0 1u
Lx out 0 1m
D1 out 0 DI
E1 e 0 out 0 1
G1 e 0 out 0 1
F1 e 0 V1 1
H1 h 0 V1 1
S1 out 0 in 0 SX
W1 out 0 V1 WX
.model DI D
.model SX SW
.model WX CSW
.tran 1m
)");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  CHECK(test::columns(deck.network()) ==
        std::vector<std::string>{"v(In)", "v(Out)", "v(e)", "v(h)", "i(V1)", "i(Lx)", "i(D1)", "i(E1)", "i(H1)", "i(S1)"});
}

TEST_CASE("saved signals are spelled as in the deck and each stands once", "[unit]") {
  const auto deck = compile_deck(R"(V1 a 0 1
X1 a b s
R9 b 0 1
.subckt s p q
R1 p n 1
R2 n q 1
.ends
.save V(a) v(A) v(a,b) v( x1:N ) I(r9) i(x1.R1)
.print tran v(x1.n) time i(V1)
.probe v(b)
.tran 1m
)");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  CHECK(test::columns(deck.network()) == std::vector<std::string>{"V(a)", "v(a,b)", "v( x1:N )", "I(r9)", "i(x1.R1)", "i(V1)", "v(b)"});
  const model::LinearForm& difference = signal(deck.network(), "v(a,b)");
  CHECK(coefficient(difference, Term::Kind::node_voltage, test::node_named(deck.network(), "a")) == 1.0);
  CHECK(coefficient(difference, Term::Kind::node_voltage, test::node_named(deck.network(), "b")) == -1.0);
}

TEST_CASE("the current of any element may be saved", "[unit]") {
  const auto deck = compile_deck(R"(V1 a 0 1
R1 a 0 2 Rpar=4 Cpar=1u
I1 a 0 3
G1 a 0 a 0 5
F1 a 0 V1 7
F2 a 0 POLY(2) V1 I1 11 0.5 0.25
.save i(R1) i(I1) i(G1) i(F1) i(F2)
.tran 1m
)");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  const model::Network& network = deck.network();
  CHECK(signal(network, "i(R1)").size() == 3);  // the resistor, Rpar, Cpar
  CHECK(coefficient(signal(network, "i(I1)"), Term::Kind::source, 1) == 1.0);
  CHECK(coefficient(signal(network, "i(G1)"), Term::Kind::node_voltage, 0) == 5.0);
  CHECK(coefficient(signal(network, "i(F1)"), Term::Kind::branch_current, 0) == 7.0);
  CHECK(coefficient(signal(network, "i(F2)"), Term::Kind::one, 0) == 11.0);
  CHECK(coefficient(signal(network, "i(F2)"), Term::Kind::branch_current, 0) == 0.5);
  CHECK(coefficient(signal(network, "i(F2)"), Term::Kind::source, 1) == 0.25);
}

TEST_CASE("initial conditions reach the network", "[unit]") {
  const auto deck = compile_deck(R"(V1 a 0 1
L1 a b 1m
C1 b 0 1u ic=5
X1 b s
.subckt s p
R1 p n 1
R2 n 0 1
.ic v(n)=2 v(p)=3
.ends
.ic I(l1)=4
.tran 1m uic
)");
  INFO(deck.messages());
  REQUIRE(deck.compiled.has_value());
  const model::Network& network = deck.network();
  REQUIRE(network.node_conditions.size() == 2);
  CHECK(network.node_conditions[0].node == test::node_named(network, "X1.n"));
  CHECK(network.node_conditions[0].voltage == 2.0);
  CHECK(network.node_conditions[1].node == test::node_named(network, "b"));
  CHECK(network.node_conditions[1].voltage == 3.0);
  REQUIRE(network.current_conditions.size() == 1);
  CHECK(network.current_conditions[0].inductor == 0);
  CHECK(network.inductors[0].has_initial);
  CHECK(network.inductors[0].initial_current == 4.0);
  CHECK(network.capacitors[0].has_initial);
  CHECK(network.capacitors[0].initial_voltage == 5.0);
  CHECK(deck.diagnostics.all().empty());
}

TEST_CASE("a transformer secondary that only the coupling holds is floating", "[unit]") {
  const std::string cards = "V1 a 0 1\nL1 a 0 1m\nL2 s t 1m\nR1 s t 1\nK1 L1 L2 1\n.tran 1m\n";
  CHECK(compile_deck(cards).count("E-floating") == 1);
  CHECK(compile_deck(cards + "R2 t 0 1Meg\n").compiled.has_value());
}

TEST_CASE("what is missing hides whether something floats", "[unit]") {
  CHECK(compile_deck("V1 a 0 1\nR1 b c 1\nM1 b 0 0 0 NM\n.tran 1m\n").count("E-floating") == 0);
  CHECK(compile_deck("V1 a 0 1\nR1 b c 1\nR2 a 0 {1/0}\n.tran 1m\n").count("E-floating") == 1);
}

TEST_CASE("a circuit can be built without a deck", "[unit]") {
  circuit::FlatCircuit circuit;
  circuit.add("V1", {"in", "0"}).waveform = model::Dc{10.0};
  circuit.add("R1", {"in", "out"}).values.set("R", 1e3);
  const int ideal = circuit.add_model("D", "DI");
  circuit.add("D1", {"out", "gnd"}).model = ideal;
  circuit.saves.push_back({circuit::SaveRequest::Kind::current, "i(D1)", "d1", "", {}, {}});
  Diagnostics diagnostics;
  const auto network = circuit::assemble(circuit, diagnostics);
  REQUIRE(network.has_value());
  CHECK(network->nodes.size() == 2);
  CHECK(network->resistors[0].resistance == 1e3);
  CHECK(std::get<model::Dc>(network->sources[0].function).value == 10.0);
  CHECK(network->signals.size() == 1);

  circuit.add("D2", {"out", "0"});
  CHECK_FALSE(circuit::assemble(circuit, diagnostics).has_value());
  REQUIRE(diagnostics.all().size() == 1);
  CHECK(diagnostics.all()[0].id == "E-incomplete");
}

TEST_CASE("signals of a picture stand behind those saved and before those measured; names that are none are passed over", "[unit]") {
  const std::string cards =
      "V1 In 0 1\nR1 in 0 1\nX1 in sub\n.subckt sub a\nR2 a b 1\nK1 L1 L2 1\nL1 b 0 1\nL2 b 0 1\n.ends\n.save v(in)\n.tran 1 2\n.meas m "
      "AVG v(X1.b)\n";
  const circuit::DrawnNames drawn{{"in", "0", "nowhere", "x1.B", "X1.b"}, {"X1.R2", "R1", "X1.K1", "X1", "r1"}};
  const auto deck = compile_deck(cards, {.measure = true, .drawn = drawn});
  CHECK(deck.messages() == "");
  REQUIRE(deck.compiled);
  CHECK(test::columns(deck.network()) == std::vector<std::string>{"v(in)", "v(x1.B)", "i(X1.R2)", "i(R1)"});
  CHECK(deck.compiled->saved_signals() == 1);
  CHECK(deck.compiled->recorded_signals() == 4);
  // What is measured alone, as v(X1.b) is where nobody draws it, follows.
  const auto plain = compile_deck(cards, {.measure = true, .drawn = {{}, {"R1"}}});
  CHECK(test::columns(plain.network()) == std::vector<std::string>{"v(in)", "i(R1)", "v(X1.b)"});
  CHECK(plain.compiled->recorded_signals() == 2);
  const auto swept = compile_deck(cards + ".step param p list 1 2\n", {.measure = true, .drawn = drawn});
  CHECK(swept.compiled->recorded_signals() == 1);
}
