#include "model/tableau.hpp"

#include <catch2/catch.hpp>
#include <map>
#include <string>

using namespace pwlsim::model;

namespace {

/// Nodes a and b; R1 (a, b) of 10 Ω, R2 (b, ground) of 1 mΩ; one element of each other kind.
Network small_network() {
  Network network;
  network.nodes = {{"a", {}}, {"b", {}}};
  network.resistors = {{{"R1", {}}, 0, 1, 10.0}, {{"R2", {}}, 1, ground, 1e-3}};
  network.capacitors.resize(1);
  network.capacitors[0].label.name = "C1";
  network.inductors.resize(1);
  network.inductors[0].label.name = "L1";
  network.branches.resize(1);
  network.branches[0].label.name = "V1";
  network.diodes.resize(1);
  network.diodes[0].label.name = "D1";
  network.complementarities.resize(1);
  network.complementarities[0].label.name = "A1";
  network.switches.resize(1);
  network.switches[0].label.name = "S1";
  return network;
}

/// Coefficients by column; inductors' currents at 1000 + their number.
struct Sum {
  std::map<int, double> unknowns;
  double one = 0.0;

  void constant(double c) { one += c; }
  void source(int, double) {}
  void unknown(int column, double c) { unknowns[column] += c; }
  void inductor_current(int i, double c) { unknowns[1000 + i] += c; }
};

}  // namespace

TEST_CASE("unknowns are numbered by kind, and named by their elements", "[unit]") {
  const Network network = small_network();
  const Unknowns all(network, {.low_resistance = 1.0, .capacitor_currents = {1}, .rates = 1});
  // Nodes 0 and 1, then R2, C1, L1, the rate, V1, D1, A1, S1: the order of tableau.hpp.
  const std::string names[] = {"", "", "R2", "C1", "L1", "", "V1", "D1", "A1", "S1"};
  REQUIRE(all.size() == 10);
  for (int k = 0; k < all.size(); ++k) CHECK((all.owner(k) != nullptr ? all.owner(k)->name : "") == names[k]);
  CHECK(all.low_resistor(0) == -1);
  CHECK(all.is_resistor(2));
  CHECK(all.is_branch(6));
  CHECK(all.is_input(8));
  CHECK(!all.is_input(9));

  const Unknowns few(network, {.low_resistance = 0.0, .capacitor_currents = {0}});
  CHECK(few.size() == 7);  // without R2, C1 and the rate
  CHECK(few.capacitor(0) == -1);
  CHECK(few.owner(few.port(2))->name == "S1");
}

TEST_CASE("currents in linear forms are node voltages over R, or unknowns over R0", "[unit]") {
  const Network network = small_network();
  const Unknowns unknowns(network, {.low_resistance = 1.0, .capacitor_currents = {1}});
  const double r0 = 4.0;
  const LinearForm form = {{Term::Kind::one, 0, 7.0},
                           {Term::Kind::node_voltage, 0, 2.0},
                           {Term::Kind::node_voltage, ground, 5.0},
                           {Term::Kind::resistor_current, 0, 1.0},
                           {Term::Kind::resistor_current, 1, 1.0},
                           {Term::Kind::inductor_current, 0, 3.0},
                           {Term::Kind::switch_current, 0, 1.0},
                           {Term::Kind::slack_input, 0, 1.0}};
  Sum sum;
  write_form(network, unknowns, r0, std::vector<double>{0.25}, form, sum);
  CHECK(sum.one == 7.0);
  // i(R1) = (v(a) − v(b))/10 and 2·v(a); i(R2) and i(S1) are unknowns times 1/R0; the input of A1 has the scale 0.25.
  const std::map<int, double> expected = {{0, 2.1}, {1, -0.1}, {2, 0.25}, {1000, 3.0}, {unknowns.port(1), 0.25}, {unknowns.port(2), 0.25}};
  REQUIRE(sum.unknowns.size() == expected.size());
  for (const auto& [column, c] : expected) CHECK(sum.unknowns.at(column) == Approx(c).epsilon(1e-15));
}

TEST_CASE("the largest coefficients of complementarities become one", "[unit]") {
  Network network = small_network();
  network.complementarities[0].slack = {{Term::Kind::node_voltage, 0, 50.0}};
  network.branches[0].voltage = {{Term::Kind::slack_input, 0, -8.0}};
  const auto scales = scale_complementarities<double>(network, 1.0, [](const LinearForm& slack) { return slack.front().coefficient; });
  CHECK(scales.slack[0] == 1.0 / 50.0);
  CHECK(scales.input[0] == 1.0 / 8.0);
}
