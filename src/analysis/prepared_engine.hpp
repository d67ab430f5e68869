#pragma once
/// Prepares the engine that the user requests, or that fits the size of a network.

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

/// `modes`: the exact engine with dense modes at any size.
enum class EngineChoice { automatic, exact, sparse, krylov, modes };

struct PreparedEngine {
  std::string name;   ///< "exact", "sparse" or "krylov"
  Simulate simulate;  ///< empty if there was an error
  std::function<engine::OperatingPoint()> operating_point;
  /// How its results differ from exact ones (W-sparse-engine).
  std::optional<Diagnostic> warning;
  bool has_modes = false;  ///< dense ones are at hand, for orbits, small signals, derivatives and controllers
};

/// `auto` and `exact` take Krylov segments for passive networks whose largest part has more stores, diodes and switches: building dense modes then takes longer than most runs
/// (docs/developer/performance.md). Other networks have dense modes, which examine whether their solution is unique, unless these would take more than seconds.
inline constexpr std::size_t most_in_modes = 100;

/// The tolerance of the sparse engine: as requested, else `.options reltol=`, else its default.
[[nodiscard]] double relative_tolerance(const std::optional<double>& asked, const circuit::Analyses& analyses);

/// Whether the exact engine's dense modes serve the network: orbits, small signals, derivatives and controllers need them.
[[nodiscard]] bool has_modes(const model::Network& network, EngineChoice choice);

/// Whether `prepare_engine` takes Krylov segments although they were not asked for.
[[nodiscard]] bool runs_by_segments(const model::Network& network, EngineChoice choice);

/// `diagnostics` receives errors of structure, and E-tolerance if the sparse engine cannot keep `reltol`.
[[nodiscard]] PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics);

/// The same. If the network is so large that this, or a step of the engine, may take long without checking `interrupt`, it runs in its own thread
/// and is abandoned after a signal (analysis/abandonable.hpp). Then the engine is empty, without an error; a later run has the outcome `interrupted`.
[[nodiscard]] PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics,
                                            const std::atomic<int>& interrupt);

/// The exact engine, prepared at its first use; for networks that are known to have a model.
[[nodiscard]] PreparedEngine exact_engine_when_needed(const model::Network& network);

/// Whether preparing an engine, and its steps, are so short that no signal needs to interrupt them.
[[nodiscard]] bool is_quick(const model::Network& network);

/// The same engine without rows.
[[nodiscard]] Simulate without_rows(Simulate simulate);

}  // namespace pwlsim::analysis
