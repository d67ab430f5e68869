#include "property/examination.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <numeric>

#include "engine/exact/exact.hpp"

namespace pwlsim::test {
namespace {

using Kind = Part::Kind;

constexpr double certificate_bound = 1e-9;  ///< relative residuals
constexpr double agreement = 1e-9;          ///< of two runs, relative to the largest value of a signal
constexpr double nothing = 1e-9;            ///< V or A: less than this is what rounding leaves of sources of volts and milliamperes
constexpr double small_share = 1e-3;        ///< see scales()
constexpr double energy_slack = 1e-11;      ///< of the energy at the start: rounding in proportion to the radians of a lossless run, some 10⁴
constexpr std::uint64_t steps = 60;
constexpr double patience = 5.0;            ///< s of the processor's time, which other programs do not take; runs need about a millisecond

struct Rows : engine::RowSink {
  bool write(std::span<const double> values, std::size_t count) override {
    const std::size_t width = values.size() / count;
    for (std::size_t i = 0; i < count; ++i) rows.emplace_back(values.begin() + static_cast<long>(i * width), values.begin() + static_cast<long>((i + 1) * width));
    return true;
  }
  std::vector<std::vector<double>> rows;  ///< time, states
};

struct Run {
  Finding finding;
  std::vector<std::vector<double>> rows;
  engine::Answer answer;
};

/// The linear equations have no unique solution whatever the diodes do: no state, or no current or voltage, follows.
bool is_structural(const std::string& id) { return id == "E-floating" || id == "E-source-loop" || id == "E-source-cutset"; }

Run simulate(const model::Network& network, double stop, std::uint64_t row_steps) {
  Run run;
  Diagnostics diagnostics;
  const auto model = engine::prepare(network, diagnostics);
  if (!model) {
    const Diagnostic& first = diagnostics.all().front();
    run.finding = {is_structural(first.id) ? Finding::Kind::refused : Finding::Kind::wrong, first.id, first.text};
    return run;
  }
  const std::clock_t start = std::clock();
  std::atomic<int> interrupt{0};
  engine::Request request;
  request.stop = stop;
  request.grid = {[=](std::uint64_t k) { return k == row_steps ? stop : stop * static_cast<double>(k) / static_cast<double>(row_steps); }, row_steps + 1};
  request.use_initial_conditions = true;
  request.interrupt = &interrupt;
  request.progress = [&](double) {
    if (static_cast<double>(std::clock() - start) > patience * CLOCKS_PER_SEC) interrupt = 1;
  };
  Rows rows;
  run.answer = engine::run(*model, request, rows);
  run.rows = std::move(rows.rows);
  if (run.answer.outcome == engine::Outcome::interrupted)
    run.finding = {Finding::Kind::wrong, "too slow", fmt::format("t = {} of {} after {} s", run.answer.time, stop, patience)};
  else if (run.answer.outcome != engine::Outcome::completed)
    run.finding = {Finding::Kind::wrong, run.answer.id, run.answer.message};
  return run;
}

Finding check_certificate(const engine::Certificate& c) {
  const auto detail = fmt::format("complementarity {:.2g}, KCL/KVL {:.2g}, energy {:.2g}, passive {}", c.complementarity, c.kcl_kvl, c.energy, c.passive);
  if (!(c.complementarity <= certificate_bound)) return {Finding::Kind::wrong, "certificate: complementarity", detail};
  if (!(c.kcl_kvl <= certificate_bound)) return {Finding::Kind::wrong, "certificate: KCL/KVL", detail};
  if (!(c.energy <= certificate_bound)) return {Finding::Kind::wrong, "certificate: energy", detail};
  if (!c.passive) return {Finding::Kind::wrong, "certificate: passivity", detail};
  return {};
}

std::vector<Part> states_of(const RandomNetwork& network) {
  std::vector<Part> states;
  std::copy_if(network.parts.begin(), network.parts.end(), std::back_inserter(states), [](const Part& part) { return part.is_state(); });
  return states;
}

double energy_of(const Part& state, double value) { return 0.5 * state.value * value * value; }

double energy_of(const std::vector<Part>& states, const std::vector<double>& row) {
  double sum = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) sum += energy_of(states[i], row[i + 1]);
  return sum;
}

double energy_at_start(const std::vector<Part>& states) {
  double sum = 0.0;
  for (const Part& state : states) sum += energy_of(state, state.initial);
  return sum;
}

/// What an error of a state is measured by: the largest voltage or current of any state of its kind, but not less than a small share of
/// what the state would be if it held all the energy there ever is: beside that it is rounding.
std::vector<double> scales(const std::vector<Part>& states, const std::vector<std::vector<double>>& rows) {
  double energy = energy_at_start(states), voltage = 0.0, current = 0.0;
  for (const auto& row : rows) {
    energy = std::max(energy, energy_of(states, row));
    for (std::size_t i = 0; i < states.size(); ++i) {
      double& largest = states[i].kind == Kind::capacitor ? voltage : current;
      largest = std::max(largest, std::abs(row[i + 1]));
    }
  }
  std::vector<double> result;
  for (const Part& state : states)
    result.push_back(std::max(state.kind == Kind::capacitor ? voltage : current, small_share * std::sqrt(2.0 * energy / state.value)));
  return result;
}

/// Compares row k of `a` with row k·stride of `b`.
Finding compare(const RandomNetwork& network, const Run& a, const Run& b, std::size_t stride, const char* what) {
  const auto states = states_of(network);
  if (a.rows.size() != steps + 1 || b.rows.size() != stride * steps + 1) return {Finding::Kind::wrong, what, "rows are missing"};
  const auto scale_of = scales(states, a.rows);
  double worst = 0.0;
  std::string detail;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double scale = std::max(scale_of[i], nothing);
    for (std::size_t k = 0; k < a.rows.size(); ++k) {
      const double error = std::abs(a.rows[k][i + 1] - b.rows[k * stride][i + 1]);
      if (error <= worst * scale) continue;
      worst = error / scale;
      detail = fmt::format("{} at t = {}: {} and {}, scale {}", states[i].name, a.rows[k][0], a.rows[k][i + 1], b.rows[k * stride][i + 1], scale);
    }
  }
  return worst <= agreement ? Finding{} : Finding{Finding::Kind::wrong, what, detail};
}

Finding check_energy(const RandomNetwork& network, const std::vector<std::vector<double>>& rows) {
  const auto states = states_of(network);
  const double start = energy_at_start(states);
  double before = start;
  for (const auto& row : rows) {
    const double energy = energy_of(states, row);
    if (energy > before + energy_slack * start)
      return {Finding::Kind::wrong, "energy rises", fmt::format("at t = {}: from {} to {}, {} at the start", row[0], before, energy, start)};
    before = energy;
  }
  return {};
}

std::vector<int> shuffled(std::size_t size, Random& random) {
  std::vector<int> order(size);
  std::iota(order.begin(), order.end(), 0);
  for (int i = static_cast<int>(size) - 1; i > 0; --i) std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(random.whole(0, i))]);
  return order;
}

}  // namespace

Finding examine(const RandomNetwork& network, std::uint64_t seed) {
  const Run run = simulate(to_model(network), network.stop, steps);
  if (run.finding.kind != Finding::Kind::fine) return run.finding;
  if (!network.has_sources())
    if (Finding finding = check_energy(network, run.rows); finding.kind != Finding::Kind::fine) return finding;

  Random random(seed);
  const auto parts = shuffled(network.parts.size(), random);
  const auto nodes = shuffled(static_cast<std::size_t>(network.nodes), random);
  const Run renumbered = simulate(to_model(network, parts, nodes), network.stop, steps);
  if (renumbered.finding.kind != Finding::Kind::fine)
    return {Finding::Kind::wrong, "renumbering: " + renumbered.finding.what, renumbered.finding.detail};
  if (Finding finding = compare(network, run, renumbered, 1, "renumbering"); finding.kind != Finding::Kind::fine) return finding;

  const Run halved = simulate(to_model(network), network.stop, 2 * steps);
  if (halved.finding.kind != Finding::Kind::fine) return {Finding::Kind::wrong, "half the step: " + halved.finding.what, halved.finding.detail};
  if (Finding finding = compare(network, run, halved, 2, "half the step"); finding.kind != Finding::Kind::fine) return finding;
  return check_certificate(run.answer.certificate);
}

RandomNetwork minimised(RandomNetwork network, std::uint64_t seed, const Finding& finding) {
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (std::size_t i = 0; i < network.parts.size(); ++i) {
      RandomNetwork without = network;
      without.parts.erase(without.parts.begin() + static_cast<long>(i));
      if (without.parts.empty() || !sources_can_be_met(without)) continue;
      const Finding again = examine(without, seed);
      if (again.kind != finding.kind || again.what != finding.what) continue;
      network = std::move(without);
      smaller = true;
      --i;
    }
  }
  return network;
}

}  // namespace pwlsim::test
