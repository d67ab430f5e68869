#include <numbers>

#include "analysis/orbit_verdict.hpp"
#include "analysis/steady_state.hpp"

namespace pwlsim::analysis {
namespace {

std::string names_json(const std::vector<std::string>& names) {
  std::vector<std::string> list;
  for (const std::string& name : names) list.push_back(json_string(name));
  return json_line(list);
}

std::string shares_json(const std::vector<std::pair<std::string, double>>& shares, std::string_view key) {
  std::vector<std::string> list;
  for (const auto& [name, share] : shares) list.push_back(json_line({{"name", json_string(name)}, {key, json_number(share)}}));
  return json_line(list);
}

std::string multiplier_json(const SteadyState& state, const steady::Multiplier& m) {
  constexpr double two_pi = 2.0 * std::numbers::pi;
  const std::string residual = state.orbit.has_leading_only ? json_number(m.residual) : "null";
  return json_line({{"re", json_number(m.value.real())},
                    {"im", json_number(m.value.imag())},
                    {"abs", json_number(std::abs(m.value))},
                    {"arg", json_number(std::arg(m.value))},
                    {"trivial", json_truth(m.trivial)},
                    {"frequency", json_number(std::arg(m.value) / (two_pi * state.orbit.period))},
                    {"residual", residual},
                    {"states", shares_json(shares_of(state, m.direction), "share")}});
}

std::string source_json(const steady::PeriodicSource& source) {
  return json_line({{"name", json_string(source.name)}, {"period", json_number(source.period)}, {"cycles", std::to_string(source.cycles)}});
}

std::string state_json(const NamedState& s) {
  return json_line({{"name", json_string(s.name)}, {"value", json_number(s.value)}, {"unit", json_string(s.unit)}});
}

std::string orbit_mode_json(const OrbitMode& mode) {
  return json_line({{"time", json_number(mode.time)},
                    {"closed", names_json(mode.closed)},
                    {"conducting", names_json(mode.conducting)},
                    {"event", json_string(mode.event)},
                    {"jump", json_truth(mode.has_jump)}});
}

/// A member that is an array, one line an item.
template <class List, class ToJson>
void member_list(JsonWriter& json, std::string_view name, const List& list, const ToJson& to_json) {
  json.key(name);
  json.begin_array();
  for (const auto& item : list) json.value(to_json(item));
  json.end_array();
}

}  // namespace

void write_orbit(JsonWriter& json, const SteadyState* state) {
  if (state == nullptr || !state->is_found) return json.member("pss", "null");
  const steady::Orbit& orbit = state->orbit;
  const bool is_driven = !state->common.sources.empty();
  const auto multiplier = [&](const steady::Multiplier& m) { return multiplier_json(*state, m); };
  const auto free = [&](const steady::Vector& direction) {
    return json_line({{"states", shares_json(shares_of(*state, direction.cast<std::complex<double>>()), "weight")}});
  };
  json.key("pss");
  json.begin_object();
  json.member("kind", json_string(is_driven ? "driven" : "autonomous"));
  json.member("period", json_number(orbit.period));
  json.member("multiple", std::to_string(state->multiple));
  member_list(json, "sources", state->common.sources, source_json);
  json.member("residual", json_number(orbit.residual));
  json.member("uncertainty", orbit.has_leading_only ? json_number(orbit.uncertainty) : "null");
  json.member("iterations", std::to_string(orbit.iterations));
  json.member("periods_simulated", std::to_string(orbit.periods_simulated));
  json.member("condition", orbit.has_leading_only ? "null" : json_number(1.0 / orbit.least_singular));
  const std::string stability = stability_of(orbit);
  json.member("stability", stability.empty() ? "null" : json_string(stability));
  json.member("unique", json_truth(orbit.free_directions.empty()));
  json.member("all_multipliers", json_truth(!orbit.has_leading_only));
  member_list(json, "multipliers", orbit.multipliers, multiplier);
  member_list(json, "states", state->states, state_json);
  member_list(json, "free", orbit.free_directions, free);
  member_list(json, "modes", state->modes, orbit_mode_json);
  json.member("phase", json_string(is_driven ? "t = 0 is where the periods of the sources begin" : "t = 0 is just after " + orbit.section));
  json.end_object();
}

}  // namespace pwlsim::analysis
