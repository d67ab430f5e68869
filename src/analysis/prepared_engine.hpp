#pragma once
/// Prepares the engine that the user requests, or that fits the size of a network.

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

enum class EngineChoice { automatic, exact, sparse, krylov };

struct PreparedEngine {
  std::string name;   ///< "exact", "sparse" or "krylov"
  Simulate simulate;  ///< empty if there was an error
  std::function<engine::OperatingPoint()> operating_point;
  /// How its results differ from exact ones (W-sparse-engine).
  std::optional<Diagnostic> warning;
};

/// The tolerance of the sparse engine: as requested, else `.options reltol=`, else its default.
[[nodiscard]] double relative_tolerance(const std::optional<double>& asked, const circuit::Analyses& analyses);

/// Whether `prepare_engine` takes the exact engine.
[[nodiscard]] bool runs_exactly(const model::Network& network, EngineChoice choice);

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
