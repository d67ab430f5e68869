#include <catch2/catch.hpp>

#include "model/builder.hpp"

using namespace pwlsim::model;

TEST_CASE("nodes are found without case and keep their first spelling", "[unit]") {
  NetworkBuilder builder;
  CHECK(builder.node("Out") == 0);
  CHECK(builder.node("in") == 1);
  CHECK(builder.node("OUT") == 0);
  CHECK(builder.node("0") == ground);
  CHECK(builder.node("GND") == ground);
  CHECK(builder.find_node("IN") == 1);
  CHECK_FALSE(builder.find_node("nowhere").has_value());
  CHECK(builder.find_node("gnd") == ground);
  CHECK(builder.inner_node({"R1 (Rser)", {}}) == 2);
  CHECK_FALSE(builder.find_node("R1 (Rser)").has_value());
  CHECK(builder.network().nodes[0].name == "Out");
}

TEST_CASE("every word of the vocabulary goes to its list", "[unit]") {
  NetworkBuilder builder;
  CHECK(builder.add(Resistor{{"R1", {}}, 0, ground, 5.0}) == 0);
  CHECK(builder.add(Resistor{{"R2", {}}, 0, ground, 6.0}) == 1);
  CHECK(builder.add(Switch{}) == 0);
  CHECK(builder.add(Signal{"v(a)", {}}) == 0);
  const Network network = builder.take();
  CHECK(network.resistors.size() == 2);
  CHECK(network.switches.size() == 1);
  CHECK(network.signals.size() == 1);
}

TEST_CASE("a voltage between nodes is a form over those that are not ground", "[unit]") {
  CHECK(voltage_between(0, 1, 2.0).size() == 2);
  CHECK(voltage_between(0, 1, 2.0)[1].coefficient == -2.0);
  CHECK(voltage_between(ground, 1).size() == 1);
  CHECK(voltage_between(3, 3).empty());
  LinearForm sum = voltage_between(0, ground);
  accumulate(sum, voltage_between(1, ground), -3.0);
  REQUIRE(sum.size() == 2);
  CHECK(sum[1].coefficient == -3.0);
}
