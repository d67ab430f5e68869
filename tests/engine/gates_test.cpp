/// Switches of the sparse engine whose controls are polylines of time.
#include "engine/sparse/gates.hpp"

#include <catch2/catch.hpp>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using namespace pwlsim::engine::sparse;

namespace {

constexpr double edge_rounding = 1e-12;

model::Pulse triangle(double delay, double half_period) {
  model::Pulse p;
  p.pulsed = 1.0;
  p.delay = delay;
  p.rise = p.fall = half_period;
  p.width = 0.0;
  p.period = 2.0 * half_period;
  return p;
}

}  // namespace

// The triangle rises from 0 at delay to 1 a half period later: it passes 1/4 ± 1/8 at these parts of a half period, up and down.
TEST_CASE("a gate knows when its control passes its levels", "[unit]") {
  TestCircuit c;
  c.v("g", "0", triangle(3.0, 2.0));
  c.s("a", "0", "g", "0", 0.25, 0.125);
  c.r("a", "0", 1.0);
  c.save_v("a");
  model::Network network = with_controls_of_sources(c.network());
  for (const auto& term : network.switches[0].control) CHECK(term.kind == model::Term::Kind::source);
  std::vector<Gate> gates = take_gates(network);
  REQUIRE(gates.size() == 1);
  Gate& gate = gates.front();
  gate.begin(false, 12.0);
  CHECK_FALSE(gate.closed());
  for (const double expected : {3.0 + 0.375 * 2.0, 3.0 + 1.875 * 2.0, 3.0 + 2.375 * 2.0, 3.0 + 3.875 * 2.0}) {
    CHECK(gate.next() == Approx(expected).epsilon(edge_rounding));
    const bool closed = gate.closed();
    gate.pass();
    CHECK(gate.closed() != closed);
  }
  CHECK(gate.next() == Approx(3.0 + 4.375 * 2.0).epsilon(edge_rounding));
  gate.pass();
  CHECK(gate.next() == model::forever);  // the next one is beyond the end
}

// v(g) stands on v(h), which stands on 0.5 V: their sum passes 0.75 where the triangle passes a quarter.
TEST_CASE("a gate reads sources that stand on one another", "[unit]") {
  TestCircuit c;
  c.v("g", "h", triangle(3.0, 2.0));
  c.v("h", "0", model::Dc{0.5});
  c.s("a", "0", "g", "0", 0.75);
  c.s("b", "0", "g", "h", 0.25);
  c.r("a", "0", 1.0);
  c.r("b", "0", 1.0);
  c.save_v("a");
  model::Network network = with_controls_of_sources(c.network());
  CHECK(network.switches[1].control.size() == 1);  // v(h) cancels
  std::vector<Gate> gates = take_gates(network);
  REQUIRE(gates.size() == 2);
  for (Gate& gate : gates) {
    gate.begin(false, 12.0);
    CHECK(gate.next() == Approx(3.0 + 0.25 * 2.0).epsilon(edge_rounding));
  }
}

TEST_CASE("what a gate's control asks for at the start is taken there", "[unit]") {
  TestCircuit c;
  c.v("g", "0", model::Dc{1.0});
  c.s("a", "0", "g", "0", 0.5);
  c.save_v("a");
  model::Network network = with_controls_of_sources(c.network());
  Gate gate = take_gates(network).front();
  gate.begin(false, 1.0);
  CHECK(gate.closed());
  CHECK(gate.next() == model::forever);
}

// A sinusoid's passages are not found beforehand, a jump may be an event of its own, and a source that feeds the circuit keeps its corners.
TEST_CASE("sources that jump or bend make no gates, and those that feed the circuit stay as they are", "[unit]") {
  TestCircuit c;
  model::Pulse square = triangle(0.0, 1.0);
  square.rise = square.fall = 0.0;
  square.width = 1.0;
  c.v("sine", "0", sine());
  c.v("square", "0", square);
  c.v("feed", "0", triangle(0.0, 1.0));
  c.s("a", "0", "sine", "0", 0.5);
  c.s("a", "0", "square", "0", 0.5);
  c.s("a", "0", "feed", "0", 0.5);
  c.r("feed", "a", 1.0);
  c.save_v("a");
  model::Network network = with_controls_of_sources(c.network());
  CHECK(take_gates(network).size() == 1);
  CHECK(std::holds_alternative<model::Pulse>(network.sources[1].function));
  CHECK(std::holds_alternative<model::Pulse>(network.sources[2].function));
}
