/// What elements emit, judged by the current that the emitted parts carry, or by the numbers of the contract.
#include <cmath>

#include <catch2/catch.hpp>

#include "elements/catalogue.hpp"
#include "elements/emission.hpp"

using namespace pwlsim;
using namespace pwlsim::elements;

namespace {

/// Elements between the nodes 0 and 1, emitted.
struct Bench {
  std::vector<Instance> instances;
  std::vector<Model> models;
  std::vector<Emitted> emitted;
  model::NetworkBuilder builder;
  Diagnostics diagnostics;

  Bench() {
    (void)builder.node("a");
    (void)builder.node("b");
  }

  Instance& add(std::string name) {
    Instance instance;
    instance.kind = find_kind(name[0]);
    instance.name = std::move(name);
    instance.values = Values(instance.kind->parameters);
    if (instance.kind->terminals == 2) instance.nodes = {0, 1};
    return instances.emplace_back(std::move(instance));
  }

  Instance& refer(std::string name, std::initializer_list<int> others) {
    Instance& instance = add(std::move(name));
    for (int other : others) instance.references.push_back({instances[static_cast<std::size_t>(other)].name, {}, other});
    return instance;
  }

  int model(std::string_view type, std::initializer_list<std::pair<const char*, double>> values, double i0 = 1.0) {
    const ModelKind* kind = find_model_kind(type);
    Model item{kind, "M", {}, Values(kind->parameters)};
    for (const auto& [name, value] : values) item.values.set(name, value);
    if (kind->complete != nullptr) kind->complete(item, {i0}, diagnostics);
    models.push_back(std::move(item));
    return static_cast<int>(models.size()) - 1;
  }

  const model::Network& emit() {
    emitted.resize(instances.size());
    Emission emission(instances, models, emitted, builder, diagnostics);
    for (auto step : {&Kind::emit, &Kind::connect}) {
      for (std::size_t k = 0; k < instances.size(); ++k) {
        emission.select(k);
        if (const auto function = instances[k].kind->*step) function(emission);
      }
    }
    return builder.network();
  }
};

/// The current at voltage v through resistors and diodes all between the nodes 0 and 1, from the definition of each.
double static_current(const model::Network& network, double v) {
  double current = 0.0;
  for (const auto& r : network.resistors) current += v / r.resistance;
  for (const auto& d : network.diodes) {
    const double sign = d.p == 0 ? 1.0 : -1.0;
    current += sign * std::max(0.0, (sign * v - d.drop) / d.resistance);
  }
  return current;
}

}  // namespace

TEST_CASE("a diode follows the two-slope characteristic of its model", "[unit]") {
  const double on = 0.1, off = 50.0, forward = 0.7, reverse = 20.0, back = 0.4;
  const double m = GENERATE(1.0, 3.0);
  Bench bench;
  Instance& d = bench.add("D1");
  d.model = bench.model("D", {{"Ron", on}, {"Roff", off}, {"Vfwd", forward}, {"Vrev", reverse}, {"Rrev", back}});
  d.values.set("m", m);
  const model::Network& network = bench.emit();
  // LTspice's idealised diode: continuous, slope 1/Roff between −Vrev and Vfwd, 1/Ron above, 1/Rrev below; m in parallel.
  const auto expected = [&](double v) {
    if (v > forward) return m * (forward / off + (v - forward) / on);
    if (v < -reverse) return m * (-reverse / off + (v + reverse) / back);
    return m * v / off;
  };
  for (double v : {-30.0, -20.0, -19.0, -1.0, 0.0, 0.5, 0.7, 0.8, 5.0}) {
    INFO(v);
    CHECK(static_current(network, v) == Approx(expected(v)).epsilon(1e-12));
  }
  CHECK(bench.emitted[0].current.size() == 3);
}

TEST_CASE("a diode without parameters is one ideal port", "[unit]") {
  Bench bench;
  bench.add("D1").model = bench.model("D", {});
  const model::Network& network = bench.emit();
  REQUIRE(network.diodes.size() == 1);
  CHECK(network.diodes[0].resistance == 0.0);
  CHECK(network.diodes[0].drop == 0.0);
  CHECK(network.resistors.empty());
  CHECK(bench.diagnostics.all().empty());
}

TEST_CASE("an exponential diode becomes its tangent at i0", "[unit]") {
  const double saturation = 3e-13, emission_coefficient = 1.7, series = 0.02, i0 = GENERATE(1.0, 0.05);
  Bench bench;
  bench.add("D1").model = bench.model("D", {{"IS", saturation}, {"N", emission_coefficient}, {"RS", series}, {"BV", 60.0}}, i0);
  const Values& v = bench.models[0].values;
  // Shockley's law without its −1, as the contract's tangent has it; kT/q at 300.15 K is 25.8649 mV (CODATA k and q).
  const double thermal = 0.0258649;
  const auto voltage = [&](double i) { return series * i + emission_coefficient * thermal * std::log(i / saturation); };
  const double h = 1e-4 * i0;
  CHECK(v.get("Vfwd") + v.get("Ron") * i0 == Approx(voltage(i0)).epsilon(1e-5));
  CHECK(v.get("Ron") == Approx((voltage(i0 + h) - voltage(i0 - h)) / (2 * h)).epsilon(1e-5));
  CHECK(v.get("Vrev") == 60.0);
  REQUIRE(bench.diagnostics.all().size() == 1);
  CHECK(bench.diagnostics.all()[0].id == "N-diode-tangent");
}

TEST_CASE("a switch has its resistances on and off", "[unit]") {
  Bench bench;
  Instance& s = bench.add("S1");
  s.control_nodes = {{0, 1}};
  const double on = GENERATE(0.0, 2.0, 9.0);
  s.model = bench.model("SW", {{"Ron", on}, {"Roff", 5.0}, {"Vt", 1.0}, {"Vh", 0.25}});
  const model::Network& network = bench.emit();
  REQUIRE(network.switches.size() == 1);
  REQUIRE(network.resistors.size() == 1);
  const model::Switch& item = network.switches[0];
  const double parallel = network.resistors[0].resistance;
  const double closed = item.resistance == 0.0 ? 0.0 : 1.0 / (1.0 / item.resistance + 1.0 / parallel);
  const bool inverted = on > 5.0;  // then the contact is closed in the off state
  CHECK(closed == Approx(inverted ? 5.0 : on).epsilon(1e-14));
  CHECK(parallel == (inverted ? on : 5.0));
  CHECK_FALSE(item.initially_on);
  CHECK(item.inverted == inverted);
  CHECK(item.control[0].coefficient == 1.0);
  CHECK(item.on_level == 1.25);
  CHECK(item.off_level == 0.75);
}

TEST_CASE("levels above and below one another give a normal or an inverted switch", "[unit]") {
  const auto levels = [](double on, double off) {
    Bench bench;
    Instance& s = bench.add("S1");
    s.control_nodes = {{0, 1}};
    s.flag = true;
    s.model = bench.model("VSWITCH", {{"Von", on}, {"Voff", off}});
    return bench.emit().switches.at(0);
  };
  constexpr double reach = 2e-11;  // levels count where the control reaches them: they are that much within the band
  const model::Switch normal = levels(3.0, 2.0);
  CHECK(normal.on_level < 3.0);
  CHECK(normal.off_level > 2.0);
  CHECK(normal.control[0].coefficient == 1.0);
  CHECK(normal.on_level == Approx(3.0).epsilon(reach));
  CHECK(normal.off_level == Approx(2.0).epsilon(reach));
  const model::Switch inverted = levels(2.0, 3.0);  // closed while v < 2, open while v > 3
  CHECK(inverted.control[0].coefficient == -1.0);
  CHECK(inverted.on_level == Approx(-2.0).epsilon(reach));
  CHECK(inverted.off_level == Approx(-3.0).epsilon(reach));
  CHECK(inverted.initially_on);
  CHECK_FALSE(inverted.inverted);
}

TEST_CASE("a negative hysteresis switches at the threshold and says so", "[unit]") {
  Bench bench;
  Instance& s = bench.add("S1");
  s.control_nodes = {{0, 1}};
  s.model = bench.model("SW", {{"Vt", 0.5}, {"Vh", -0.2}});
  const model::Switch& item = bench.emit().switches.at(0);
  CHECK(item.on_level == 0.5);
  CHECK(item.off_level == 0.5);
  REQUIRE(bench.diagnostics.all().size() == 1);
  CHECK(bench.diagnostics.all()[0].id == "N-negative-hysteresis");
}

TEST_CASE("Lser and Vser stand in series with a switch and its off resistance", "[unit]") {
  Bench bench;
  Instance& s = bench.add("S1");
  s.control_nodes = {{0, 1}};
  s.model = bench.model("SW", {{"Roff", 1e6}, {"Lser", 1e-9}, {"Vser", 0.7}});
  const model::Network& network = bench.emit();
  REQUIRE(network.inductors.size() == 1);
  REQUIRE(network.branches.size() == 1);
  CHECK(network.inductors[0].n == 1);
  CHECK(network.branches[0].n == network.inductors[0].p);
  CHECK(network.branches[0].voltage[0].coefficient == 0.7);
  CHECK(network.switches[0].p == 0);
  CHECK(network.switches[0].n == network.branches[0].p);
  CHECK(network.resistors[0].n == network.branches[0].p);
  CHECK(network.switches[0].drop == 0.0);

  Bench ideal;
  Instance& t = ideal.add("S1");
  t.control_nodes = {{0, 1}};
  t.model = ideal.model("SW", {{"Vser", 0.7}});
  CHECK(ideal.emit().switches.at(0).drop == 0.7);
}

TEST_CASE("R C L honour multiplicity and their parasitic parts", "[unit]") {
  Bench bench;
  for (const char* name : {"R1", "C1", "L1"}) {
    Instance& item = bench.add(name);
    item.values.set(item.kind->parameters[0].name, 6.0);
    item.values.set("m", 2.0);
    item.values.set("Rser", 1.0);
    item.values.set("Lser", 4.0);
    item.values.set("Rpar", 8.0);
    item.values.set("Cpar", 3.0);
  }
  const model::Network& network = bench.emit();
  // Two in parallel: resistances and inductances halve, capacitances double.
  CHECK(network.resistors[0].resistance == 0.5);  // Rser
  CHECK(network.resistors[1].resistance == 3.0);
  CHECK(network.resistors[2].resistance == 4.0);  // Rpar
  CHECK(network.capacitors[1].capacitance == 12.0);
  CHECK(network.capacitors[2].capacitance == 6.0);  // Cpar
  CHECK(network.inductors[0].inductance == 2.0);    // Lser
  CHECK(network.inductors[2].inductance == 2.0);    // Lser of L1
  CHECK(network.inductors[3].inductance == 3.0);
  for (const Emitted& emitted : bench.emitted) CHECK(emitted.current.size() == 3);
  CHECK(network.resistors[1].p == 0);
  CHECK(network.resistors[1].n == network.inductors[0].p);  // core, Lser, Rser, in this order
  CHECK(network.inductors[0].n == network.resistors[0].p);
  CHECK(network.resistors[0].n == 1);
}

TEST_CASE("zero values are an open and a short circuit", "[unit]") {
  Bench bench;
  bench.add("C1").values.set("C", 0.0);
  bench.add("L1").values.set("L", 0.0);
  const model::Network& network = bench.emit();
  CHECK(network.capacitors.empty());
  CHECK(network.inductors.empty());
  REQUIRE(network.branches.size() == 1);
  CHECK(network.branches[0].voltage.empty());
  CHECK(bench.emitted[0].current.empty());
  CHECK(bench.diagnostics.all().size() == 2);
}

TEST_CASE("a source has its resistance in series", "[unit]") {
  Bench bench;
  Instance& v = bench.add("V1");
  v.waveform = model::Dc{5.0};
  v.values.set("Rser", 2.0);
  const model::Network& network = bench.emit();
  // v = E + Rser·i with i into the first node: E = 5 V delivering 1 A (i = −1) leaves 3 V.
  const model::LinearForm& form = network.branches.at(0).voltage;
  REQUIRE(form.size() == 2);
  CHECK(form[0].kind == Quantity::source);
  CHECK(form[1].kind == Quantity::branch_current);
  CHECK(form[1].coefficient == 2.0);
  CHECK(5.0 * form[0].coefficient + -1.0 * form[1].coefficient == 3.0);
}

TEST_CASE("controlled sources take the whole current of an element", "[unit]") {
  Bench bench;
  Instance& r = bench.add("R1");
  r.values.set("R", 1.0);
  r.values.set("Rpar", 2.0);
  bench.refer("F1", {0}).coefficients = {0.0, 3.0};
  bench.refer("H1", {0}).coefficients = {7.0, 3.0};
  const model::Network& network = bench.emit();
  const model::LinearForm& current = network.injections.at(0).current;
  REQUIRE(current.size() == 2);
  for (const model::Term& term : current) CHECK(term.coefficient == 3.0);
  CHECK(network.branches.at(0).voltage.size() == 3);
  CHECK(bench.emitted[1].current.size() == 2);
}

TEST_CASE("K couples every pair of its inductors", "[unit]") {
  Bench bench;
  for (const char* name : {"L1", "L2", "L3"}) bench.add(name).values.set("L", 1.0);
  bench.refer("K1", {0, 1, 2}).values.set("k", -1.0);
  const model::Network& network = bench.emit();
  REQUIRE(network.couplings.size() == 3);
  for (const auto& coupling : network.couplings) CHECK(coupling.coefficient == -1.0);
}
