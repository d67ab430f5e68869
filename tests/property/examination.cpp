#include "property/examination.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "property/independent.hpp"
#include "property/program_run.hpp"

namespace pwlsim::test {
namespace {

using Kind = NetworkPart::Kind;

constexpr double certificate_bound = 1e-9;    ///< relative residuals
constexpr double run_agreement = 1e-9;        ///< of two runs, relative to the largest value of a signal
constexpr double rounding_of_zero = 0x1p-49;  ///< of 10 V or 10 mA, eight units of the last place: rounding of a state that is zero
constexpr double small_share = 1e-3;          ///< see scales()
constexpr double energy_slack = 1e-11;  ///< of the energy at the start: rounding in proportion to the radians of a lossless run, some 10⁴
constexpr std::uint64_t steps = 60;

std::vector<double> equal_steps(double stop, std::uint64_t count) {
  std::vector<double> times;
  for (std::uint64_t k = 0; k < count; ++k) times.push_back(stop * static_cast<double>(k) / static_cast<double>(count));
  times.push_back(stop);
  return times;
}

Finding check_certificate(const engine::Certificate& c) {
  const auto detail =
      fmt::format("complementarity {:.2g}, KCL/KVL {:.2g}, energy {:.2g}, passive {}", c.complementarity, c.kcl_kvl, c.energy, c.passive);
  if (!(c.complementarity <= certificate_bound)) return {Finding::Kind::wrong, "certificate: complementarity", detail, c};
  if (!(c.kcl_kvl <= certificate_bound)) return {Finding::Kind::wrong, "certificate: KCL/KVL", detail, c};
  if (!(c.energy <= certificate_bound)) return {Finding::Kind::wrong, "certificate: energy", detail, c};
  if (!c.passive) return {Finding::Kind::wrong, "certificate: passivity", detail, c};
  return {Finding::Kind::fine, {}, {}, c};
}

double energy_of(const NetworkPart& state, double value) { return 0.5 * state.value * value * value; }

double energy_of(const std::vector<NetworkPart>& states, const std::vector<double>& row) {
  double sum = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) sum += energy_of(states[i], row[i + 1]);
  return sum;
}

double energy_at_start(const std::vector<NetworkPart>& states) {
  double sum = 0.0;
  for (const NetworkPart& state : states) sum += energy_of(state, state.initial);
  return sum;
}

/// What an error of a state is measured by: the largest voltage or current of any state of its kind, but not less than a small share of
/// what the state would be if it held all the energy there ever is: beside that it is rounding.
std::vector<double> scales(const std::vector<NetworkPart>& states, const std::vector<std::vector<double>>& rows) {
  double energy = energy_at_start(states), voltage = 0.0, current = 0.0;
  for (const auto& row : rows) {
    energy = std::max(energy, energy_of(states, row));
    for (std::size_t i = 0; i < states.size(); ++i) {
      double& largest = states[i].kind == Kind::capacitor ? voltage : current;
      largest = std::max(largest, std::abs(row[i + 1]));
    }
  }
  std::vector<double> result;
  for (const NetworkPart& state : states)
    result.push_back(std::max(state.kind == Kind::capacitor ? voltage : current, small_share * std::sqrt(2.0 * energy / state.value)));
  return result;
}

/// Compares row k of `a` with row k·stride of `b`.
Finding compare(const RandomNetwork& network, const ProgramRun& a, const ProgramRun& b, std::size_t stride, const char* what) {
  const auto states = states_of(network);
  if (a.rows.size() != steps + 1 || b.rows.size() != stride * steps + 1) return {Finding::Kind::wrong, what, "rows are missing"};
  const auto scale_of = scales(states, a.rows);
  double worst = 0.0;
  std::string detail;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double scale = std::max(scale_of[i], rounding_of_zero / run_agreement * typical_state(states[i]));
    for (std::size_t k = 0; k < a.rows.size(); ++k) {
      const double error = std::abs(a.rows[k][i + 1] - b.rows[k * stride][i + 1]);
      if (error <= worst * scale) continue;
      worst = error / scale;
      detail = fmt::format("{} at t = {}: {} and {}, scale {}", states[i].name, a.rows[k][0], a.rows[k][i + 1], b.rows[k * stride][i + 1],
                           scale);
    }
  }
  return worst <= run_agreement ? Finding{} : Finding{Finding::Kind::wrong, what, detail};
}

Finding check_energy(const RandomNetwork& network, const std::vector<std::vector<double>>& rows) {
  const auto states = states_of(network);
  const double start = energy_at_start(states);
  double before = start;
  for (const auto& row : rows) {
    const double energy = energy_of(states, row);
    if (energy > before + energy_slack * start)
      return {Finding::Kind::wrong, "energy rises",
              fmt::format("at t = {}: from {} to {}, {} at the start", row[0], before, energy, start)};
    before = energy;
  }
  return {};
}

std::vector<int> shuffled(std::size_t size, Random& random) {
  std::vector<int> order(size);
  std::iota(order.begin(), order.end(), 0);
  for (int i = static_cast<int>(size) - 1; i > 0; --i)
    std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(random.whole(0, i))]);
  return order;
}

}  // namespace

Finding examine(const RandomNetwork& network, std::uint64_t seed) {
  const ProgramRun run = run_program(to_model(network), equal_steps(network.stop, steps));
  if (run.finding.kind != Finding::Kind::fine) return run.finding;
  if (!network.has_sources())
    if (Finding finding = check_energy(network, run.rows); finding.kind != Finding::Kind::fine) return finding;

  Random random(seed);
  const auto parts = shuffled(network.parts.size(), random);
  const auto nodes = shuffled(static_cast<std::size_t>(network.nodes), random);
  const ProgramRun renumbered = run_program(to_model(network, parts, nodes), equal_steps(network.stop, steps));
  if (renumbered.finding.kind != Finding::Kind::fine)
    return {Finding::Kind::wrong, "renumbering: " + renumbered.finding.what, renumbered.finding.detail};
  if (Finding finding = compare(network, run, renumbered, 1, "renumbering"); finding.kind != Finding::Kind::fine) return finding;

  const ProgramRun halved = run_program(to_model(network), equal_steps(network.stop, 2 * steps));
  if (halved.finding.kind != Finding::Kind::fine)
    return {Finding::Kind::wrong, "half the step: " + halved.finding.what, halved.finding.detail};
  if (Finding finding = compare(network, run, halved, 2, "half the step"); finding.kind != Finding::Kind::fine) return finding;
  return check_certificate(run.answer.certificate);
}

RandomNetwork minimised(const RandomNetwork& network, std::uint64_t seed, const Finding& finding) {
  return smallest(network, [&](const RandomNetwork& without) {
    const Finding again = examine(without, seed);
    return again.kind == finding.kind && again.what == finding.what;
  });
}

}  // namespace pwlsim::test
