/// Exact segments in Krylov spaces: the spaces against closed forms, whole runs against the dense engine.
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "engine/krylov_rig.hpp"
#include "support/random.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using namespace pwlsim::engine::sparse;

namespace {

constexpr double segment_error = 1e-11;  ///< of the largest state
constexpr double sharing = 1e-9;         ///< of the largest current: how parallel diodes differ

/// What instants deliver of the probes.
struct Deliveries : engine::PieceSink {
  void before_start(std::span<const double>) override {}
  void take(const engine::Piece&) override {}
  void impulse(double time, std::span<const double> values) override {
    times.push_back(time);
    of_first.push_back(values.front());
  }
  std::vector<double> times, of_first;
};

}  // namespace

// C v' = −G v with C = 1: v(t) = Q e^{−Λt} Qᵀ v(0) by the eigenvectors of the symmetric G.
TEST_CASE("a Krylov space follows random networks of R and C as their eigenvectors do", "[unit]") {
  for (int seed = 1; seed <= 20; ++seed) {
    INFO("seed " << seed);
    Random random(static_cast<std::uint64_t>(seed));
    const int n = 30;
    TestCircuit c;
    linalg::Matrix g = linalg::Matrix::Zero(n, n);
    const auto name = [](int i) { return "n" + std::to_string(i); };
    for (int i = 0; i < n; ++i) c.c(name(i), "0", 1.0);
    for (int i = 0; i < n; ++i) {
      const int j = i + 1 < n && random.chance(0.9) ? i + 1 : -1;
      const double conductance = std::pow(10.0, random.between(-2.0, 2.0));
      c.r(name(i), j < 0 ? "0" : name(j), 1.0 / conductance);
      g(i, i) += conductance;
      if (j < 0) continue;
      g(j, j) += conductance;
      g(i, j) -= conductance;
      g(j, i) -= conductance;
    }
    Rig rig(c.network());
    linalg::Vector start(n);
    for (int i = 0; i < n; ++i) start[i] = rig.z[static_cast<std::size_t>(i)] = random.between(-1.0, 1.0);
    const double length = 1.0;
    REQUIRE(rig.begin(32.0 / length));
    rig.space.grow(n + 2);
    REQUIRE(rig.space.is_sound());
    const Eigen::SelfAdjointEigenSolver<linalg::Matrix> modes(g);
    for (int j = 0; j <= 8; ++j) {
      const double t = std::ldexp(length, -j);
      const linalg::Vector decays = (-t * modes.eigenvalues().array()).exp();
      const linalg::Vector expected = modes.eigenvectors() * decays.asDiagonal() * modes.eigenvectors().transpose() * start;
      const std::vector<double> z = rig.at(t);
      for (int i = 0; i < n; ++i) CHECK(std::abs(z[static_cast<std::size_t>(i)] - expected[i]) < segment_error);
    }
  }
}

// v(t) = 1 − e^{−t} in each of many equal branches: one exponential and a constant.
TEST_CASE("a Krylov space ends where all that moves is in it", "[unit]") {
  TestCircuit c;
  c.v("s", "0", model::Dc{1.0});
  for (int i = 0; i < 50; ++i) {
    c.r("s", "n" + std::to_string(i), 1.0);
    c.c("n" + std::to_string(i), "0", 1.0);
  }
  Rig rig(c.network());
  REQUIRE(rig.begin(4.0));
  rig.space.grow(40);
  CHECK(rig.space.is_full());
  CHECK(rig.space.dimension() <= 3);
  for (const double t : {0.1, 1.0, 30.0}) CHECK(rig.at(t)[1] == Approx(1.0 - std::exp(-t)).epsilon(segment_error));
}

// Rings of capacitors with a source in them, and a floating one: constraints of index 2.
TEST_CASE("no vector of a Krylov space leaves the constraints of capacitor loops", "[unit]") {
  TestCircuit c;
  c.v("s", "0", sine(1.0, 1.0));
  c.c("s", "a", 1e-6);
  c.c("a", "b", 2e-6);
  c.c("b", "0", 3e-6);
  c.c("f", "g", 1e-6);
  c.c("g", "h", 1e-6);
  c.c("h", "f", 1e-6);
  c.r("a", "f", 1e3);
  c.r("g", "b", 1e4);
  c.l("h", "b", 1e-2);
  Rig rig(c.network());
  for (std::size_t i = 0; i < rig.z.size(); ++i) rig.z[i] = 0.1 * static_cast<double>(i);
  REQUIRE(rig.begin(32.0 / 1e-3));
  rig.space.grow(12);
  REQUIRE(rig.space.is_sound());
  for (const double t : {0.0, 1e-5, 1e-3}) rig.check_constraints(t, contamination);
}

TEST_CASE("exact segments follow Cockcroft-Walton generators as the dense engine does", "[unit]") {
  for (const int stages : {2, 3, 6, 10}) {
    INFO(stages << " stages");
    const TestCircuit c = multiplier(stages);
    const Setup setup{.stop = 0.2, .steps = 500};
    const Run dense = simulate(c.network(), setup), segments = simulate_segments(c.network(), setup);
    REQUIRE(segments.answer.outcome == engine::Outcome::completed);
    CHECK(distance(segments, dense) < engine_error);
    CHECK(segments.answer.statistics.events == dense.answer.statistics.events);
  }
}

// Segments of forty vectors: the nodes between a rectifier's resistor and its diode lose eight digits in the last of them, and guards none in what the motion takes of
// these. A bound of the loss by magnitudes took the guards for rounding and left events out.
TEST_CASE("exact segments follow rectifiers on RC grids as the dense engine does", "[unit]") {
  for (const auto& [side, rectifiers] : {std::pair{6, 2}, {6, 4}, {8, 3}}) {
    INFO(side << " × " << side << " nodes, " << rectifiers << " rectifiers");
    const TestCircuit c = grid(side, rectifiers);
    const Setup setup{.stop = 2e-3, .steps = 200, .uic = true};
    const Run dense = simulate(c.network(), setup), segments = simulate_segments(c.network(), setup);
    REQUIRE(segments.answer.outcome == engine::Outcome::completed);
    CHECK(distance(segments, dense) < engine_error);
    CHECK(segments.answer.statistics.events == dense.answer.statistics.events);
    CHECK(segments.answer.certificate.complementarity < engine_error);
  }
}

// Columns of 150 diodes reach zero together at each peak of the source, and rest there in several orders of derivatives. The sparse engine's steps at that tolerance are
// 1e-7 to 1e-6 off (its error falls as reltol^(2/3)).
TEST_CASE("exact segments follow Cockcroft-Walton generators of hundreds of diodes", "[unit]") {
  for (const int stages : {50, 150}) {
    INFO(stages << " stages");
    const TestCircuit c = multiplier(stages);
    const Setup setup{.stop = 0.1, .steps = 250};
    const Run segments = simulate_segments(c.network(), setup);
    INFO(segments.answer.id << " " << segments.answer.message);
    REQUIRE(segments.answer.outcome == engine::Outcome::completed);
    const Run steps = simulate_steps(c.network(), setup, 1e-6);
    REQUIRE(steps.answer.outcome == engine::Outcome::completed);
    CHECK(distance(segments, steps) < 1e-5);
  }
}

// By symmetry the least-squares share of parallel ideal diodes is a half each. Before they conduct they rest at zero, with and without voltages around them, beside a
// third diode that is free in another loop, and in positions in which sharing would carry nothing.
TEST_CASE("parallel ideal diodes share their current by exact segments, whatever was before", "[unit]") {
  for (int variant = 0; variant < 6; ++variant) {
    INFO("variant " << variant);
    TestCircuit c;
    const double before = variant % 2 == 0 ? -5.0 : 0.0;
    c.v("s", "0", model::Pwl{{{0.0, 0.0}, {1e-3, before}, {2e-3, 0.0}, {3e-3, 0.0}, {4e-3, 5.0}, {5e-3, 0.0}, {6e-3, 0.0}, {7e-3, 3.0}}});
    if (variant < 4) c.r("s", "a", 1.0);
    if (variant >= 4) c.l("s", "a", 1e-3);
    c.d("a", "b");
    c.d("a", "b");
    if (variant == 1 || variant == 2) c.d("0", "b");
    if (variant == 3 || variant == 4) c.c("b", "0", 1e-5, -1.0);
    c.r("b", "0", 10.0);
    c.save_i_d(0);
    c.save_i_d(1);
    const Run run = simulate_segments(c.network(), {.stop = 8e-3, .steps = 160});
    REQUIRE(run.answer.outcome == engine::Outcome::completed);
    double largest = 0.0, apart = 0.0;
    for (std::size_t row = 0; row < run.rows.size(); ++row) {
      largest = std::max(largest, std::abs(run.at(row, 0)));
      apart = std::max(apart, std::abs(run.at(row, 0) - run.at(row, 1)));
    }
    CHECK(largest > 0.05);
    CHECK(apart <= sharing * largest);
  }
}

// A source's edge of 6 V at 1 ms charges C1 and C2 in series through a diode: q = 6 V·C1 C2/(C1 + C2). A current source of 0.5 A flows beside it, whose charge in a step of
// any length is no part of the impulse.
TEST_CASE("charges of jumps by exact segments are those of their capacitors", "[unit]") {
  TestCircuit c;
  c.v("s", "0", model::Pulse{1.0, 7.0, 1e-3, 0.0, 0.0, 1.0, 2.0});
  c.d("s", "a");
  c.c("a", "b", 2e-6, 1.0);
  c.c("b", "0", 3e-6, 0.0);
  c.i("0", "b", model::Dc{0.5e-3});
  c.r("b", "0", 1e3);
  c.save_i_d(0);
  Diagnostics diagnostics;
  const auto model = engine::sparse::prepare(c.network(), diagnostics);
  REQUIRE(model);
  Deliveries deliveries;
  engine::Request request = request_of({.stop = 2e-3, .steps = 10, .uic = true});
  request.probes = {{0}, 0.0, 2e-3, &deliveries};
  Run run;
  run.answer = engine::sparse::run_segments(*model, request, segment_tolerance, run);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  REQUIRE(deliveries.times.size() == 1);
  CHECK(deliveries.times.front() == Approx(1e-3));
  const double before = 0.5 * (1.0 - std::exp(-1e-3 / 3e-3));  // v(b): R with C2 alone, as the diode blocks while v(b) rises
  CHECK(deliveries.of_first.front() == Approx((6.0 - before) * 1.2e-6).epsilon(engine_error));
}

// The diode makes its node ground, so that the coil's current is (1 − e^(−R t/L)) V/R and nothing reaches what is behind. Rounding there once opened the second diode, and in the end no position
// was found.
TEST_CASE("what is behind a diode that conducts to ground stays at rest by exact segments", "[unit]") {
  TestCircuit c;
  c.v("s", "0", model::Dc{10.0});
  c.r("s", "a", 10.0);
  c.l("a", "x", 1e-3);
  c.d("x", "0");
  c.l("x", "b", 1e-6);
  c.r("b", "y", 5.0);
  c.c("y", "0", 1e-8, 0.0);
  c.l("y", "e", 1e-6);
  c.c("e", "0", 2e-8, 0.0);
  c.d("e", "0");
  c.save_i_d(0);
  c.save_v("y");
  c.save_v("e");
  c.save_i_d(1);
  const Run run = simulate_segments(c.network(), {.stop = 1e-3, .steps = 100, .uic = true});
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (std::size_t row = 1; row < run.rows.size(); ++row) {
    CHECK(run.at(row, 0) == Approx(1.0 - std::exp(-static_cast<double>(row) / 10.0)).epsilon(engine_error));
    for (std::size_t signal = 1; signal < 4; ++signal) CHECK(run.at(row, signal) == 0.0);
  }
}

// At 44 µs the switch cuts off the current of the inductor, which is lost; C discharges through R from there: e^(−t/RC). 1 nF across a diode of 1 mΩ has a time constant of 10⁻¹² s, far below the step
// that takes the jump.
TEST_CASE("a switch cuts an inductor's current off beside picoseconds by exact segments", "[unit]") {
  TestCircuit c;
  c.v("g", "0", model::Pulse{0.0, 1.0, 12e-6, 0.0, 0.0, 32e-6, 1e-4});
  c.c("p", "n5", 17e-6, 50.0);
  c.s("p", "n6", "g", "0", 0.5);
  const auto string = [&](int first, int last) {
    for (int i = first; i < last; ++i) c.d("n" + std::to_string(i), "n" + std::to_string(i + 1), 0.3);
  };
  string(0, 5);
  string(6, 14);
  for (auto& diode : c.network().diodes) diode.resistance = 1e-3;
  c.v("0", "n0", model::Dc{0.0});
  c.network().switches.front().resistance = 0.02;
  c.r("n5", "n4", 0.02);
  c.c("n5", "n4", 1e-9, 0.0);
  c.c("n14", "n13", 1e-9, 0.0);
  const int coil = c.l("n14", "out", 1e-3);
  c.c("out", "0", 1e-6, 0.0);
  c.r("out", "0", 20.0);
  c.save_i_l(coil);
  c.save_v("out");
  const Run run = simulate_segments(c.network(), {.stop = 70e-6, .steps = 70, .uic = true});
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.at(43, 0) > 0.5);
  for (std::size_t row = 45; row <= 70; ++row) {
    CHECK(std::abs(run.at(row, 0)) < engine_error);
    CHECK(run.at(row, 1) == Approx(run.at(45, 1) * std::exp(-static_cast<double>(row - 45) / 20.0)).epsilon(engine_error));
  }
}

// The only resistance, 100 MΩ, makes the unit of currents: i = C ω V cos ωt is 10¹³ V in it, from nothing while the diode blocks, and no impulse. v = V sin ωt until its peak, then e^(−t/RC).
TEST_CASE("a capacitor of farads charges beside a load of megohms by exact segments", "[unit]") {
  constexpr double farads = 2.2, volts = 100.0, omega = 100.0 * 3.14159265358979323846, load = 1e8;
  TestCircuit c;
  c.v("s", "0", model::Sin{.amplitude = volts, .frequency = 50.0});
  c.d("s", "a");
  c.c("a", "0", farads, 10.0);
  c.r("a", "0", load);
  c.save_v("a");
  c.save_i_d(0);
  const Run run = simulate_segments(c.network(), {.stop = 20e-3, .steps = 20, .uic = true});
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  for (std::size_t row = 1; row <= 20; ++row) {
    const double t = 1e-3 * static_cast<double>(row);
    const bool conducts = row < 5;
    CHECK(run.at(row, 0) ==
          Approx(conducts ? volts * std::sin(omega * t) : volts * std::exp(-(t - 5e-3) / (load * farads))).epsilon(engine_error));
    if (row != 5)
      CHECK(std::abs(run.at(row, 1) - (conducts ? farads * omega * volts * std::cos(omega * t) + run.at(row, 0) / load : 0.0)) <
            engine_error * farads * omega * volts);
  }
}

// A transformer of ratio 2 whose leakage, 2e-6 of its inductance, has time constants of 10⁻¹² and 10⁻¹³ s: its diode turns on 10⁻¹⁶ s after the edge. Without leakage v(s) = 2 I/G e^(−t/τ), I the source's
// current into a short circuit with what the drop drives back, G all conductances at the primary, τ = L G.
TEST_CASE("a diode turns on within the fastest decay after an edge by exact segments", "[unit]") {
  constexpr double source = 100.0, resistance = 0.7, inductance = 2.1e-4, load = 445.0, damping = 1e4, drop = 0.3, ratio = 2.0;
  constexpr double leakage = 1e-5;  ///< allowed for it
  TestCircuit c;
  c.v("in", "0", model::Dc{source});
  c.r("in", "p", resistance);
  const int primary = c.l("p", "0", inductance), secondary = c.l("s", "0", ratio * ratio * inductance);
  c.k(primary, secondary, 0.999999);
  c.d("s", "o", drop);
  c.network().diodes.front().resistance = 1e-3;
  c.r("o", "0", load);
  c.r("s", "0", damping);
  c.save_v("s");
  const Run run = simulate_segments(c.network(), {.stop = 5e-6, .steps = 50, .uic = true});
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  const double current = source / resistance + ratio * drop / load;
  const double conductance = 1.0 / resistance + ratio * ratio / load + ratio * ratio / damping;
  for (std::size_t row = 1; row <= 50; ++row)
    CHECK(run.at(row, 0) ==
          Approx(ratio * current / conductance * std::exp(-1e-7 * static_cast<double>(row) / (inductance * conductance))).epsilon(leakage));
}

// Two capacitors in parallel by a diode that conducts from t = 0 on, their voltages a rounding ε apart: v(b) = V − ε/2 + S/2 sin ωt until the source's peak, then it stays. What the diode has of ε is no voltage
// when it turns off: its position there is the first that is tried.
TEST_CASE("a diode that turns off begins at zero by exact segments, whatever rounding it held", "[unit]") {
  constexpr double charge = 3000.0, swing = 100.0;
  constexpr std::uint64_t few_solutions = 60;  // of 25 today; all positions and lengths took 350
  const double apart = GENERATE(5e-10, 1e-9, 2e-9, 6e-9);
  TestCircuit c;
  c.v("s", "0", sine(swing, 50.0));
  c.c("a", "s", 0.02, charge);
  c.c("b", "0", 0.02, charge - apart);
  c.d("a", "b");
  c.save_v("b");
  const Run run = simulate_segments(c.network(), {.stop = 20e-3, .steps = 20, .uic = true});
  INFO(run.answer.id << " " << run.answer.message);
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.statistics.klu_solves <= few_solutions);
  for (std::size_t row = 1; row <= 20; ++row) {
    const double source = swing * std::sin(0.1 * std::numbers::pi * static_cast<double>(std::min<std::size_t>(row, 5)));
    CHECK(run.at(row, 0) == Approx(charge - 0.5 * apart + 0.5 * source).epsilon(engine_error));
  }
}
