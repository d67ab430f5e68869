#pragma once
/// Orbits of driven circuits, those of several source periods among them.

#include "steady/orbit.hpp"

namespace pwlsim::steady {

/// Newton's method on k periods also finds orbits that repeat sooner. If it has, the search restarts from a run of many periods, then from beside
/// that orbit, along its eigenvector of the largest negative multiplier.
[[nodiscard]] Orbit find_driven_orbit(engine::March& march, const engine::RunState& start, const OrbitTask& task);

/// The divisor of its `task.multiple` periods after which the orbit closes, `task.period` being that of all of them; 0: it takes all of them.
[[nodiscard]] int repeats_after(engine::March& march, const Orbit& orbit, const OrbitTask& task);

}  // namespace pwlsim::steady
