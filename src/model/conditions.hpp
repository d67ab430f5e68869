#pragma once
/// Makes `.ic` values part of the network.

#include "model/network.hpp"

namespace pwlsim::model {

/// The network with its `.ic` values held, except for those that its sources hold already: node voltages by sources to ground, inductor currents by sources in series, since an inductor held at
/// its current has no voltage of its own to offer (v = 0 is given up for i = value). The nodes in between are new.
[[nodiscard]] Network with_held_conditions(Network network);

/// Each source a constant, its value just before t = 0; what the run sets (model::Held) stays.
[[nodiscard]] Network with_resting_sources(Network network);

/// Without `ic=` values, which have no effect without uic. Stores that always start at their values keep them.
[[nodiscard]] Network without_initial_values(Network network);

/// The network with initial values, from `.ic`, for the capacitors and inductors that have none of their own.
[[nodiscard]] Network with_initial_values(Network network);

}  // namespace pwlsim::model
