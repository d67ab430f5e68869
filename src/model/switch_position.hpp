#pragma once
/// An island with its switches set: a closed contact becomes a branch v = drop + resistance·i, an open one is left out.

#include <vector>

#include "model/islands.hpp"

namespace pwlsim::model {

/// `closed`: one entry a switch of the island's network. Signals and controls are dropped.
[[nodiscard]] Island in_position(const Island& island, const std::vector<char>& closed);

}  // namespace pwlsim::model
