#pragma once

#include <vector>

#include "linalg/dense.hpp"
#include "model/index_set.hpp"

namespace pwlsim::engine {

/// Everything that the remaining run depends on, besides its sources: just before `time`, so that the instant there is still to come.
struct RunState {
  std::vector<linalg::Vector> xi;              ///< energy coordinates of each island
  std::vector<char> on;                        ///< switches of the model
  std::vector<model::IndexSet> active;         ///< of each island, the active set from which selection begins. Empty: all diodes block.
  double time = 0.0;                           ///< s
  std::vector<std::vector<double>> signals{};  ///< each island's share of its signals just before `time`; empty: not known
};

}  // namespace pwlsim::engine
