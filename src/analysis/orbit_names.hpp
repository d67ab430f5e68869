#pragma once
/// States and modes of an orbit by the names of the deck.

#include <functional>
#include <string>
#include <vector>

#include "circuit/circuit.hpp"
#include "engine/exact/exact_model.hpp"
#include "steady/orbit.hpp"

namespace pwlsim::analysis {

/// A store: "v(C1)" with its value.
struct NamedState {
  std::string name, unit;
  double value = 0.0;
};

/// The mode from an instant of the period on.
struct OrbitMode {
  double time = 0.0;  ///< s
  std::vector<std::string> closed, conducting;
  std::string event;  ///< "S1 closes, D1 blocks"; "" if nothing changes
  bool has_jump = false;
};

/// The stores just after t = 0.
[[nodiscard]] std::vector<NamedState> states_after_start(const engine::ExactModel& model, const steady::Trace& trace);
/// The modes of the period in order; elements of `hidden` are left out.
/// Events at the end of the period are those at t = 0.
[[nodiscard]] std::vector<OrbitMode> orbit_modes(const engine::ExactModel& model, const circuit::HiddenParts& hidden,
                                                 const steady::Trace& trace, double period);

/// The name of a coordinate of the stacked state.
[[nodiscard]] std::string coordinate_name(const engine::ExactModel& model, std::size_t coordinate);
/// The diode or switch of a row of guards.
[[nodiscard]] std::string guard_name(const engine::ExactModel& model, std::size_t island, int row);
/// The charge in C or flux in Vs that a change of the stacked state adds to the store that it changes most; named after the element.
[[nodiscard]] NamedState largest_change(const engine::ExactModel& model, const steady::Vector& direction);
/// Shares of energy by names, those of coordinates given.
[[nodiscard]] std::vector<std::pair<std::string, double>> shares_by_name(const Eigen::VectorXcd& direction,
                                                                         const std::function<std::string(std::size_t)>& name_of);
/// The stores that a direction of the stacked state changes, with their shares of its energy, the largest first.
[[nodiscard]] std::vector<std::pair<std::string, double>> shares_of(const engine::ExactModel& model, const Eigen::VectorXcd& direction);

}  // namespace pwlsim::analysis
