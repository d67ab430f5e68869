#pragma once
/// `.pss`: from a compiled deck to its periodic orbit and the messages about it.

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/json.hpp"
#include "analysis/orbit_names.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/small_signal.hpp"
#include "analysis/transient.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/exact.hpp"
#include "engine/exact/march.hpp"
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

/// A search with a prepared model; empty if there is none.
using OrbitSearch = std::function<SteadyState()>;

/// Whether an engine finds the deck's orbit: dense modes, or Krylov segments. Else E-pss-engine.
[[nodiscard]] bool has_orbit_engine(const circuit::Compiled& compiled, EngineChoice choice);

/// `diagnostics` receives errors of structure. `compiled` must have `analyses.steady_state` and outlive the search.
[[nodiscard]] OrbitSearch prepare_orbit(const circuit::Compiled& compiled, EngineChoice choice, const std::atomic<int>& interrupt,
                                        Diagnostics& diagnostics);

/// Both steps. Networks beyond the exact engine's reach end with an error. `compiled` must have `analyses.steady_state`.
[[nodiscard]] SteadyState find_steady_state(const circuit::Compiled& compiled, EngineChoice choice, const std::atomic<int>& interrupt);

/// The orbit's state in another model of the same circuit, with islands matched by name. Empty if one has no match.
[[nodiscard]] std::optional<engine::RunState> state_in(const engine::ExactModel& model, const SteadyState& state);

/// A run of the deck's own .tran that starts on the orbit.
[[nodiscard]] Simulate from_orbit(const circuit::Compiled& compiled, const SteadyState& state, Diagnostics& diagnostics);

/// Prints the orbit's measurements.
[[nodiscard]] measure::Results orbit_measurements(const SteadyState& state, const std::atomic<int>& interrupt);
/// The same, with the rows as lines of CSV after `prefix` if `text` is not null.
[[nodiscard]] measure::Results orbit_rows(const SteadyState& state, const std::string& prefix, std::string* text, bool with_events,
                                          const std::atomic<int>& interrupt);

/// A window of a measurement may contain this many periods.
inline constexpr double most_periods_measured = 1e4;

/// The message for the sparse engine.
inline constexpr const char* orbit_needs_exact_engine =
    "the steady state is found by the exact engine only; try --engine exact, or fewer stores";

/// The message for Krylov segments.
inline constexpr const char* response_needs_modes =
    "small signals around an orbit need dense modes, and this orbit was found on Krylov segments; try --engine modes, or fewer stores";

/// Small signals around the orbit.
[[nodiscard]] SmallSignalResult small_signals(const circuit::Compiled& compiled, const SteadyState& state);
/// The small signals of the deck, around the orbit if there is one (else null).
struct DeckResponse {
  std::optional<SmallSignalResult> result;
  std::string id, message;  ///< of an error; empty if there is a response
};
[[nodiscard]] DeckResponse deck_response(const circuit::Compiled& compiled, const SteadyState* state);

/// The member `pss`; null if there is none.
void write_orbit(JsonWriter& json, const SteadyState* state);

}  // namespace pwlsim::analysis
