// Circuits built in code, run through the public headers alone.

#include <pwlsim/pwlsim.hpp>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>
#include <thread>

#include "api/rounding.hpp"
#include "support/errors.hpp"
#include "support/scratch.hpp"

using namespace pwlsim;
using Catch::Matchers::Contains;
using pwlsim::test::id_of_error;
using pwlsim::test::rounding;

TEST_CASE("api: numbers are taken over to the last bit", "[unit]") {
  const double third = 1.0 / 3.0;
  Circuit circuit;
  circuit.voltage_source("V1", "a", "0", std::numbers::pi).resistor("R1", "a", "0", third);
  const Result result = circuit.run({.stop = 0.3, .step = 0.1});
  CHECK(result.time() == std::vector<double>{0.0, 0.1, 0.2, 0.3});
  CHECK(result.signal("V(A)")[0] == std::numbers::pi);
  CHECK(result.signal("i(V1)")[0] == Approx(-std::numbers::pi / third).epsilon(1e-15));
}

TEST_CASE("api: a capacitor charges as 10(1 - exp(-t/RC)), from its initial value too", "[unit]") {
  Circuit circuit("charging");
  circuit.voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", "1k").capacitor("C1", "out", "0", 1e-6, {{"ic", 4}});
  circuit.save({"v(out)"});
  const Result result = circuit.run({.stop = 5e-3, .step = 1e-4, .use_initial_conditions = true});
  REQUIRE(result.completed());
  CHECK(result.end() == 5e-3);
  CHECK(result.signals() == std::vector<std::string>{"v(out)"});
  REQUIRE(result.time().size() == 51);
  for (std::size_t k = 0; k < result.time().size(); ++k)
    CHECK(result.signal("v(out)")[k] == Approx(10.0 - 6.0 * std::exp(-result.time()[k] / 1e-3)).epsilon(rounding));
  CHECK(result.certificate().kcl_kvl < 1e-12);
  CHECK(result.certificate().passive == true);
  CHECK(result.statistics().engine == "exact");
  CHECK(result.statistics().states == 1);
}

TEST_CASE("api: events have names and times", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("V1", "in", "0", sine({.amplitude = 2, .frequency = 50}))
      .diode("D1", "in", "out")
      .diode("D2", "0", "out")
      .resistor("R1", "out", "0", 1);
  const Result result = circuit.run({.stop = 0.045});
  REQUIRE(result.events().size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    const Event& event = result.events()[k];
    CHECK(event.time == Approx(0.01 * (static_cast<double>(k) + 1.0)).epsilon(rounding));
    CHECK(event.mode_change);
    CHECK_FALSE(event.jump);
    CHECK((k % 2 == 0 ? event.turned_off : event.turned_on) == std::vector<std::string>{"D1"});
  }
  CHECK(result.on_at_start().front() == "D1");
  CHECK(circuit.run({.stop = 0.045, .events = false}).events().empty());
}

TEST_CASE("api: switches, models and pulses; rows on both sides of a jump", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("VG", "g", "0", pulse({.high = 5, .delay = 1, .width = 1, .period = 4}))
      .voltage_source("V1", "a", "0", 6)
      .voltage_switch("S1", "a", "b", "g", "0", "half")
      .model("half", "SW", {{"Vt", 2.5}, {"Ron", 1}})
      .resistor("R1", "b", "0", 2)
      .save({"v(b)"});
  const Result result = circuit.run({.stop = 4, .step = 4, .rows_at_events = true});
  CHECK(result.time() == std::vector<double>{0, 1, 1, 2, 2, 4});
  CHECK(result.signal("v(b)") == std::vector<double>{0, 0, 4, 4, 0, 0});
}

TEST_CASE("api: controlled sources, couplings, expressions, straight lines", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("V1", "a", "0", straight_lines({{0, 0}, {1, 2}}, true))
      .resistor("R1", "a", "0", 2)
      .voltage_controlled_voltage("E1", "e", "0", "a", "0", 3)
      .voltage_controlled_current("G1", "0", "g", "a", "0", 0.5)
      .resistor("RG", "g", "0", 1)
      .current_controlled_voltage("H1", "h", "0", "V1", 4)
      .current_controlled_current("F1", "0", "f", "V1", -2)
      .resistor("RF", "f", "0", 1)
      .expression_voltage("B1", "b", "0", "max(v(a),1)")
      .expression_current("B2", "0", "c", "u(v(a)-0.5)")
      .resistor("RC", "c", "0", 1)
      .save({"v(a)", "v(e)", "v(g)", "v(h)", "v(f)", "v(b)", "v(c)"});
  const Result result = circuit.run({.stop = 1.5, .step = 0.25});
  const std::vector<double> a{0, 0.5, 1, 1.5, 0, 0.5, 1};
  for (std::size_t k = 0; k < a.size(); ++k) {
    INFO("t = " << result.time()[k]);
    const auto is = [&](const char* signal, double value) { CHECK(result.signal(signal)[k] == Approx(value).margin(2.0 * rounding)); };
    is("v(a)", a[k]);
    is("v(e)", 3.0 * a[k]);
    is("v(g)", 0.5 * a[k]);
    is("v(h)", -2.0 * a[k]);
    is("v(f)", a[k]);
    is("v(b)", std::max(a[k], 1.0));
    if (a[k] != 0.5) is("v(c)", a[k] > 0.5 ? 1.0 : 0.0);
  }
}

TEST_CASE("api: a transformer of coupled inductors and one of the library", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("V1", "a", "0", sine({.amplitude = 10, .frequency = 50}))
      .inductor("L1", "a", "0", 1)
      .inductor("L2", "b", "0", 4)
      .coupling("K1", {"L1", "L2"}, 1)
      .resistor("R1", "b", "0", 100)
      .subcircuit("X1", {"a", "0", "c", "0"}, "xfmr", {{"n", 5}})
      .resistor("R2", "c", "0", 100)
      .save({"v(a)", "v(b)", "v(c)"});
  const Result result = circuit.run({.stop = 0.02, .step = 1e-3});
  for (std::size_t k = 0; k < result.time().size(); ++k) {
    CHECK(result.signal("v(b)")[k] == Approx(2.0 * result.signal("v(a)")[k]).margin(20.0 * rounding));
    CHECK(result.signal("v(c)")[k] == Approx(result.signal("v(a)")[k] / 5.0).margin(20.0 * rounding));
  }
}

TEST_CASE("api: initial conditions, parameters, options, measurements, harmonics, operating point", "[unit]") {
  Circuit circuit;
  circuit.parameter("R", 3)
      .voltage_source("V1", "a", "0", 8)
      .resistor("R1", "a", "b", 1)
      .resistor("R2", "b", "0", "{R}")
      .inductor("L1", "b", "c", 1)
      .resistor("R3", "c", "0", 3)
      .voltage_source("V2", "s", "0", sine({.offset = 1, .amplitude = 2, .frequency = 1, .phase = 30}))
      .resistor("RS", "s", "0", 1)
      .measure("power", "AVG v(s)*i(RS)")
      .measure("never", "FIND v(s) WHEN v(s)=9")
      .cards(".four 1 v(s)\n")
      .option("nonunique", "first");
  // V1 sees 1 + 3/2 ohm; half of the current flows through L1.
  for (const auto& [name, value] : circuit.operating_point()) {
    INFO(name);
    if (name == "i(L1)") CHECK(value == Approx(1.6).epsilon(rounding));
    if (name == "v(b)") CHECK(value == Approx(4.8).epsilon(rounding));
  }
  const Result result = circuit.run({.stop = 2});
  CHECK(result.measurement("power") == Approx(1.0 + 2.0).epsilon(rounding));
  CHECK(result.measurements()[0].unit == "W");
  CHECK_FALSE(result.measurements()[1].failure.empty());
  CHECK(id_of_error([&] { (void)result.measurement("never"); }) == "W-measurement-failed");
  CHECK(id_of_error([&] { (void)result.measurement("pwoer"); }) == "E-unknown-signal");
  REQUIRE(result.fourier().size() == 1);
  CHECK(result.fourier()[0].harmonics[0].magnitude == Approx(1.0).epsilon(rounding));
  CHECK(result.fourier()[0].harmonics[1].magnitude == Approx(2.0).epsilon(rounding));
  CHECK(result.fourier()[0].harmonics[1].phase == Approx(30.0).epsilon(1e-11));
  CHECK(result.fourier()[0].distortion < 1e-6);  // of squares that cancel

  circuit.initial_current("L1", 1).initial_voltage("s", 2);
  CHECK(circuit.run({.stop = 1e-3, .use_initial_conditions = true}).signal("i(L1)")[0] == Approx(1.0).epsilon(rounding));
}

TEST_CASE("api: decks from text and files, changed in code", "[unit]") {
  const std::string deck =
      "divider\n.param R=1k\nV1 a 0 1\nR1 a b 1k\nR2 b 0 {R}\n.step param S list 1 2 5\nR3 b 0 {S*1e30}\n.tran 1m 2m\n";
  Circuit circuit = Circuit::from_text(deck);
  CHECK(circuit.run().time().size() == 3);
  CHECK(circuit.run().signal("v(b)")[0] == Approx(0.5));
  circuit.parameter("R", 3e3);
  CHECK(circuit.run().signal("v(b)")[0] == Approx(0.75));
  CHECK(circuit.run({.stop = 1, .step = 0.25, .start = 0.5}).time() == std::vector<double>{0.5, 0.75, 1});
  CHECK(circuit.runs() == 3);
  const Result third = circuit.run({.run = 2});
  REQUIRE(third.stepped().size() == 1);
  CHECK(third.stepped()[0].first == "S");
  CHECK(third.stepped()[0].second == 5);
  CHECK(id_of_error([&] { (void)circuit.run({.run = 3}); }) == "E-range");

  const test::Scratch scratch;
  scratch.write("d.net", deck);
  CHECK(Circuit::from_file(scratch / "d.net").run().signal("v(b)")[0] == Approx(0.5));
  CHECK(id_of_error([&] { (void)Circuit::from_file(scratch / "none.net").run(); }) == "E-file-unreadable");
}

TEST_CASE("api: rows can be taken as they come", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("V1", "a", "0", straight_lines({{0, 0}, {3, 6}})).resistor("R1", "a", "0", 2).save({"v(a)", "i(R1)"});
  std::vector<std::vector<double>> rows;
  const Result result = circuit.run({.stop = 3, .step = 1, .row = [&](double time, const std::vector<double>& values) {
                                       rows.push_back({time, values.at(0), values.at(1)});
                                     }});
  CHECK(rows == std::vector<std::vector<double>>{{0, 0, 0}, {1, 2, 1}, {2, 4, 2}, {3, 6, 3}});
  CHECK(result.completed());
  CHECK(result.time().empty());
  CHECK(result.signal("v(a)").empty());
}

TEST_CASE("api: what is wrong with a circuit is said with the card it is about", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("V1", "a", "0", 1).diode("D1", "a", "b", "fsat").model("fast", "D").resistor("R1", "b", "0", std::nan(""));
  try {
    (void)circuit.run({.stop = 1});
    FAIL("no error");
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Contains("code:3:8: error[E-unknown-model]: unknown model 'fsat'; try 'fast'\nD1 a b fsat\n       ^~~~\n"));
    CHECK_THAT(error.what(), Contains("code:5:8: error[E-not-a-number]"));
    CHECK(error.messages().size() == 2);
    CHECK(error.messages()[0].kind == Message::Kind::error);
  }
  CHECK(id_of_error([&] { circuit.resistor("load", "b", "0", 1); }) == "E-name");
  CHECK(id_of_error([&] { circuit.resistor("R2", "b c", "0", 1); }) == "E-name");
  CHECK(id_of_error([&] { circuit.resistor("R2", "", "0", 1); }) == "E-name");
  CHECK(id_of_error([&] { circuit.resistor("R2", "b", "0", "1\nR3 b 0 1"); }) == "E-name");
  CHECK(id_of_error([] { (void)Circuit().run({.stop = 1}); }) == "E-syntax-empty");
  CHECK(id_of_error([] { (void)Circuit().resistor("R1", "a", "0", 1).run(); }) == "E-no-analysis");
  CHECK(id_of_error([] { (void)Circuit().resistor("R1", "a", "0", 1).run({.stop = -1}); }) == "E-tran");
  Circuit good;
  good.voltage_source("V1", "a", "0", 1).resistor("R1", "a", "0", 1);
  CHECK(id_of_error([&] { (void)good.run({.stop = 1}).signal("v(b)"); }) == "E-unknown-signal");
  CHECK(id_of_error([&] { (void)good.run({.stop = 1, .engine = Engine::sparse, .reltol = 1e-15}); }) == "E-tolerance");
  CHECK(good.run({.stop = 1, .engine = Engine::sparse}).messages().front().id == "W-sparse-engine");
}

TEST_CASE("api: a run that cannot go on throws, with the rows up to then", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("V1", "a", "0", straight_lines({{0, -1}, {2, 1}})).diode("D1", "a", "0").save({"v(a)"});
  try {
    (void)circuit.run({.stop = 2, .step = 0.25});
    FAIL("no error");
  } catch (const RunError& error) {
    CHECK(error.id() == "E-no-solution");
    CHECK_FALSE(error.result().completed());
    CHECK(error.result().end() == Approx(1.0));
    CHECK(error.result().signal("v(a)").at(3) == Approx(-0.25));
  }
}

TEST_CASE("api: a run can be watched and interrupted, and circuits run in threads", "[unit]") {
  Circuit circuit;
  circuit.voltage_source("V1", "a", "0", 1).resistor("R1", "a", "b", 1).capacitor("C1", "b", "0", 1);
  std::atomic<int> stop = 0;
  double seen = 0.0;
  const Result result = circuit.run({.stop = 1e6, .step = 1, .progress = [&](double time) { seen = time, stop = 1; }, .interrupt = &stop});
  CHECK_FALSE(result.completed());
  CHECK(seen > 0.0);
  CHECK(result.end() < 1e6);
  CHECK(result.messages().back().id == "E-interrupted");

  std::vector<double> ends(4);
  std::vector<std::thread> threads;
  for (double& end : ends)
    threads.emplace_back([&] { end = circuit.run({.stop = 1, .use_initial_conditions = true}).signal("v(b)").back(); });
  for (std::thread& thread : threads) thread.join();
  for (const double end : ends) CHECK(end == Approx(1.0 - std::exp(-1.0)).epsilon(rounding));
}

TEST_CASE("api: a run tells which cards of the deck it leaves to functions of their own", "[unit]") {
  Circuit circuit("left");
  circuit.voltage_source("V1", "a", "0", "PULSE(0 1 0 1u 1u 4u 10u) AC 1").resistor("R1", "a", "b", 1e3).capacitor("C1", "b", "0", 1e-9);
  const auto told = [&] {
    const Result result = circuit.run({.stop = 1e-5});
    const auto note =
        std::find_if(result.messages().begin(), result.messages().end(), [](const Message& each) { return each.id == "N-transient-only"; });
    return note == result.messages().end() ? std::string() : note->text;
  };
  CHECK(told().empty());
  circuit.cards(".pss\n.ac lin 2 1k 10k\n.meas pss m avg v(b)");
  CHECK_THAT(told(), Contains(".meas pss (steady_state), .ac (small_signals"));
}

// RC behind a square wave from 0 to 1 of half duty: at its rise v = e^{-x}/(1 + e^{-x}), x the half period over RC. From rest it would be 0.
TEST_CASE("api: a run of a deck with .pss starts on the orbit, as the program does", "[unit]") {
  Circuit circuit("on the orbit");
  circuit.voltage_source("V1", "a", "0", "PULSE(0 1 0 0 0 5u 10u)").resistor("R1", "a", "b", Value("{r}")).capacitor("C1", "b", "0", 1e-9);
  circuit.cards(".param r=1k\n.pss\n.tran 1u 20u\n.meas tran begin FIND v(b) AT=0\n.meas tran next FIND v(b) AT=10u");
  const auto at_rise = [](double r) {
    const double fall = std::exp(-5e-6 / (r * 1e-9));
    return fall / (1.0 + fall);
  };
  const Result result = circuit.run({});
  CHECK(result.measurement("begin") == Approx(at_rise(1e3)).epsilon(1e-9));
  CHECK(result.measurement("next") == Approx(at_rise(1e3)).epsilon(1e-9));
  const Sweep sweep(circuit, {"r"});
  CHECK(sweep.run({3e3}).measurement("begin") == Approx(at_rise(3e3)).epsilon(1e-9));
  Circuit drifts("no orbit");
  drifts.current_source("I1", "0", "a", "PULSE(0 1 0 0 0 5u 10u)").capacitor("C1", "a", "0", 1e-9).cards(".pss\n.tran 1u 20u");
  CHECK_THROWS_AS(drifts.run({}), RunError);
}
