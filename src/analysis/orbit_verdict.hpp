#pragma once
/// What the search for an orbit has found, in words.

#include <string>
#include <utility>
#include <vector>

#include "analysis/steady_state_result.hpp"

namespace pwlsim::analysis {

/// Bound of | |λ| − 1 | below which the orbit is marginal.
inline constexpr double marginal_multiplier = 1e-9;

/// After a search: whether there is an orbit, the error if there is none, and remarks on the orbit. Nothing if the search has failed before.
void judge_orbit(const circuit::SteadyStateAnalysis& card, SteadyState& state);

/// "on=S1", "when v(a)=1 rise".
[[nodiscard]] std::string trigger_text(const circuit::SteadyStateAnalysis& card);
/// The stores that a direction changes, with their shares of its energy, the largest first.
[[nodiscard]] std::vector<std::pair<std::string, double>> shares_of(const SteadyState& state, const Eigen::VectorXcd& direction);
/// "stable", "unstable", "marginal"; "" where it is not known.
[[nodiscard]] std::string stability_of(const steady::Orbit& orbit);
/// "orbit of buck.csv: period 5 µs, …".
[[nodiscard]] std::string orbit_summary(const SteadyState& state, const std::string& output);

}  // namespace pwlsim::analysis
