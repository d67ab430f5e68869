#pragma once
/// Periodic orbits of driven circuits on Krylov segments: Newton's method as in orbit.hpp, where the derivative Φ of the map over a period is known by its products alone. Each
/// step  (I − Φ) δ = φ(x) − x  is solved by GMRES; the largest multipliers are those of Arnoldi's method. Φ·v follows v along the recorded segments
/// (engine/sparse/segment_deviation.hpp).

#include "engine/sparse/period_map.hpp"
#include "steady/orbit.hpp"

namespace pwlsim::steady {

/// `task.period` > 0. `state`: the start, and then the orbit's own state just before t = 0. Of the result `begin`, `trace`, `monodromy` and `beside` are empty; directions
/// are those of PeriodMap::energies.
[[nodiscard]] Orbit find_segment_orbit(engine::sparse::PeriodMap& map, engine::sparse::PeriodMap::State& state, const OrbitTask& task);

}  // namespace pwlsim::steady
