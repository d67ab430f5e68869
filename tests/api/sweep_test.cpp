// Values of elements, runs that are done again, steady states and sweeps, through the public headers alone.

#include <pwlsim/pwlsim.hpp>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "api/rounding.hpp"
#include "support/errors.hpp"

using namespace pwlsim;
using pwlsim::test::id_of_error;
using pwlsim::test::rounding;

namespace {

/// 12 V behind r into R2: v = 12·R2/(r + R2).
Circuit loaded() {
  return Circuit::from_text("s\nV1 in 0 12\nR1 in out {r}\nR2 out 0 2\n.param r=1\n.meas tran v AVG v(out)\n.tran 1m 2m\n");
}

Circuit buck() { return Circuit::from_file(PWLSIM_SOURCE_DIR "/netlists/buck.net"); }

}  // namespace

TEST_CASE("api: values of elements are read and replaced", "[unit]") {
  Circuit circuit = Circuit::from_text(
      "d\nV1 in 0 SIN(0 10 50) AC 1\nR1 in out {2*r}\nC1 out 0 C=1u\nX1 out 0 part\n.subckt part a b\nRin a b 7\n.ends\n.param r=1k\n");
  CHECK(circuit.value("r1") == 2e3);
  CHECK(circuit.value("C1") == 1e-6);
  CHECK(circuit.value("X1:Rin") == 7);
  CHECK(id_of_error([&] { (void)circuit.value("V1"); }) == "E-no-value");
  CHECK(id_of_error([&] { (void)circuit.value("R9"); }) == "E-unknown-element");
  circuit.set_value("R1", 1.0 / 3.0).set_value("V1", 5).set_value("C1", "2u");
  CHECK(circuit.value("R1") == 1.0 / 3.0);
  CHECK(circuit.value("V1") == 5);
  CHECK(circuit.value("C1") == 2e-6);
  circuit.set_value("R1", "{r/4}");
  CHECK(circuit.value("R1") == 250);
  circuit.set_value("Rin", 1);
  CHECK(id_of_error([&] { (void)circuit.operating_point(); }) == "E-unknown-element");
}

TEST_CASE("api: a result answers at any time", "[unit]") {
  Circuit circuit("rc");
  circuit.voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", 1e3).capacitor("C1", "out", "0", 1e-6);
  const Result result = circuit.run({.stop = 5e-3, .step = 1e-3, .use_initial_conditions = true});
  const std::vector<double> times{3.3e-3, 1e-7, 0.0, 5e-3, 3.3e-3};
  const std::vector<double> values = result.at("v(out)", times);
  for (std::size_t k = 0; k < times.size(); ++k)
    CHECK(values[k] == Approx(-10.0 * std::expm1(-times[k] / 1e-3)).epsilon(rounding).margin(1e-15));
  CHECK(result.at("V(out)", result.time()) == result.signal("v(out)"));
  CHECK(id_of_error([&] { (void)result.at("v(out)", {6e-3}); }) == "E-range");
  CHECK(id_of_error([&] { (void)result.at("v(no)", {0.0}); }) == "E-unknown-signal");
  CHECK(result.report().find("v(out)") != std::string::npos);
  const Result light = circuit.run({.stop = 1e-3, .evaluable = false});
  CHECK(id_of_error([&] { (void)light.at("v(out)", {0.0}); }) == "E-not-kept");
  CHECK(id_of_error([&] { (void)light.report(); }) == "E-not-kept");
}

TEST_CASE("api: the steady state of a buck converter and what small signals do to it", "[unit]") {
  const SteadyState state = buck().steady_state({.points = 100});
  CHECK(state.period == 10e-6);
  CHECK(state.is_driven);
  CHECK(state.stability == "stable");
  CHECK(state.waveform.time().size() == 101);
  // On an orbit the capacitor's mean current and the inductor's mean voltage are zero: the mean output is duty·V1, and the current at mid-ramp is that into R1.
  std::vector<double> times;
  constexpr int points = 20000;
  for (int k = 0; k < points; ++k) times.push_back(10e-6 * (k + 0.5) / points);
  double mean = 0.0;
  for (const double v : state.waveform.at("v(out)", times)) mean += v / points;
  CHECK(mean == Approx(0.45 * 24).epsilon(1e-7));  // the midpoint rule of 20,000 points
  Circuit with_input = buck();
  with_input.set_value("V1", "24 AC 1");
  const Response response = with_input.small_signals({1.0});
  CHECK(std::abs(response.values[0][0]) == Approx(0.45).epsilon(1e-3));  // duty at low frequency
  CHECK(id_of_error([] {
          Circuit dc("dc");
          (void)dc.voltage_source("V1", "a", "0", 1).resistor("R1", "a", "b", 1).capacitor("C1", "b", "0", 1e-6).steady_state();
        }).starts_with("E-pss"));
}

TEST_CASE("a current that is impulses has no response where edges move, with a message", "[unit]") {
  Circuit pump = Circuit::from_text(
      "pump\nVin in 0 5\nVg g 0 PULSE(0 1 0 0 0 5u 10u)\nS1 in a g 0 SX\nC1 a 0 1u\nS2 a out 0 g SY\nC2 out 0 10u\nR1 out 0 1k\n"
      ".model SX SW(Vt=0.5)\n.model SY SW(Vt=-0.5)\n.save i(Vin)\n");
  const Response response = pump.small_signals({100.0}, {.from = "duty(Vg)"});
  CHECK(std::isnan(response.values[0][0].real()));
  REQUIRE(!response.messages.empty());
  CHECK(response.messages.back().id == "W-ac-impulse");
}

TEST_CASE("api: a sweep gives what its runs give, whatever the threads", "[unit]") {
  const Sweep sweep(loaded(), {"r", "R2"});
  CHECK(sweep.measurements() == std::vector<std::string>{"v"});
  CHECK(sweep.run({2.0, 4.0}).measurement("v") == Approx(8).epsilon(rounding));
  const std::vector<std::vector<double>> points{{1, 2}, {1, 4}, {2, 2}, {-1, 1}, {1, 10}};
  std::map<std::size_t, double> first;
  for (const std::size_t jobs : {1, 3}) {
    std::map<std::size_t, double> found;
    run_all(sweep, points, jobs,
            [&](std::size_t number, const SweptRun& run) { found[number] = run.done ? run.measurements.at(0) : std::nan(""); });
    REQUIRE(found.size() == points.size());
    for (const std::size_t k : {0U, 1U, 2U, 4U})
      CHECK(found[k] == Approx(12 * points[k][1] / (points[k][0] + points[k][1])).epsilon(rounding));
    for (const std::size_t k : {0U, 1U, 2U, 4U}) {
      if (!first.empty()) CHECK(found[k] == first[k]);
    }
    first = found;
  }
  CHECK(id_of_error([&] { (void)sweep.run({1.0}); }) == "E-argument-count");
  CHECK(id_of_error([] { (void)Sweep(loaded(), {"nothing"}).run({1.0}); }) == "E-unknown-element");
  Circuit stepped = loaded();
  stepped.cards(".step param r list 1 2 4");
  const Sweep of_deck(stepped);
  CHECK(of_deck.runs() == 3);
  CHECK(of_deck.names() == std::vector<std::string>{"r"});
  CHECK(of_deck.point(2) == std::vector<double>{4});
  CHECK(of_deck.run({}, 2).measurement("v") == Approx(4).epsilon(rounding));
}
