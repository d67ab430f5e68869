#pragma once
/// Orbits on Krylov segments by the names of the deck, as orbit_names.hpp has those on dense modes.

#include <string>
#include <utility>
#include <vector>

#include "analysis/orbit_names.hpp"
#include "engine/sparse/period_map.hpp"

namespace pwlsim::analysis {

/// The stores just after t = 0, of the run that the map has kept.
[[nodiscard]] std::vector<NamedState> states_after_start(const engine::sparse::PeriodMap& map);
/// The modes of that run in order; elements of `hidden` are left out. Events at the end of the period are those at t = 0.
[[nodiscard]] std::vector<OrbitMode> orbit_modes(const engine::sparse::PeriodMap& map, const circuit::HiddenParts& hidden);
/// The charge in C or flux in Vs that a direction adds to the store that it changes most; named after the element.
[[nodiscard]] NamedState largest_change(const engine::sparse::PeriodMap& map, const steady::Vector& direction);

}  // namespace pwlsim::analysis
