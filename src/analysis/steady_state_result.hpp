#pragma once
/// The periodic orbit of a deck, or why there is none.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/orbit_names.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/small_signal.hpp"
#include "analysis/transient.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "engine/exact/selectors.hpp"
#include "engine/sparse/period_map.hpp"
#include "steady/orbit.hpp"
#include "steady/parameter_inputs.hpp"
#include "steady/period.hpp"

namespace pwlsim::analysis {

/// The orbit in a model that has the inputs of `.ac` and `.sens`, which are zero on it.
struct OrbitWithInputs {
  model::Network network;
  std::shared_ptr<const engine::ExactModel> model;
  std::shared_ptr<engine::Selectors> selectors;  ///< modes of the trace
  steady::Trace trace;
};

struct SteadyState {
  bool is_found = false;
  bool has_best_attempt = false;  ///< not found, but there is a run over one period with the best attempt
  bool is_wrong_input = false;    ///< the card requests something impossible
  std::string id, message;        ///< of the error if it is not found
  std::vector<Diagnostic> messages;
  std::shared_ptr<const engine::ExactModel> model;
  steady::CommonPeriod common;
  steady::Orbit orbit;
  int multiple = 1;
  std::vector<NamedState> states;  ///< just after t = 0
  std::vector<OrbitMode> modes;
  std::optional<SmallSignalInputs> inputs;              ///< of .ac, in the model
  std::optional<steady::SensitivityInputs> parameters;  ///< of .sens, likewise
  circuit::Compiled compiled;                           ///< of the orbit: settled sources, one period, its own measurements
  Simulate simulate;                                    ///< runs over the period from the orbit
  std::shared_ptr<engine::sparse::PeriodMap> map;  ///< of an orbit on Krylov segments, which has no `model`; null: it is on dense modes
  engine::sparse::PeriodMap::State begin;          ///< of that orbit
  std::shared_ptr<const OrbitWithInputs> apart;    ///< where the inputs are not in `model` itself; null: they are

  [[nodiscard]] const model::Network& network_with_inputs() const { return apart ? apart->network : compiled.network; }
  [[nodiscard]] const engine::ExactModel& model_with_inputs() const { return apart ? *apart->model : *model; }
  [[nodiscard]] const steady::Trace& trace_with_inputs() const { return apart ? apart->trace : orbit.trace; }
};

}  // namespace pwlsim::analysis
