#pragma once
/// Orbits of circuits without periodic sources: finds an event that recurs, and the fixed point of its return map.

#include <optional>
#include <string_view>

#include "steady/orbit.hpp"

namespace pwlsim::steady {

struct SelfTimedTask {
  OrbitTask orbit;                 ///< period and section are filled in
  std::optional<Section> section;  ///< none: the first change of mode that recurs
  double hint = 0.0;               ///< s, a guess of the period; 0: none
  double horizon = 0.0;            ///< s, a time within which an event occurs; 0: taken from the time constants
  double settling_time = 0.0;      ///< s, simulated before
};

/// Verdict::no_event if the circuit settles to a constant state, or the section's event does not recur.
[[nodiscard]] Orbit find_self_timed_orbit(engine::March& march, const engine::RunState& start, const SelfTimedTask& task);

/// The event at which the switch or diode of that name (compared without case) closes or opens; none if it has no port in the model.
[[nodiscard]] std::optional<Section> section_of(const engine::ExactModel& model, std::string_view element, bool closes);

}  // namespace pwlsim::steady
