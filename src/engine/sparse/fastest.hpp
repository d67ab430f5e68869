#pragma once
/// The fastest time constant of a network.

#include "model/network.hpp"

namespace pwlsim::engine::sparse {

/// A time that no time constant of resistors, capacitors, inductors, diodes and switches, in whatever position, lies far below:
/// C over all the conductance at its nodes, L (of coupled ones the leakage) over the largest resistance, √(LC) of the smallest. `forever` where
/// there is none.
[[nodiscard]] double fastest_time(const model::Network& network);

}  // namespace pwlsim::engine::sparse
