#pragma once
/// Where a run starts: the DC operating point, or the initial values of the deck.

#include <vector>

#include "engine/exact/exact_model.hpp"
#include "engine/missing_rest.hpp"
#include "engine/run.hpp"
#include "model/index_set.hpp"

namespace pwlsim::engine {

struct Start {
  Answer answer;                             ///< outcome and remarks
  MissingRest missing;                       ///< operating point only: parts that have none start from `.ic` values, and zero elsewhere
  std::vector<linalg::Vector> xi;            ///< energy coordinates of each island
  std::vector<char> on;                      ///< switches
  std::vector<model::IndexSet> active;       ///< of each island: the mode before t = 0; empty where there was none
  std::vector<std::vector<double>> signals;  ///< operating point only: each island's share of its signals
};

/// Sources at their value just before t = 0, capacitors open, inductors short, complementarity satisfied, `.ic` values forced.
[[nodiscard]] Start start_from_operating_point(const ExactModel& model);

/// `ic=` and `.ic` values, zero elsewhere.
[[nodiscard]] Start start_from_initial_values(const ExactModel& model);

}  // namespace pwlsim::engine
