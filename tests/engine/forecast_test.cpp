/// What diodes do when switches change, from one step on another position's factor, where Kirchhoff's laws leave one answer.
#include <catch2/catch.hpp>
#include <string>
#include <utility>
#include <vector>

#include "engine/sparse/forecast.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using namespace pwlsim::engine::sparse;

namespace {

constexpr double shift_of_step = 1e6;  ///< 1/s: a microsecond

/// A point in one position, whose factor is there.
struct Standpoint {
  Standpoint(const model::Network& network, Position before, const std::vector<double>& states)
      : descriptor(network), factors(network, descriptor), sources(network), forecast(descriptor, factors, sources), on(std::move(before)) {
    factors.keep_digits();
    forecast.note_voltage(1e-6);
    std::vector<double> w, memory;
    sources.evaluate(0.0, w);
    std::vector<double> values = states;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (descriptor.states()[i].is_current) values[i] *= descriptor.r0();
    REQUIRE_FALSE(descriptor.unknowns_of_states(values, w, on, z, memory));  // no charge is left over
    REQUIRE(factors.at(shift_of_step, on) != nullptr);
  }
  /// The position that the forecast makes of this one, or "stays".
  [[nodiscard]] std::string after(Position changed) { return forecast.find(0.0, z, changed) ? text(changed) : "stays"; }
  [[nodiscard]] static std::string text(const Position& position) {
    std::string result;
    for (const char side : position) result += side != 0 ? '1' : '0';
    return result;
  }

  Descriptor descriptor;
  Factors factors;
  Sources sources;
  Forecast forecast;
  Position on;
  std::vector<double> z;
};

/// Ports: the diode, then the switch from the source, then one from the output through a resistor.
TestCircuit chopper() {
  TestCircuit c;
  c.v("in", "0", model::Dc{10.0});
  c.v("g", "0", model::Dc{0.0});
  c.d("0", "a");
  c.r("in", "i", 0.1);
  c.s("i", "a", "g", "0", 0.5);
  c.l("a", "o", 1e-3);
  c.r("o", "0", 1.0);
  c.s("o", "b", "g", "0", 0.5);
  c.r("b", "0", 5.0);
  return c;
}

}  // namespace

// A switch that opens leaves the inductor's 2 A to the diode; one that closes puts 10 V across it backwards.
TEST_CASE("the forecast of a chopper hands its inductor's current to the diode, and takes it back", "[unit]") {
  const TestCircuit c = chopper();
  CHECK(Standpoint(c.network(), {0, 1, 0}, {2.0}).after({0, 0, 0}) == "100");
  CHECK(Standpoint(c.network(), {1, 0, 0}, {2.0}).after({1, 1, 0}) == "010");
}

TEST_CASE("diodes that a switch does not concern stay in the forecast", "[unit]") {
  const TestCircuit c = chopper();
  CHECK(Standpoint(c.network(), {0, 1, 0}, {2.0}).after({0, 1, 1}) == "stays");
  CHECK(Standpoint(c.network(), {1, 0, 0}, {2.0}).after({1, 0, 1}) == "stays");
}

// A cell of a multilevel converter that is bypassed: the diode across the upper switch would short its capacitor (20 V).
TEST_CASE("the forecast of a cell that is bypassed blocks the diode that would short its capacitor", "[unit]") {
  TestCircuit c;
  c.v("g", "0", model::Dc{0.0});
  c.c("p", "n", 1e-3);
  c.s("p", "x", "g", "0", 0.5);
  c.s("x", "n", "g", "0", 0.5);
  c.d("x", "p");
  c.d("n", "x");
  c.l("x", "y", 1e-3);
  c.r("y", "n", 1.0);
  c.r("n", "0", 1.0);
  // The inductor's −3 A flow from x into the capacitor, through the upper diode and switch; then through the lower switch.
  const Position inserted{1, 0, 0, 0}, bypassed{1, 0, 0, 1};
  CHECK(Standpoint(c.network(), inserted, {20.0, -3.0}).after(bypassed) == "0001");
}
