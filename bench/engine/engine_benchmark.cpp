/// What a run of the exact engine costs in a process that is warm: a whole run per event, a row, a mode.
///
///     cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DPWLSIM_BENCH=ON && ninja -C build bench_engine && build/bench/bench_engine

#include <benchmark/benchmark.h>

#include <optional>
#include <stdexcept>

#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "engine/exact/exact_model.hpp"
#include "model/build_mode.hpp"
#include "netlist/load.hpp"

namespace {

using namespace pwlsim;

class Nowhere : public engine::RowSink {
 public:
  bool write(std::span<const double> values, std::size_t /*count*/) override {
    benchmark::DoNotOptimize(values.data());
    return true;
  }
};

struct Case {
  circuit::Compiled compiled;
  std::shared_ptr<const engine::ExactModel> model;
};

Case load(const std::string& name) {
  SourceStore sources;
  Diagnostics diagnostics;
  const netlist::Loaded loaded = netlist::load(std::string(PWLSIM_SOURCE_DIR "/netlists/") + name + ".net", sources, diagnostics);
  std::optional<circuit::Compiled> compiled = circuit::compile(loaded.deck, sources, diagnostics);
  if (!compiled) throw std::runtime_error(name + " does not compile");
  auto model = engine::prepare(compiled->network, diagnostics);
  if (!model) throw std::runtime_error(name + " has no model");
  return {std::move(*compiled), std::move(model)};
}

engine::Statistics run(const Case& c, std::uint64_t rows) {
  engine::Request request;
  request.stop = c.compiled.analyses.transient->stop.seconds;
  request.grid.rows = rows;
  request.grid.time = [stop = request.stop, last = static_cast<double>(rows - 1)](std::uint64_t k) {
    return stop * (static_cast<double>(k) / last);
  };
  request.use_initial_conditions = c.compiled.analyses.transient->use_initial_conditions;
  Nowhere nowhere;
  return engine::run(*c.model, request, nowhere).statistics;
}

/// Two rows only: the time of `simulate` by event, modes built anew in every run.
void events(benchmark::State& state, const std::string& name) {
  const Case c = load(name);
  double seconds = 0.0;
  double count = 0.0;
  for (auto _ : state) {
    const engine::Statistics statistics = run(c, 2);
    seconds += statistics.seconds_simulate;
    count += static_cast<double>(statistics.events);
    state.SetIterationTime(statistics.seconds_simulate);
  }
  state.counters["ns_per_event"] = 1e9 * seconds / count;
}

/// What a row adds to a run.
void rows(benchmark::State& state, const std::string& name) {
  constexpr std::uint64_t many = 20001;
  const Case c = load(name);
  double seconds = 0.0;
  double count = 0.0;
  for (auto _ : state) {
    const double added = run(c, many).seconds_simulate - run(c, 2).seconds_simulate;
    seconds += added;
    count += static_cast<double>(many - 2);
    state.SetIterationTime(added);
  }
  state.counters["ns_per_row"] = 1e9 * seconds / count;
}

/// Every mode of every island, regular or not.
void modes(benchmark::State& state, const std::string& name) {
  const Case c = load(name);
  double count = 0.0;
  for (auto _ : state)
    for (const auto& island : c.model->islands) {
      const model::System& system = island.extraction.system;
      for (unsigned bits = 0; bits < (1U << system.ports); ++bits) {
        model::IndexSet set(system.ports);
        for (int i = 0; i < system.ports; ++i) set.set(i, ((bits >> i) & 1U) != 0);
        benchmark::DoNotOptimize(model::build_mode(system, set));
        ++count;
      }
    }
  state.counters["modes"] = benchmark::Counter(count, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

}  // namespace

int main(int argc, char** argv) {
  for (const char* name :
       {"fullwave", "buck", "buck_dcm", "boost", "flyback", "flyback_ideal", "six_pulse", "hbridge", "hysteretic_buck"}) {
    benchmark::RegisterBenchmark((std::string("events/") + name).c_str(), [name](benchmark::State& s) {
      events(s, name);
    })->UseManualTime();
    benchmark::RegisterBenchmark((std::string("rows/") + name).c_str(), [name](benchmark::State& s) { rows(s, name); })->UseManualTime();
    benchmark::RegisterBenchmark((std::string("modes/") + name).c_str(), [name](benchmark::State& s) { modes(s, name); });
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
