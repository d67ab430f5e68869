/// The circuits of the hard cases with closed-form answers (numbers as in the collection of hard cases).
#include <catch2/catch.hpp>
#include <cmath>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using std::numbers::pi;

namespace {
constexpr double tight = 1e-12;  ///< absolute, on quantities of order one
}

TEST_CASE("16: half-wave rectifier into R-L turns off at the extinction angle", "[hard]") {
  TestCircuit c;
  c.v("s", "0", sine());
  c.d("s", "a");
  const int l = c.l("a", "b", 1.0);
  c.r("b", "0", 1.0);
  c.save_i_l(l);
  const Run run = simulate(c.network(), {2.0 * pi, 200, true, true});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  // i(t) = (sin(t − π/4) + sin(π/4) e^{−t})/√2 until β: sin(β−π/4) + sin(π/4) e^{−β} = 0.
  const double beta = 3.940733135692915;
  const auto times = event_times(run);
  REQUIRE(times.size() >= 1);
  CHECK(times.front() == Approx(beta).epsilon(tight));
  for (const auto& row : run.rows) {
    const double t = row[0];
    const double exact = t < beta ? (std::sin(t - pi / 4) + std::sin(pi / 4) * std::exp(-t)) / std::sqrt(2.0) : 0.0;
    CHECK(std::abs(row[1] - exact) < tight);
  }
}

TEST_CASE("17: peak detector jumps onto the source, leaves it and returns", "[hard]") {
  TestCircuit c;
  c.v("s", "0", sine());
  c.d("s", "a");
  c.c("a", "0", 1.0, -0.3);
  c.r("a", "0", 2.0);
  c.save_v("a");
  const Run run = simulate(c.network(), {7.0, 100, true, true});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(std::abs(run.at(0, 0)) < tight);
  const auto times = event_times(run);
  REQUIRE(times.size() == 2);
  // tan t = −RC·1 = −2: off at π − atan 2; then v = sin(t_off) e^{−(t−t_off)/2} meets the sine again.
  CHECK(times[0] == Approx(pi - std::atan(2.0)).epsilon(tight));
  CHECK(times[1] == Approx(6.384949403569911).epsilon(tight));
}

TEST_CASE("18: the tank with a diode stops after half a period", "[hard]") {
  TestCircuit c;
  const double cap = 2e-6, ind = 5e-3;
  c.c("a", "0", cap, 1.0);
  c.d("a", "b");
  const int l = c.l("b", "0", ind);
  c.save_v("a");
  c.save_i_l(l);
  const double half = pi * std::sqrt(ind * cap);
  const Run run = simulate(c.network(), {3.0 * half, 60, true, true});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  REQUIRE(times.size() == 1);
  CHECK(times[0] == Approx(half).epsilon(tight));
  CHECK(run.rows.back()[1] == Approx(-1.0).epsilon(tight));
  CHECK(std::abs(run.rows.back()[2]) < tight * std::sqrt(cap / ind));
}

TEST_CASE("19, 20: a diode joins two charged capacitors", "[hard]") {
  const auto [c1, v1, c2] = GENERATE(table<double, double, double>({{1.0, 3.0, 2.0}, {1e-12, 5.0, 1e-6}}));
  TestCircuit c;
  c.c("a", "0", c1, v1);
  c.d("a", "b");
  c.c("b", "0", c2, 0.0);
  c.save_v("a");
  c.save_v("b");
  const Run run = simulate(c.network(), {1.0, 2});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const double shared = c1 * v1 / (c1 + c2);  // charge is conserved
  CHECK(run.at(0, 0) == Approx(shared).epsilon(tight));
  CHECK(run.at(2, 1) == Approx(shared).epsilon(tight));
}

TEST_CASE("21: a chain of diodes and capacitors is isotonic regression", "[hard]") {
  const auto [third, expected] = GENERATE(table<double, std::vector<double>>({{1.0, {4.0 / 3, 4.0 / 3, 4.0 / 3}}, {2.0, {1.5, 1.5, 2.0}}}));
  TestCircuit c;
  c.c("a", "0", 1.0, 3.0);
  c.c("b", "0", 1.0, 0.0);
  c.c("c", "0", 1.0, third);
  c.d("a", "b");
  c.d("b", "c");
  for (const auto* node : {"a", "b", "c"}) c.save_v(node);
  const Run run = simulate(c.network(), {1.0, 1});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (std::size_t i = 0; i < 3; ++i) CHECK(run.at(0, i) == Approx(expected[i]).epsilon(tight));
}

TEST_CASE("22: two inductors and a freewheeling diode", "[hard]") {
  // L1 feeds node a from ground, L2 and the diode take from it.
  const auto [i1, i2, e1, e2] = GENERATE(table<double, double, double, double>({{2.0, -1.0, -0.25, -0.25}, {-1.0, 2.0, -1.0, 2.0}}));
  TestCircuit c;
  const int l1 = c.l("0", "a", 1.0, i1);
  const int l2 = c.l("a", "0", 3.0, i2);
  c.d("0", "a");
  c.save_i_l(l1);
  c.save_i_l(l2);
  const Run run = simulate(c.network(), {1.0, 1});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.at(0, 0) == Approx(e1).epsilon(tight));
  CHECK(run.at(0, 1) == Approx(e2).epsilon(tight));
}

TEST_CASE("23: commutation overlap", "[hard]") {
  TestCircuit c;
  c.v("s", "0", sine());
  const int l = c.l("s", "a", 1.0);
  c.d("a", "b");
  c.d("0", "b");
  c.i("b", "0", model::Dc{0.5});
  c.save_i_l(l);
  const Run run = simulate(c.network(), {6.0, 60, true, true});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  // i_L = 1 − cos t reaches I0 = ½ at μ = π/3; the current falls again from π on (v < 0) until π + … = 4π/3.
  REQUIRE(times.size() >= 3);
  CHECK(times[0] == Approx(pi / 3).epsilon(tight));
  CHECK(times[1] == Approx(pi).epsilon(tight));
  CHECK(times[2] == Approx(4.0 * pi / 3).epsilon(tight));
}

TEST_CASE("24: a capacitive divider takes its share of a step", "[hard]") {
  TestCircuit c;
  const double r = 1e3;
  model::Pulse step;
  step.pulsed = 1.0;
  step.delay = 1e-9;
  c.v("s", "0", step);
  c.c("s", "m", 1e-12);
  c.c("m", "0", 3e-12);
  c.r("m", "0", r);
  c.save_v("m");
  const Run run = simulate(c.network(), {5e-9, 5, false});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(std::abs(run.at(0, 0)) < tight);
  CHECK(run.at(1, 0) == Approx(0.25).epsilon(tight));
  // pole −1/(R(C1+C2))
  CHECK(run.at(5, 0) == Approx(0.25 * std::exp(-4e-9 / (r * 4e-12))).epsilon(1e-11));
}

TEST_CASE("25: a ring of ideal diodes has a least-norm current", "[hard]") {
  TestCircuit c;
  const int d1 = c.d("a", "b");
  const int d2 = c.d("b", "c");
  const int d3 = c.d("c", "a");
  c.i("b", "c", model::Dc{1.0});
  c.r("a", "0", 1.0);
  for (const int d : {d1, d2, d3}) c.save_i_d(d);
  const Run run = simulate(c.network(), {1.0, 1});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const double expected[] = {1.0, 0.0, 1.0};  // (1,0,1) + t(1,1,1), least norm with nonnegative currents: t = 0
  for (std::size_t i = 0; i < 3; ++i) CHECK(run.at(0, i) == Approx(expected[i]).margin(1e-9));
}

TEST_CASE("26: two diodes in series behave as one", "[hard]") {
  TestCircuit c;
  c.v("s", "0", sine());
  c.d("s", "m");
  c.d("m", "a");
  c.c("a", "0", 1.0, 0.0);
  c.r("a", "0", 2.0);
  c.save_v("a");
  const Run run = simulate(c.network(), {7.0, 100, true, true});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  REQUIRE(times.size() == 2);
  CHECK(times[0] == Approx(pi - std::atan(2.0)).epsilon(tight));
  CHECK(times[1] == Approx(6.384949403569911).epsilon(tight));
}

TEST_CASE("27: one or two parallel diodes, same times, currents shared", "[hard]") {
  const int diodes = GENERATE(1, 2);
  TestCircuit c;
  c.v("s", "0", sine());
  c.r("s", "a", 1.0);
  std::vector<int> d;
  for (int i = 0; i < diodes; ++i) d.push_back(c.d("a", "b"));
  c.c("b", "0", 1.0);
  c.r("b", "0", 2.0);
  for (const int i : d) c.save_i_d(i);
  const Run run = simulate(c.network(), {7.0, 70, true, true});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  REQUIRE(times.size() == 2);
  CHECK(times[0] == Approx(2.6125914799).epsilon(1e-10));
  CHECK(times[1] == Approx(6.3607289530).epsilon(1e-10));
  if (diodes == 2)
    for (const auto& row : run.rows) CHECK(row[1] == Approx(row[2]).margin(1e-12));
}

TEST_CASE("28: bridge with a floating secondary", "[hard]") {
  const bool filter = GENERATE(false, true);
  TestCircuit c;
  c.v("p", "q", sine());
  c.d("p", "o");
  c.d("q", "o");
  c.d("0", "p");
  c.d("0", "q");
  c.r("o", "0", 2.0);
  if (filter) c.c("o", "0", 1.0);
  c.save_v("o");
  const Run run = simulate(c.network(), {6.0, 60, true, true});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  if (!filter) {
    REQUIRE(times.size() == 1);
    CHECK(times[0] == Approx(pi).epsilon(tight));
    for (const auto& row : run.rows) CHECK(row[1] == Approx(std::abs(std::sin(row[0]))).margin(tight));
    return;
  }
  REQUIRE(times.size() >= 2);
  CHECK(times[0] == Approx(pi - std::atan(2.0)).epsilon(tight));
  CHECK(times[1] == Approx(3.569668899701).epsilon(1e-12));
}

TEST_CASE("29: voltage doubler climbs in steps", "[hard]") {
  TestCircuit c;
  model::Pulse square;
  square.initial = -1.0;
  square.pulsed = 1.0;
  square.delay = 1.0;
  square.width = 1.0;
  square.period = 2.0;
  c.v("s", "0", square);
  c.c("s", "a", 1.0);
  c.d("0", "a");
  c.d("a", "b");
  c.c("b", "0", 3.0);
  c.save_v("b");
  const Run run = simulate(c.network(), {10.0, 20});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  // After the n-th positive edge 2V(1 − (C2/(C1+C2))^n).
  for (int n = 1; n <= 5; ++n)
    CHECK(run.at(static_cast<std::size_t>(4 * n - 1), 0) == Approx(2.0 * (1.0 - std::pow(0.75, n))).epsilon(tight));
  CHECK(run.at(20, 0) == Approx(1.525390625).epsilon(tight));
}

TEST_CASE("33: three equal buffered RC sections, defective", "[hard]") {
  TestCircuit c;
  c.c("x", "0", 1.0, 1.0);
  c.r("x", "0", 1.0);
  c.e("p", "0", "x", "0", 1.0);
  c.r("p", "y", 1.0);
  c.c("y", "0", 1.0);
  c.e("q", "0", "y", "0", 1.0);
  c.r("q", "z", 1.0);
  c.c("z", "0", 1.0);
  // A clamp whose switch watches z: it closes when z = t² e^{−t}/2 passes ¼.
  c.v("one", "0", model::Dc{1.0});
  c.s("one", "w", "z", "0", 0.25);
  c.r("w", "0", 1.0);
  c.save_v("z");
  c.save_v("w");
  const Run run = simulate(c.network(), {2.0, 20, true, true});
  REQUIRE(run.errors.empty());
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const auto times = event_times(run);
  REQUIRE(times.size() == 1);
  CHECK(times[0] == Approx(1.4879620654981778).epsilon(tight));
  for (const auto& row : run.rows) CHECK(row[1] == Approx(0.5 * row[0] * row[0] * std::exp(-row[0])).margin(tight));
}
