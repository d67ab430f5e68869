#pragma once
/// A run of `.tran` as derivatives read it: recorded, and in a model that has their inputs.

#include <atomic>
#include <memory>
#include <string>

#include "analysis/measured_pass.hpp"
#include "analysis/steady_state.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/march.hpp"
#include "engine/exact/selectors.hpp"
#include "engine/exact/start.hpp"
#include "steady/orbit_trace.hpp"
#include "steady/parameter_inputs.hpp"

namespace pwlsim::analysis {

struct RecordedRun {
  std::string failure;  ///< why there is none; "" where there is one
  steady::SensitivityInputs inputs;
  std::shared_ptr<const engine::ExactModel> model;  ///< with them
  engine::RunStart start;                           ///< where the deck says; not of a run from an orbit
  steady::Trace trace;                              ///< its modes are of `model`
  MeasuredPass measured;
  std::shared_ptr<engine::Selectors> selectors;  ///< of `model`: modes of the trace
  std::shared_ptr<engine::March> march;          ///< likewise, where the run itself was made with the inputs
};

/// From where the deck says, or from `orbit` (null: there is none). `known`: what has been measured, or null.
[[nodiscard]] RecordedRun record_run(const circuit::Compiled& compiled, const SteadyState* orbit, const std::atomic<int>& interrupt,
                                     const measure::Record* known);

}  // namespace pwlsim::analysis
