/// What a step of the sparse engine costs beside one solution with its factor.
///
///     cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DPWLSIM_BENCH=ON && ninja -C build bench_sparse && build/bench/bench_sparse
///
/// `solves`: the time of a step, its estimated error taken out, over that of one solution with the same factor, measured in the same run. Ports stay in their
/// position: what their complementarity problem costs comes on top, where they change.

#include <benchmark/benchmark.h>

#include <chrono>
#include <stdexcept>

#include "engine/sparse/stepper.hpp"

namespace {

using namespace pwlsim;
using namespace pwlsim::engine::sparse;

/// Nodes in a square, 1 Ω between neighbours, 1 µF and now and then 1 kΩ to ground, fed through diodes.
model::Network grid(int side, int rectifiers) {
  model::Network network;
  const auto node = [&](int i, int j) { return static_cast<model::NodeIndex>(i * side + j); };
  for (int i = 0; i < side * side; ++i) network.nodes.push_back({"n" + std::to_string(i), {}});
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      if (j + 1 < side) network.resistors.push_back({{"RH", {}}, node(i, j), node(i, j + 1), 1.0});
      if (i + 1 < side) network.resistors.push_back({{"RV", {}}, node(i, j), node(i + 1, j), 1.0});
      if ((i + j) % 7 == 0) network.resistors.push_back({{"RG", {}}, node(i, j), model::ground, 1e3});
      model::Capacitor c;
      c.p = node(i, j);
      c.n = model::ground;
      c.capacitance = 1e-6;
      network.capacitors.push_back(c);
    }
  for (int r = 0; r < rectifiers; ++r) {
    const auto source = static_cast<model::NodeIndex>(network.nodes.size());
    network.nodes.push_back({"v" + std::to_string(r), {}});
    network.sources.push_back({{}, model::Sin{0.0, 10.0, 1e3}, false});
    model::Branch branch;
    branch.p = source;
    branch.voltage.push_back({model::Term::Kind::source, r, 1.0});
    network.branches.push_back(branch);
    model::Diode d;
    d.p = source;
    d.n = node(r * side / rectifiers, side / 2);
    d.resistance = 0.5;
    network.diodes.push_back(d);
  }
  return network;
}

void step(benchmark::State& state) {
  const model::Network network = grid(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Descriptor descriptor(network);
  Factors factors(network, descriptor);
  PortSolver ports(descriptor, factors, 10.0);
  const Sources sources(network);
  Stepper stepper(descriptor, ports, sources);
  const StateScale scale(descriptor, 10.0);
  Point from;
  from.on.assign(descriptor.ports().size(), 1);
  from.z.assign(static_cast<std::size_t>(descriptor.size()), 0.0);
  from.k = from.z;
  sources.evaluate(0.0, from.w);
  constexpr double h = 1e-5;
  Stepper::Trial trial;
  const auto take_step = [&] {
    stepper.tr_bdf2(from, h, scale, trial);
    if (trial.solved != Solved::yes || stepper.improve(h, trial) != Solved::yes) throw std::runtime_error("the step fails");
    benchmark::DoNotOptimize(trial.error);
  };
  for (auto _ : state) take_step();
  using Clock = std::chrono::steady_clock;
  const Factor* factor = factors.at(1.0 / (diagonal * h), from.on);
  constexpr int repeats = 20;
  std::vector<double> right = trial.end.k;
  const auto begun = Clock::now();
  for (int i = 0; i < repeats; ++i) take_step();
  const auto between = Clock::now();
  for (int i = 0; i < repeats; ++i) {
    factor->solve(right);
    benchmark::DoNotOptimize(right.data());
  }
  state.counters["solves"] = std::chrono::duration<double>(between - begun) / std::chrono::duration<double>(Clock::now() - between);
  state.counters["unknowns"] = descriptor.size();
}

BENCHMARK(step)->Args({10, 2})->Args({32, 10})->Args({100, 30})->Args({316, 1000})->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
