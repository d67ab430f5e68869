#pragma once
/// Spaces and runs by exact segments, and circuits for them.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "engine/sparse/krylov_space.hpp"
#include "engine/sparse/sources.hpp"
#include "engine/sparse/sparse.hpp"
#include "support/circuit.hpp"

namespace pwlsim::test {

using namespace engine::sparse;

constexpr double engine_error = 1e-9;    ///< of a signal's largest value: whole runs
constexpr double contamination = 1e-13;  ///< of the terms of a row

/// A network with all its ports off, and a space from node voltages on.
struct Rig {
  explicit Rig(const model::Network& network)
      : descriptor(network), factors(network, descriptor), sources(network), space(descriptor, sources.exosystem()) {
    on.assign(descriptor.ports().size(), 0);
    z.assign(static_cast<std::size_t>(descriptor.size()), 0.0);
    sources.states(0.0, zeta);
  }
  [[nodiscard]] bool begin(double shift) {
    const Factor* factor = factors.at(shift, on);
    return factor && space.begin(*factor, shift, on, {z, {}, zeta}, 0.0) == KrylovSpace::Begun::yes;
  }
  [[nodiscard]] std::vector<double> at(double tau) {
    std::vector<double> y(space.first().begin(), space.first().end()), work(2 * y.size()), result;
    space.flow().apply_once(tau, y.data(), work.data());
    space.unknowns(y.data(), result);
    return result;
  }

  /// No row without a derivative is broken at τ by more than that share of the largest terms of a row.
  void check_constraints(double tau, double share, bool has_sources = true) {
    const std::vector<char> differential = descriptor.differential_rows();
    const std::vector<double> reached = at(tau);
    std::vector<double> w, rates(z.size()), sizes(z.size());
    sources.evaluate(tau, w);
    if (!has_sources) w.assign(w.size(), 0.0);
    descriptor.rates(reached.data(), w.data(), rates.data());
    descriptor.rate_sizes(reached.data(), w.data(), sizes.data());
    const double largest = *std::max_element(sizes.begin(), sizes.end());
    for (std::size_t i = 0; i < rates.size(); ++i)
      if (differential[i] == 0) CHECK(std::abs(rates[i]) <= share * largest);
  }

  Descriptor descriptor;
  Factors factors;
  Sources sources;
  KrylovSpace space;
  Position on;
  std::vector<double> z, zeta;
};

inline engine::Request request_of(const Setup& setup) {
  engine::Request request;
  request.stop = setup.stop;
  request.grid.rows = setup.steps + 1;
  request.grid.time = [=](std::uint64_t k) { return setup.stop * static_cast<double>(k) / static_cast<double>(setup.steps); };
  request.events = setup.events;
  request.use_initial_conditions = setup.uic;
  return request;
}

/// By implicit steps of the sparse engine.
inline Run simulate_steps(const model::Network& network, const Setup& setup, double reltol) {
  Run run;
  Diagnostics diagnostics;
  const auto model = engine::sparse::prepare(network, diagnostics);
  if (model) run.answer = engine::sparse::run(*model, request_of(setup), reltol, run);
  return run;
}

inline Run simulate_segments(const model::Network& network, const Setup& setup, double shift_factor = 1.0) {
  Run run;
  Diagnostics diagnostics;
  const auto model = engine::sparse::prepare(network, diagnostics);
  if (!model) return run;
  run.answer = engine::sparse::run_segments(*model, request_of(setup), segment_tolerance, run, shift_factor);
  return run;
}

/// The largest difference of two runs' rows, of each signal's largest value.
inline double distance(const Run& a, const Run& b) {
  REQUIRE(a.rows.size() == b.rows.size());
  double worst = 0.0;
  for (std::size_t signal = 0; signal + 1 < b.rows.front().size(); ++signal) {
    double size = 0.0, difference = 0.0;
    for (std::size_t row = 0; row < b.rows.size(); ++row) {
      size = std::max(size, std::abs(b.at(row, signal)));
      difference = std::max(difference, std::abs(a.at(row, signal) - b.at(row, signal)));
    }
    worst = std::max(worst, difference / size);
  }
  return worst;
}

/// After Cockcroft and Walton, charged to nine tenths, loaded.
inline TestCircuit multiplier(int stages) {
  TestCircuit c;
  c.v("s", "0", sine(100.0, 50.0));
  const double capacitance = 1e-6 * std::max(stages, 3) * std::max(stages, 3) / 9.0 * 20.0;
  const auto name = [](char column, int n) { return column + std::to_string(n); };
  for (int n = 1; n <= stages; ++n) {
    const std::string below = n == 1 ? "s" : name('a', n - 1), low = n == 1 ? "0" : name('b', n - 1);
    c.c(name('a', n), below, capacitance, n == 1 ? 90.0 : 180.0);
    c.c(name('b', n), low, capacitance, 180.0);
    c.d(low, name('a', n));
    c.d(name('a', n), name('b', n));
  }
  c.r(name('b', stages), "0", stages * 1e5);
  c.save_v(name('b', stages));
  c.save_v("b1");
  c.save_v(name('a', (stages + 1) / 2));
  return c;
}

/// RC grid fed by half-wave rectifiers at several nodes, at several frequencies and phases.
inline TestCircuit grid(int side, int rectifiers) {
  TestCircuit c;
  const auto name = [](int i, int j) { return "n" + std::to_string(i) + "_" + std::to_string(j); };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      if (j + 1 < side) c.r(name(i, j), name(i, j + 1), 1.0);
      if (i + 1 < side) c.r(name(i, j), name(i + 1, j), 1.0);
      c.c(name(i, j), "0", 1e-6, 8.0);
      if ((i + j) % 7 == 0) c.r(name(i, j), "0", 1e3);
    }
  for (int r = 0; r < rectifiers; ++r) {
    const int place = r * side * side / rectifiers + side / 2;
    model::Sin source = sine(10.0, 1000.0 + 10.0 * (r % 7));
    source.phase = 2.0 * std::numbers::pi * r / rectifiers;
    c.v("v" + std::to_string(r), "0", source);
    c.r("v" + std::to_string(r), "w" + std::to_string(r), 0.5);
    c.d("w" + std::to_string(r), name(place / side % side, place % side));
  }
  c.save_v(name(0, 0));
  c.save_v(name(side / 2, side / 2));
  c.save_v(name(side - 1, side - 1));
  return c;
}

}  // namespace pwlsim::test
