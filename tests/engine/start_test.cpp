/// Where runs start: operating points and initial values, computed by hand.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "engine/sparse/sparse.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;

namespace {

constexpr double start_rounding = 1e-12;

std::vector<double> operating_point(const TestCircuit& c) {
  Diagnostics diagnostics;
  const auto model = engine::prepare(c.network(), diagnostics);
  REQUIRE(model);
  const engine::OperatingPoint point = engine::operating_point(*model);
  INFO(point.answer.message);
  REQUIRE(point.answer.outcome == engine::Outcome::completed);
  return point.values;
}

bool has_remark(const engine::Answer& answer, const std::string& id) {
  return std::any_of(answer.remarks.begin(), answer.remarks.end(), [&](const auto& remark) { return remark.id == id; });
}

/// 0 V before its step at t = 0, 10 V after it.
model::Pulse step_at_zero() {
  model::Pulse pulse;
  pulse.pulsed = 10.0;
  return pulse;
}

}  // namespace

// 12 V over 1 Ω, a short (the inductor), 2 Ω and 3 Ω: 2 A; the capacitor lies across the 3 Ω.
TEST_CASE("capacitors are open, inductors short", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{12.0});
  c.r("in", "a", 1.0);
  const int l = c.l("a", "b", 1e-3);
  c.r("b", "d", 2.0);
  c.r("d", "0", 3.0);
  c.c("d", "0", 1e-6);
  c.save_v("a", "b");
  c.save_v("d");
  c.save_i_l(l);
  const double expected[] = {0.0, 6.0, 2.0};
  const auto point = operating_point(c);
  for (std::size_t i = 0; i < 3; ++i) CHECK(point[i] == Approx(expected[i]).margin(start_rounding));
  const Run run = simulate(c.network(), {1e-3, 10, false});
  for (const auto& row : run.rows)
    for (std::size_t i = 0; i < 3; ++i) CHECK(row[i + 1] == Approx(expected[i]).margin(1e-11));
  CHECK(run.answer.remarks.empty());
}

// A peak detector at rest on the source's 5 V: both diodes carry the load's 5 mA; a third one, the other way round, blocks 5 V.
TEST_CASE("diodes take the position that Kirchhoff and their signs leave", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{5.0});
  const int d1 = c.d("in", "a");
  const int d2 = c.d("a", "b");
  const int d3 = c.d("0", "b");
  c.c("b", "0", 1e-6);
  c.r("b", "0", 1e3);
  c.save_v("b");
  for (const int d : {d1, d2, d3}) c.save_i_d(d);
  const auto point = operating_point(c);
  const double expected[] = {5.0, 5e-3, 5e-3, 0.0};
  for (std::size_t i = 0; i < 4; ++i) CHECK(point[i] == Approx(expected[i]).margin(start_rounding));
}

TEST_CASE("the step at t = 0 comes after the operating point", "[unit]") {
  TestCircuit c;
  c.v("in", "0", step_at_zero());
  c.r("in", "a", 1.0);
  c.c("a", "0", 1.0, 4.0);
  c.save_v("in");
  c.save_v("a");
  CHECK(operating_point(c)[0] == 0.0);
  const Run from_point = simulate(c.network(), {1.0, 10, false});
  CHECK(from_point.at(0, 0) == Approx(10.0));
  CHECK(from_point.at(0, 1) == Approx(0.0).margin(start_rounding));
  CHECK(from_point.at(10, 1) == Approx(10.0 * (1.0 - std::exp(-1.0))).epsilon(start_rounding));
  const Run from_values = simulate(c.network(), {1.0, 10, true});
  CHECK(from_values.at(0, 0) == Approx(10.0));
  CHECK(from_values.at(0, 1) == Approx(4.0).epsilon(start_rounding));
  CHECK(from_values.at(10, 1) == Approx(10.0 - 6.0 * std::exp(-1.0)).epsilon(start_rounding));
  CHECK(from_values.answer.statistics.events == 0);  // t = 0 does not count
}

TEST_CASE(".ic of a node holds in the operating point and is let go at once", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{10.0});
  c.r("in", "a", 1.0);
  c.c("a", "0", 1.0);
  model::NodeCondition held;
  held.node = c.node("a");
  held.voltage = 3.0;
  c.network().node_conditions.push_back(held);
  c.save_v("a");
  const Run run = simulate(c.network(), {1.0, 10, false});
  CHECK(run.at(0, 0) == Approx(3.0).epsilon(start_rounding));
  CHECK(run.at(10, 0) == Approx(10.0 - 7.0 * std::exp(-1.0)).epsilon(start_rounding));
}

TEST_CASE(".ic of an inductor holds in the operating point and is let go at once", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{10.0});
  c.r("in", "a", 2.0);
  const int l = c.l("a", "0", 2.0);
  model::CurrentCondition held;
  held.inductor = l;
  held.current = 1.0;
  c.network().current_conditions.push_back(held);
  c.save_i_l(l);
  const Run run = simulate(c.network(), {1.0, 10, false});
  CHECK(run.at(0, 0) == Approx(1.0).epsilon(start_rounding));
  CHECK(run.at(10, 0) == Approx(5.0 - 4.0 * std::exp(-1.0)).epsilon(start_rounding));
}

// An inductor across a capacitor without resistance, or a capacitor that nothing charges: any value would do; zero holds no energy.
TEST_CASE("where the operating point is not unique the run starts with least energy and says so", "[unit]") {
  TestCircuit loop;
  loop.l("a", "0", 1e-3);
  const int l = loop.l("a", "0", 1e-3);
  loop.r("a", "0", 1.0);
  loop.save_i_l(l);
  const Run circulating = simulate(loop.network(), {1e-3, 2, false});
  CHECK(std::abs(circulating.at(0, 0)) <= start_rounding);
  CHECK(has_remark(circulating.answer, "W-op-not-unique"));

  TestCircuit floating;
  floating.v("in", "0", model::Dc{4.0});
  floating.c("in", "m", 1e-6);
  floating.c("m", "0", 3e-6);
  floating.save_v("m");
  const Run divided = simulate(floating.network(), {1e-3, 2, false});
  // ½·1µ·(4 − v)² + ½·3µ·v² is least at v = 1: the divider of an uncharged midpoint.
  CHECK(divided.at(0, 0) == Approx(1.0).epsilon(start_rounding));
  CHECK(has_remark(divided.answer, "W-op-not-unique"));
}

TEST_CASE("initial values that contradict the circuit are projected, and the run says so", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 1.0, 3.0);
  c.c("a", "0", 2.0, 0.0);  // in parallel: charge 3 C on 3 F
  c.r("a", "0", 1.0);
  c.save_v("a");
  const Run run = simulate(c.network(), {1.0, 2, true});
  CHECK(run.at(0, 0) == Approx(1.0).epsilon(start_rounding));
  CHECK(run.at(2, 0) == Approx(std::exp(-1.0 / 3.0)).epsilon(start_rounding));
  CHECK(has_remark(run.answer, "W-start-projected"));

  TestCircuit source;
  source.v("in", "0", model::Dc{5.0});
  source.c("in", "0", 1.0, 1.0);
  source.save_v("in");
  const Run pulled = simulate(source.network(), {1.0, 2, true});
  CHECK(pulled.at(0, 0) == Approx(5.0));
  CHECK(has_remark(pulled.answer, "W-start-projected"));
}

TEST_CASE("initial values that fit are not talked about", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 1.0, 3.0);
  c.c("a", "0", 2.0, 3.0);
  c.r("a", "0", 1.0);
  c.save_v("a");
  const Run run = simulate(c.network(), {1.0, 2, true});
  CHECK(run.at(0, 0) == Approx(3.0).epsilon(start_rounding));
  CHECK_FALSE(has_remark(run.answer, "W-start-projected"));
}

// 1 V in the forward direction of a diode between ideal nodes: no current satisfies it.
TEST_CASE("a source that shorts itself through a diode has no operating point, and no run", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{1.0});
  c.d("in", "0");
  c.c("in", "0", 1.0);
  c.save_v("in");
  for (const bool uic : {false, true}) {
    const Run run = simulate(c.network(), {1.0, 2, uic});
    REQUIRE(run.errors.empty());
    CHECK(run.answer.outcome == engine::Outcome::no_solution);
    CHECK_FALSE(run.answer.message.empty());
  }
}

// Closed, the switch takes away the voltage that closes it; open, it lets it come back.
TEST_CASE("a switch that undoes its own condition is named", "[unit]") {
  TestCircuit c;
  c.v("in", "0", model::Dc{1.0});
  c.r("in", "a", 1.0);
  c.s("a", "0", "a", "0", 0.5);
  c.save_v("a");
  const Run run = simulate(c.network(), {1.0, 1, false});
  CHECK(run.answer.id == "E-no-operating-point");
  CHECK(run.answer.elements == std::vector<std::string>{"SW1"});
  CHECK(run.answer.message ==
        "no DC operating point: SW1 keeps toggling; and without one the switches SW1 keep toggling at t = 0 s: each state violates its own "
        "condition; try a hysteresis Vh");
}

// 2 A into 0.5 F have no rest: v = 4 t, from zero, since without uic ic= does not count. The other part has its own: 5 V behind 1 ohm.
TEST_CASE("a part without an operating point starts from zero, another from its own", "[unit]") {
  TestCircuit c;
  c.i("0", "a", model::Dc{2.0});
  c.c("a", "0", 0.5, 3.0);
  c.v("in", "0", model::Dc{5.0});
  c.r("in", "b", 1.0);
  c.c("b", "0", 2.0, 1.0);
  c.save_v("a");
  c.save_v("b");
  const Run run = simulate(c.network(), {2.0, 4, false});
  CHECK(run.answer.outcome == engine::Outcome::completed);
  CHECK(has_remark(run.answer, "W-no-operating-point"));
  CHECK_FALSE(has_remark(run.answer, "W-start-projected"));
  for (const auto& row : run.rows) {
    CHECK(row[1] == Approx(4.0 * row[0]).margin(start_rounding));
    CHECK(row[2] == Approx(5.0).margin(start_rounding));
  }

  Diagnostics diagnostics;
  const auto model = engine::prepare(c.network(), diagnostics);
  REQUIRE(model);
  CHECK(engine::operating_point(*model).answer.id == "E-no-operating-point");

  Run stepped;
  engine::Request request;
  request.stop = 2.0;
  request.grid = {[](std::uint64_t k) { return static_cast<double>(k); }, 3};
  const auto large = engine::sparse::prepare(c.network(), diagnostics);
  REQUIRE(large);
  CHECK(has_remark(engine::sparse::run(*large, request, 1e-6, stepped), "W-no-operating-point"));
  REQUIRE(stepped.rows.size() == 3);
  for (const auto& row : stepped.rows) {
    CHECK(row[1] == Approx(4.0 * row[0]).margin(1e-6));
    CHECK(row[2] == Approx(5.0).margin(1e-6));
  }
  CHECK(engine::sparse::operating_point(*large).answer.id == "E-no-operating-point");
}

TEST_CASE("what no signal depends on is left out where it always has a solution", "[unit]") {
  TestCircuit c;
  c.v("in", "0", sine());
  c.r("in", "a", 1.0);
  c.d("a", "b");
  c.c("b", "0", 1.0);
  c.save_v("in");
  const Run run = simulate(c.network(), {1.0, 2, true});
  CHECK(run.answer.outcome == engine::Outcome::completed);
  CHECK(has_remark(run.answer, "N-left-out"));
}
