#pragma once
/// The start of a run: the DC operating point, or the initial values of the deck.

#include "engine/exact/exact_model.hpp"
#include "engine/exact/run_state.hpp"
#include "engine/missing_rest.hpp"
#include "engine/run.hpp"

namespace pwlsim::engine {

/// Signals are known only for an operating point.
struct RunStart : RunState {
  Answer answer;        ///< outcome and remarks
  MissingRest missing;  ///< operating point only: parts that have none start from `.ic` values, and zero elsewhere
};

/// Sources at their value just before t = 0, capacitors open, inductors short, complementarity satisfied, `.ic` values forced.
[[nodiscard]] RunStart start_from_operating_point(const ExactModel& model);

/// `ic=` and `.ic` values, zero elsewhere.
[[nodiscard]] RunStart start_from_initial_values(const ExactModel& model);

}  // namespace pwlsim::engine
