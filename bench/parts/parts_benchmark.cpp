/// What the parts of a run cost by themselves, in a process that is warm: reading a deck, making a model of it, one complementarity
/// problem, one propagation, one row of CSV.
///
///     cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DPWLSIM_BENCH=ON && ninja -C build bench_parts && build/bench/bench_parts

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "lcp/lemke.hpp"
#include "lcp/newton_min.hpp"
#include "linalg/exponential.hpp"
#include "netlist/load.hpp"
#include "waveform/csv.hpp"

namespace {

using namespace pwlsim;
using linalg::Matrix;
using linalg::Vector;

constexpr unsigned seed = 20251;

/// A ladder of `sections` resistors and capacitors with a diode at its end: two cards a section.
std::string ladder(std::int64_t sections) {
  std::string text = "ladder\nV1 n0 0 SIN(0 10 1k)\n";
  for (std::int64_t i = 1; i <= sections; ++i) text += fmt::format("R{0} n{1} n{0} 4.7k\nC{0} n{0} 0 10n\n", i, i - 1);
  return text + fmt::format("D1 n{} out DI\nR out 0 1meg\n.model DI D\n.tran 1u 1m\n.end\n", sections);
}

void parse(benchmark::State& state) {
  const std::string text = ladder(state.range(0));
  for (auto _ : state) {
    SourceStore sources;
    Diagnostics diagnostics;
    benchmark::DoNotOptimize(netlist::parse("ladder", text, sources, diagnostics));
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * text.size()));
}

void compile(benchmark::State& state) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Deck deck = netlist::parse("ladder", ladder(state.range(0)), sources, diagnostics);
  for (auto _ : state) benchmark::DoNotOptimize(circuit::compile(deck, sources, diagnostics));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * 2 * state.range(0));
}

/// From the network to A, B, C, D of its islands.
void extract(benchmark::State& state, const std::string& path) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Loaded loaded = netlist::load(path, sources, diagnostics);
  const auto compiled = circuit::compile(loaded.deck, sources, diagnostics);
  if (!compiled) throw std::runtime_error(path + " does not compile");
  for (auto _ : state) benchmark::DoNotOptimize(engine::prepare(compiled->network, diagnostics));
}

struct Problem {
  Matrix m;
  Vector q;
};

/// Positive definite, with a solution in which about half of the ports are active.
Problem random_problem(Eigen::Index ports) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto fill = [&](auto& x) { x = x.unaryExpr([&](double) { return normal(random); }); };
  Matrix root(ports, ports);
  Vector q(ports);
  fill(root);
  fill(q);
  return {root * root.transpose() + Matrix::Identity(ports, ports), q};
}

template <typename Solve>
void complementarity(benchmark::State& state, const Solve& solve) {
  const Problem problem = random_problem(state.range(0));
  int pivots = 0;
  for (auto _ : state) {
    const lcp::Solution solution = solve(problem.m, problem.q);
    if (solution.status != lcp::Status::solved) throw std::runtime_error("a definite problem was not solved");
    pivots = solution.pivots;
  }
  state.counters["pivots"] = pivots;
}

/// e^{Aτ}y for a stable A, τ of half its fastest time: a new τ each time, or one that recurs.
void propagate(benchmark::State& state, bool recurs) {
  const auto size = static_cast<Eigen::Index>(state.range(0));
  const Matrix a = -random_problem(size).m;
  const double rate = linalg::norm_bound(a);
  const linalg::Exponential flow(a, rate);
  Vector y = Vector::Ones(size), work(2 * size);
  double tau = 0.5 / rate;
  for (auto _ : state) {
    Vector z = y;
    if (recurs)
      flow.apply(tau, z.data(), work.data());
    else
      flow.apply_once(tau, z.data(), work.data());
    benchmark::DoNotOptimize(z.data());
    if (!recurs) tau *= 0.999999;
  }
}

/// A line of five numbers with all their digits.
void csv_row(benchmark::State& state) {
  double time = 0.0;
  std::string text;
  for (auto _ : state) {
    text.clear();
    time += 1e-6 / 3.0;
    const double values[] = {time, 325.0 * std::sin(time), std::exp(-time), 1.0 / (1.0 + time), -time * time};
    waveform::append_csv_row(text, "", values);
    benchmark::DoNotOptimize(text.data());
  }
}

}  // namespace

BENCHMARK(parse)->Arg(100)->Arg(10000);
BENCHMARK(compile)->Arg(100)->Arg(10000);
BENCHMARK_CAPTURE(extract, buck, PWLSIM_SOURCE_DIR "/netlists/buck.net");
BENCHMARK_CAPTURE(extract, six_pulse, PWLSIM_SOURCE_DIR "/netlists/six_pulse.net");
BENCHMARK_CAPTURE(complementarity, lemke, [](const Matrix& m, const Vector& q) { return lcp::lemke(m, q); })->Arg(4)->Arg(12)->Arg(40);
BENCHMARK_CAPTURE(complementarity, newton, [](const Matrix& m, const Vector& q) { return lcp::newton_min(m, q); })
    ->Arg(4)
    ->Arg(12)
    ->Arg(40);
BENCHMARK_CAPTURE(propagate, new_interval, false)->Arg(3)->Arg(6)->Arg(12)->Arg(40);
BENCHMARK_CAPTURE(propagate, recurring_interval, true)->Arg(3)->Arg(6)->Arg(12)->Arg(40);

BENCHMARK(csv_row);

BENCHMARK_MAIN();
