#pragma once
/// Orbits of driven circuits, including those of several source periods.

#include "steady/orbit.hpp"

namespace pwlsim::steady {

/// Newton's method on k periods also finds orbits that repeat sooner. In that case the search restarts from a run of many periods, then from near
/// that orbit, along its eigenvector of the largest negative multiplier.
[[nodiscard]] Orbit find_driven_orbit(engine::March& march, const engine::RunState& start, const OrbitTask& task);

/// The divisor of its `task.multiple` periods after which the orbit repeats (`task.period` is that of all of them); 0: only after all of them.
[[nodiscard]] int repeats_after(engine::March& march, const Orbit& orbit, const OrbitTask& task);

}  // namespace pwlsim::steady
