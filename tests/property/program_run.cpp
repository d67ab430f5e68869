#include "property/program_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>

#include "engine/exact/exact.hpp"
#include "engine/sparse/sparse.hpp"
#include "property/independent.hpp"

namespace pwlsim::test {
namespace {

constexpr double patience = 5.0;  ///< s of the processor's time, which other programs do not take; runs need about a millisecond

struct KeptRows : engine::RowSink {
  bool write(std::span<const double> values, std::size_t count) override {
    const std::size_t width = values.size() / count;
    for (std::size_t i = 0; i < count; ++i)
      rows.emplace_back(values.begin() + static_cast<long>(i * width), values.begin() + static_cast<long>((i + 1) * width));
    return true;
  }
  std::vector<std::vector<double>> rows;  ///< time, states
};

/// The linear equations have no unique solution whatever the diodes do: no state, or no current or voltage, follows.
bool is_structural(const std::string& id) { return id == "E-floating" || id == "E-source-loop" || id == "E-source-cutset"; }

/// Of this thread.
double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Runs an engine, `run(request, rows)`, with uic.
template <class Engine>
ProgramRun run_engine(const std::vector<double>& times, bool events, const Engine& engine_run) {
  ProgramRun run;
  const double start = processor_seconds();
  std::atomic<int> interrupt{0};
  engine::Request request;
  request.stop = times.back();
  request.grid = {[&](std::uint64_t k) { return times[k]; }, times.size()};
  request.events = events;
  request.use_initial_conditions = true;
  request.interrupt = &interrupt;
  request.progress = [&](double) {
    if (processor_seconds() - start > patience) interrupt = 1;
  };
  KeptRows rows;
  run.answer = engine_run(request, rows);
  run.rows = std::move(rows.rows);
  if (run.answer.outcome == engine::Outcome::interrupted)
    run.finding = {Finding::Kind::wrong, "too slow", fmt::format("t = {} of {} after {} s", run.answer.time, times.back(), patience)};
  else if (run.answer.outcome != engine::Outcome::completed)
    run.finding = {Finding::Kind::wrong, run.answer.id, run.answer.message};
  return run;
}

}  // namespace

ProgramRun run_program(const model::Network& network, const std::vector<double>& times, bool events) {
  Diagnostics diagnostics;
  const auto model = engine::prepare(network, diagnostics);
  if (!model) {
    const Diagnostic& first = diagnostics.all().front();
    return {{is_structural(first.id) ? Finding::Kind::refused : Finding::Kind::wrong, first.id, first.text}, {}, {}};
  }
  return run_engine(times, events,
                    [&](const engine::Request& request, engine::RowSink& rows) { return engine::run(*model, request, rows); });
}

ProgramRun run_program_sparse(const model::Network& network, const std::vector<double>& times, double reltol) {
  Diagnostics diagnostics;
  const auto model = engine::sparse::prepare(network, diagnostics);
  if (!model) return {{Finding::Kind::refused, diagnostics.all().front().id, diagnostics.all().front().text}, {}, {}};
  return run_engine(times, false, [&](const engine::Request& request, engine::RowSink& rows) {
    return engine::sparse::run(*model, request, reltol, rows);
  });
}

ProgramRun run_program_segments(const model::Network& network, const std::vector<double>& times, double shift_factor) {
  Diagnostics diagnostics;
  const auto model = engine::sparse::prepare(network, diagnostics);
  if (!model) return {{Finding::Kind::refused, diagnostics.all().front().id, diagnostics.all().front().text}, {}, {}};
  return run_engine(times, false, [&](const engine::Request& request, engine::RowSink& rows) {
    return engine::sparse::run_segments(*model, request, engine::sparse::segment_tolerance, rows, shift_factor);
  });
}

double energy_distance(const RandomNetwork& network, const ProgramRun& a, const ProgramRun& b, LeastStates least) {
  const auto states = states_of(network);
  double largest = 0.0, farthest = 0.0;
  for (const NetworkPart& state : states) {
    const double smallest = state.kind == NetworkPart::Kind::capacitor ? least.voltage : least.current;
    largest += state.value * (state.initial * state.initial + smallest * smallest);
  }
  for (std::size_t k = 0; k < a.rows.size(); ++k) {
    double energy = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      energy += states[i].value * std::pow(a.rows[k][i + 1], 2);
      difference += states[i].value * std::pow(a.rows[k][i + 1] - b.rows[k][i + 1], 2);
    }
    largest = std::max(largest, energy);
    farthest = std::max(farthest, difference);
  }
  return largest > 0.0 ? std::sqrt(farthest / largest) : 0.0;
}

}  // namespace pwlsim::test
