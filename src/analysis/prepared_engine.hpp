#pragma once
/// The engine that the user, or the size of a network, asks for, prepared.

#include <functional>
#include <optional>
#include <string>

#include "analysis/transient.hpp"

namespace pwlsim::analysis {

enum class EngineChoice { automatic, exact, sparse };

struct PreparedEngine {
  std::string name;   ///< "exact" or "sparse"
  Simulate simulate;  ///< empty where there was an error
  std::function<engine::OperatingPoint()> operating_point;
  /// What sets its results apart from exact ones (W-sparse-engine).
  std::optional<Diagnostic> warning;
};

/// The tolerance of the sparse engine: as asked for, else `.options reltol=`, else its default.
[[nodiscard]] double relative_tolerance(const std::optional<double>& asked, const circuit::Analyses& analyses);

/// `diagnostics` takes errors of structure, and E-tolerance where the sparse engine cannot keep `reltol`.
[[nodiscard]] PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics);

}  // namespace pwlsim::analysis
