#pragma once

#include <vector>

#include "linalg/dense.hpp"
#include "model/index_set.hpp"

namespace pwlsim::engine {

/// Everything that the rest of a run depends on, besides its sources: left of `time`, so that the instant there is still to come.
struct RunState {
  std::vector<linalg::Vector> xi;              ///< energy coordinates of each island
  std::vector<char> on;                        ///< switches of the model
  std::vector<model::IndexSet> active;         ///< of each island, the mode's active set: where selection begins. Empty: all diodes block.
  double time = 0.0;                           ///< s
  std::vector<std::vector<double>> signals{};  ///< each island's share of its signals just before `time`; empty: not known
};

}  // namespace pwlsim::engine
