// Sampled controllers, and sweeps of constant sources that keep their model, through the public headers alone.

#include <pwlsim/pwlsim.hpp>

#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "api/rounding.hpp"
#include "support/errors.hpp"

using namespace pwlsim;
using Catch::Matchers::Contains;
using pwlsim::test::id_of_error;
using pwlsim::test::rounding;

namespace {

/// R = 1 kΩ from node a to C = 1 µF at b.
Circuit low_pass() {
  Circuit circuit("low-pass");
  circuit.resistor("R1", "a", "b", 1e3).capacitor("C1", "b", "0", 1e-6).save({"v(b)"});
  return circuit;
}

}  // namespace

TEST_CASE("api: a controller of two states follows its recursion", "[unit]") {
  // b' = (a − b)/RC with a held: b[k+1] = a + (b[k] − a)e^{−T/RC}, where a is the sum of what was missing so far, one sample late.
  constexpr double period = 0.7e-3;
  for (const double delay : {0.0, period, 2.0 * period}) {
    Circuit circuit = low_pass();
    double sum = 0.0;
    circuit.controller(
        {.inputs = {"V(B)"},
         .outputs = {"a"},
         .every = period,
         .delay = delay,
         .initial = {0.25},
         .function = [&](double, const std::vector<double>& in, std::vector<double>& out) { out[0] = sum += 0.3 * (1.0 - in[0]); }});
    const Result result = circuit.run({.stop = 40 * period, .step = period, .use_initial_conditions = true});
    std::vector<double> held;
    double b = 0.0, again = 0.0;
    const auto late = static_cast<std::size_t>(std::lround(delay / period));
    for (std::size_t k = 0; k < 40; ++k) {
      INFO("sample " << k << " with a delay of " << delay << " s");
      REQUIRE(result.signal("v(b)")[k] == Approx(b).margin(rounding));
      held.push_back(again += 0.3 * (1.0 - b));
      const double a = k >= late ? held[k - late] : 0.25;
      b = a + (b - a) * std::exp(-period / 1e-3);
    }
  }
}

TEST_CASE("api: a controller sets a source by its name, and two controllers run side by side", "[unit]") {
  Circuit circuit = low_pass();
  circuit.voltage_source("V1", "a", "0", 2).resistor("R2", "c", "0", 4);
  std::vector<double> times;
  circuit.controller({.inputs = {}, .outputs = {"V1"}, .every = 2e-3, .function = [&](double time, const auto&, auto& out) {
                        times.push_back(time);
                        out[0] += 1.0;
                      }});
  circuit.controller(
      {.inputs = {"i(R1)"}, .outputs = {"c"}, .every = 1e-3, .function = [](double, const auto& in, auto& out) { out[0] = 1e3 * in[0]; }});
  circuit.save({"v(a)", "v(c)"});
  const Result result = circuit.run({.stop = 5e-3, .step = 1e-3});
  CHECK(result.signal("v(a)") == std::vector<double>{3, 3, 4, 4, 5, 5});
  CHECK(times == std::vector<double>{0.0, 2e-3, 4e-3});
  // At rest at V1 = 2 V no current flows; a step of 1 V makes it 1 mA, which decays with 1 ms. What is seen at 2 ms is from before the second step.
  CHECK(result.signal("v(c)")[0] == Approx(0.0).margin(1e-12));
  CHECK(result.signal("v(c)")[1] == Approx(std::exp(-1.0)).epsilon(1e-12));
  CHECK(result.signal("v(c)")[2] == Approx(std::exp(-2.0)).epsilon(1e-12));
  CHECK(result.signal("v(c)")[3] == Approx(std::exp(-3.0) + std::exp(-1.0)).epsilon(1e-12));
}

TEST_CASE("api: what a controller throws is nested in the error, which has the rows", "[unit]") {
  Circuit circuit = low_pass();
  circuit.controller({.inputs = {}, .outputs = {"a"}, .every = 1e-3, .function = [](double time, const auto&, auto& out) {
                        if (time > 2.5e-3) throw std::domain_error("too late\n\nAt:\n  line 3");
                        out[0] = 1.0;
                      }});
  try {
    (void)circuit.run({.stop = 1e-2, .step = 1e-3});
    FAIL("it did not throw");
  } catch (const RunError& error) {
    CHECK(error.id() == "E-controller");
    CHECK_THAT(error.what(), Contains("too late") && !Contains("line 3"));
    CHECK(error.result().time().size() == 3);
    CHECK(error.result().end() == Approx(3e-3));
    CHECK_THROWS_AS(std::rethrow_if_nested(error), std::domain_error);
  }
}

TEST_CASE("api: an output at a node that nothing uses is told", "[unit]") {
  const auto is_told = [](const char* output) {
    Circuit circuit = low_pass();
    circuit.controller({.outputs = {output}, .every = 1e-3, .function = [](double, const auto&, auto& out) { out[0] = 1.0; }});
    const Result result = circuit.run({.stop = 1e-2, .step = 1e-3});
    return std::any_of(result.messages().begin(), result.messages().end(), [](const Message& each) { return each.id == "W-dangling"; });
  };
  CHECK_FALSE(is_told("a"));
  CHECK(is_told("aa"));
}

TEST_CASE("api: controllers that are not complete are refused", "[unit]") {
  const auto answer = [](double, const std::vector<double>&, std::vector<double>&) {};
  const auto id_of = [](Controller controller) {
    return id_of_error([&] {
      Circuit circuit = low_pass();
      circuit.voltage_source("Vsine", "s", "0", "SIN(0 1 50)").resistor("R3", "s", "0", 1);
      (void)circuit.controller(std::move(controller)).run({.stop = 1e-3});
    });
  };
  CHECK(id_of({.outputs = {"a"}, .every = 1e-4, .function = answer}) == "none");
  CHECK(id_of({.outputs = {"a"}, .every = 1e-4}) == "E-controller");
  CHECK(id_of({.outputs = {"a"}, .every = 0.0, .function = answer}) == "E-controller");
  CHECK(id_of({.outputs = {"a"}, .every = 1e-4, .delay = -1.0, .function = answer}) == "E-controller");
  CHECK(id_of({.outputs = {"Vsine"}, .every = 1e-4, .function = answer}) == "E-controller");
  CHECK(id_of({.outputs = {"a", "A"}, .every = 1e-4, .function = answer}) == "E-controller");
  CHECK(id_of({.inputs = {"v(q)"}, .outputs = {"a"}, .every = 1e-4, .function = answer}) == "E-unknown-node");
}

TEST_CASE("api: where sources alone are stepped the kept model gives the runs of the circuit itself", "[unit]") {
  const Circuit circuit = Circuit::from_file(PWLSIM_SOURCE_DIR "/netlists/buck.net");
  const Sweep sweep(circuit, {"V1"});
  for (const double volts : {24.0, 6.0, 0.0}) {
    Circuit alone = circuit;
    alone.set_value("V1", volts);
    const Result expected = alone.run(), result = sweep.run({volts}, 3);
    CHECK(result.stepped() == std::vector<std::pair<std::string, double>>{{"V1", volts}});
    REQUIRE(result.time() == expected.time());
    CHECK(result.events().size() == expected.events().size());
    for (const std::string& name : expected.signals())
      for (std::size_t k = 0; k < expected.time().size(); ++k)
        REQUIRE(result.signal(name)[k] == Approx(expected.signal(name)[k]).margin(1e-10));  // 500 cycles of rounding at 24 V and 30 A
    CHECK(sweep.run({volts}, 9).signal("v(out)") == result.signal("v(out)"));               // whatever ran before
    CHECK(result.at("v(out)", {4.321e-3})[0] == Approx(expected.at("v(out)", {4.321e-3})[0]).margin(1e-10));
  }
}

TEST_CASE("api: .step of a source keeps its model; each run has its own operating point", "[unit]") {
  // 1 kΩ and 1 µF at rest; a step of 1 V on top: v = V1 + 1 − e^{−t/RC}.
  const Circuit circuit = Circuit::from_text(
      "s\nV1 a 0 1\nV2 c a PWL(0 0 0 1)\nR1 c b 1k\nC1 b 0 1u\n.step V1 list 1 -3 0\n.save v(b)\n.meas tran last FIND v(b) AT=2m\n.tran 1m "
      "2m\n");
  const Sweep sweep(circuit);
  REQUIRE(sweep.runs() == 3);
  for (std::size_t run = 0; run < 3; ++run) {
    const double volts = sweep.point(run)[0];
    const Result result = sweep.run({}, run);
    CHECK(result.signal("v(b)")[1] == Approx(volts - std::expm1(-1.0)).epsilon(rounding));
    CHECK(result.measurement("last") == Approx(volts - std::expm1(-2.0)).epsilon(rounding));
  }
}
