#include "analysis/orbit_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/quantity.hpp"
#include "analysis/segment_names.hpp"
#include "base/names.hpp"
#include "steady/touches.hpp"

namespace pwlsim::analysis {
namespace {

using Trigger = circuit::SteadyStateAnalysis::Trigger;
using steady::Orbit;
using steady::Verdict;

constexpr double doubtful_orbit = 1e-9;  ///< of the largest of a unit: what orbits by segments agree to

class OrbitJudge {
 public:
  OrbitJudge(const circuit::SteadyStateAnalysis& card, SteadyState& state) : card_(card), state_(state) {}

  void run() {
    const Orbit& orbit = state_.orbit;
    switch (orbit.verdict) {
      case Verdict::found:
        state_.is_found = true;
        return remark_on_orbit();
      case Verdict::no_orbit:
        return fail("E-pss-no-orbit", no_orbit_text());
      case Verdict::drifts:
        fail("E-pss-not-converged",
             fmt::format("no orbit was found: each period still adds {} after {} periods", drift_text(), orbit.periods_simulated));
        break;
      case Verdict::not_converged:
        fail("E-pss-not-converged", not_converged_text());
        break;
      case Verdict::no_event:
        return fail_without_event();
      case Verdict::run_failed:
        return fail(orbit.answer.id, "on the way to the orbit, " + orbit.answer.message);
      case Verdict::interrupted:
        return fail("E-interrupted", "interrupted before the orbit was found; there are no rows of it");
    }
    state_.has_best_attempt = has_segments() || !orbit.trace.steps.empty();
  }

 private:
  void fail(std::string id, std::string message) {
    state_.id = std::move(id);
    state_.message = std::move(message);
  }
  void say(Severity severity, std::string id, std::string text) {
    state_.messages.push_back({severity, std::move(id), {}, std::move(text)});
  }
  [[nodiscard]] bool has_segments() const { return state_.map != nullptr; }

  [[nodiscard]] std::string no_orbit_text() const {
    if (!state_.orbit.drift_turns)
      return fmt::format("there is no periodic orbit: each period adds {}, and nothing limits it", drift_text());
    return fmt::format(
        "there is no periodic orbit: the sources drive a resonance without losses, each period adds {}, and nothing limits it",
        drift_text());
  }

  void fail_without_event() {
    if (card_.trigger == Trigger::none)
      fail("E-pss-no-oscillation", "the circuit has no periodic source and settles to a constant state; try .op for its operating point");
    else
      fail("E-pss-no-trigger", fmt::format("the event of {} does not recur within {}; try another one, or tstab=", trigger_text(card_),
                                           quantity(state_.orbit.answer.time, "s")));
  }

  [[nodiscard]] std::string not_converged_text() const {
    constexpr std::size_t most_residuals = 4, most_states = 6;
    const Orbit& orbit = state_.orbit;
    const auto listed = static_cast<std::ptrdiff_t>(std::min(most_residuals, orbit.residuals.size()));
    const std::vector<double> last(orbit.residuals.end() - listed, orbit.residuals.end());
    std::vector<std::string> states;
    if (has_segments() || !orbit.trace.steps.empty())
      for (const NamedState& s : has_segments() ? states_after_start(*state_.map) : states_after_start(*state_.model, orbit.trace))
        if (states.size() < most_states) states.push_back(fmt::format("{} = {}", s.name, quantity(s.value, s.unit)));
    std::string text = fmt::format("no orbit of period {} was found in {} and {}; the last residuals are {:.2g}",
                                   quantity(orbit.period, "s"), counted(static_cast<std::uint64_t>(orbit.iterations), "Newton step"),
                                   counted(static_cast<std::uint64_t>(orbit.periods_simulated), "period"), fmt::join(last, ", "));
    if (!states.empty()) text += fmt::format("; the best attempt, whose rows are written, begins at {}", fmt::join(states, ", "));
    if (orbit.repeats_modes) return text + "; its modes repeat from period to period; try tstab=, or maxperiods=";
    const int k = card_.multiple;
    return text + fmt::format("; its modes differ from period to period (chaos?); try k={}, k={}, k={}, tstab=, or maxperiods=", 2 * k,
                              3 * k, 4 * k);
  }

  [[nodiscard]] std::string drift_text() const {
    const NamedState added =
        has_segments() ? largest_change(*state_.map, state_.orbit.drift) : largest_change(*state_.model, state_.orbit.drift);
    return fmt::format("{} to {}", quantity(added.value, added.unit), added.name);
  }

  void remark_on_orbit() {
    remark_on_kinks();
    const Orbit& orbit = state_.orbit;
    if (!orbit.free_directions.empty() && orbit.kink.empty()) {
      std::vector<std::string> names;
      for (const steady::Vector& direction : orbit.free_directions)
        names.push_back(shares_of(state_, direction.cast<std::complex<double>>()).front().first);
      say(Severity::note, "N-pss-not-unique",
          fmt::format("the orbit is one of a family (multiplier 1): the offset of {} is not determined; it is kept from the start",
                      fmt::join(names, ", ")));
    }
    if (orbit.repeats_after > 0)
      say(Severity::note, "N-pss-shorter-period",
          fmt::format("the orbit found for k={} has the period {}, that of k={}", state_.multiple,
                      quantity(orbit.period * orbit.repeats_after / state_.multiple, "s"), orbit.repeats_after));
    if (spectral_radius(orbit) > 1.0 + marginal_multiplier) say(Severity::warning, "W-pss-unstable", instability_text(orbit));
  }

  /// Where multipliers are not known, or those of one side.
  void remark_on_kinks() {
    const Orbit& orbit = state_.orbit;
    if (!orbit.kink.empty())
      say(Severity::warning, "W-pss-graze",
          fmt::format("the orbit has no derivative here: {}; multipliers and stability are not known", orbit.kink));
    if (!orbit.unknown_stability.empty())
      say(Severity::warning, "W-pss-graze", fmt::format("the orbit's stability is not known: {}", orbit.unknown_stability));
    if (orbit.uncertainty > doubtful_orbit)
      say(Severity::warning, "W-pss-inexact",
          "the orbit is known to fewer than nine digits of its largest voltage or current: rounding of a period moves it; try --engine "
          "modes");
    for (const steady::NamedBeside& beside : orbit.named_beside)
      say(Severity::warning, "W-pss-graze", beside_text(beside.name, beside.time));
    for (const steady::Touch& touch : steady::touches(orbit.trace))
      say(Severity::warning, "W-pss-graze",
          fmt::format("the orbit touches, but does not cross, the threshold of {} at t = {}: multipliers are those of one side",
                      guard_name(*state_.model, touch.island, touch.guard), quantity(touch.time, "s")));
    for (const steady::Beside& beside : orbit.beside)
      say(Severity::warning, "W-pss-graze", beside_text(guard_name(*state_.model, beside.island, beside.guard), beside.time));
  }

  static std::string beside_text(const std::string& name, double time) {
    return fmt::format(
        "the orbit reaches the threshold of {} at t = {} exactly when another event happens: multipliers are those of one side", name,
        quantity(time, "s"));
  }

  static std::string instability_text(const Orbit& orbit) {
    const auto worst = std::find_if(orbit.multipliers.begin(), orbit.multipliers.end(), [](const auto& m) { return !m.trivial; });
    const std::complex<double> value = worst->value;
    const double growth = 100.0 * (std::abs(value) - 1.0);
    if (value.imag() != 0.0)
      return fmt::format("the orbit is unstable: multiplier {:.4g}{:+.4g}j, a slow oscillation of {} grows by {:.3g} % a period",
                         value.real(), value.imag(), quantity(std::abs(std::arg(value)) / (2.0 * std::numbers::pi * orbit.period), "Hz", 3),
                         growth);
    if (value.real() < 0.0)
      return fmt::format(
          "the orbit is unstable: multiplier {:.4g}, the period doubles; try slope compensation, or k=2 for the doubled orbit",
          value.real());
    return fmt::format("the orbit is unstable: multiplier {:.4g}, a deviation runs away by {:.3g} % a period", value.real(), growth);
  }

  const circuit::SteadyStateAnalysis& card_;
  SteadyState& state_;
};

}  // namespace

std::string trigger_text(const circuit::SteadyStateAnalysis& card) {
  using Kind = circuit::SteadyStateAnalysis::Trigger;
  if (card.trigger == Kind::crosses) return fmt::format("when {}={} {}", card.element, card.level, card.is_falling ? "fall" : "rise");
  return fmt::format("{}={}", card.trigger == Kind::closes ? "on" : "off", card.element);
}

void judge_orbit(const circuit::SteadyStateAnalysis& card, SteadyState& state) {
  if (state.id.empty()) OrbitJudge(card, state).run();
}

std::vector<std::pair<std::string, double>> shares_of(const SteadyState& state, const Eigen::VectorXcd& direction) {
  if (!state.map) return shares_of(*state.model, direction);
  return shares_by_name(direction, [&](std::size_t coordinate) { return state.map->stores()[coordinate].name; });
}

std::string stability_of(const Orbit& orbit) {
  if (!orbit.kink.empty() || !orbit.unknown_stability.empty()) return "";
  const double radius = steady::spectral_radius(orbit);
  return radius > 1.0 + marginal_multiplier ? "unstable" : radius < 1.0 - marginal_multiplier ? "stable" : "marginal";
}

std::string orbit_summary(const SteadyState& state, const std::string& output) {
  const Orbit& orbit = state.orbit;
  const double radius = steady::spectral_radius(orbit);
  std::string stability = stability_of(orbit);
  if (stability.empty()) {
    stability = "its stability is not known";
  } else {
    stability += fmt::format(", largest multiplier {:.3g}", radius);
    if (radius < 1.0 - marginal_multiplier && radius > 0.01)
      stability += fmt::format(" (settles in {} to 1 %)",
                               counted(static_cast<std::uint64_t>(std::ceil(std::log(0.01) / std::log(radius))), "period"));
  }
  return fmt::format("orbit of {}: period {}, {}, {}, residual {:.1g}; {}\n", output, quantity(orbit.period, "s"),
                     counted(static_cast<std::uint64_t>(orbit.iterations), "Newton step"),
                     counted(static_cast<std::uint64_t>(orbit.periods_simulated), "period"), orbit.residual, stability);
}

}  // namespace pwlsim::analysis
