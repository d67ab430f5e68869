#pragma once
/// The start of a run: values of the states and the position of the switches.

#include <optional>
#include <string>
#include <vector>

#include "engine/missing_rest.hpp"
#include "engine/run.hpp"
#include "engine/sparse/controls.hpp"

namespace pwlsim::engine::sparse {

struct PartStart {
  Answer answer;               ///< outcome and remarks
  std::vector<double> states;  ///< in the order of Descriptor::states, in volts
  Position on;
  bool is_unique = true;  ///< an operating point: no other one would do
  std::vector<double>
      unknowns{};               ///< of segments, in place of the states: the end of a run before, in that position; empty: from the states
  std::vector<double> signals;  ///< of the operating point, or of the end of a run before
  MissingRest missing;          ///< operating point only: where it has none it starts from `.ic` values, and zero elsewhere
};

/// `ic=` and `.ic` values, zero elsewhere.
[[nodiscard]] PartStart start_from_initial_values(const model::Network& network, const Descriptor& descriptor);

/// Sources at their value just before t = 0, complementarity satisfied, `.ic` values forced: implicit Euler steps of ever larger size from
/// empty stores, until nothing changes. What is not determined (a loop without resistance, a floating capacitor) stays as empty as it can be.
[[nodiscard]] PartStart start_from_operating_point(const model::Network& network, const Descriptor& descriptor);

/// A DC operating point with the switches as they are `initially_on`.
struct Rest {
  std::vector<double> voltages, currents;  ///< of the network's capacitors and inductors, V and A
  std::vector<double> signals;             ///< of the network
};

/// Of a part without `.ic`, by long steps of the network's own equations: a leak is a number of its own there, where rates of states are sums in which it may be rounding. Nothing where none is found.
[[nodiscard]] std::optional<Rest> rest_of(const model::Network& network);

}  // namespace pwlsim::engine::sparse
