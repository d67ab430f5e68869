#pragma once
/// `.pss`: from a compiled deck to its periodic orbit and the messages about it.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "analysis/json.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/small_signal.hpp"
#include "analysis/steady_state_result.hpp"
#include "analysis/transient.hpp"
#include "circuit/compile.hpp"
#include "engine/exact/march.hpp"
#include "steady/orbit.hpp"

namespace pwlsim::analysis {

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

/// The message for Krylov segments, and networks beyond the reach of dense modes.
inline constexpr const char* response_needs_modes = "small signals around an orbit need dense modes; try --engine modes, or fewer stores";

/// Small signals around the orbit. `interrupt` may be null; once it is nonzero no further frequency is begun.
[[nodiscard]] SmallSignalResult small_signals(const circuit::Compiled& compiled, const SteadyState& state,
                                              const std::atomic<int>* interrupt = nullptr);
/// The small signals of the deck, around the orbit if there is one (else null).
struct DeckResponse {
  std::optional<SmallSignalResult> result;
  std::string id, message;  ///< of an error; empty if there is a response
};
[[nodiscard]] DeckResponse deck_response(const circuit::Compiled& compiled, const SteadyState* state, const std::atomic<int>* interrupt);

/// The member `pss`; null if there is none.
void write_orbit(JsonWriter& json, const SteadyState* state);

}  // namespace pwlsim::analysis
