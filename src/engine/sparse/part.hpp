#pragma once
/// A part of a network that shares nothing with others but rails, with the switches that its quantities drive, and its equations.

#include <string>

#include "engine/sparse/controls.hpp"
#include "engine/sparse/descriptor.hpp"
#include "engine/sparse/gates.hpp"
#include "engine/threshold_watch.hpp"
#include "model/islands.hpp"

namespace pwlsim::engine::sparse {

struct Part {
  explicit Part(model::Island i)
      : island(std::move(i)),
        gates(take_gates(island.network)),
        watched(watched_switches(island.network)),
        descriptor(island.network),
        controls(controls_in_turn(island.network, descriptor)) {}
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  /// Names of its sources of voltage, for a message about them.
  [[nodiscard]] std::string loop_of_sources() const {
    std::string names;
    for (const auto& branch : island.network.branches) names += (names.empty() ? "the current of " : ", ") + branch.label.name;
    return names.empty() ? "some unknown" : names;
  }

  model::Island island;
  std::vector<Gate> gates;
  std::vector<WatchedSwitch> watched;
  Descriptor descriptor;
  std::vector<WatchedControl> controls;
};

}  // namespace pwlsim::engine::sparse
