#pragma once
/// The engine that `--engine` or the size of a network asks for, prepared.

#include <functional>
#include <string>

#include "analysis/transient.hpp"
#include "cli/command_line.hpp"

namespace pwlsim::cli {

struct PreparedEngine {
  std::string name;             ///< "exact" or "sparse"
  analysis::Simulate simulate;  ///< empty where the network cannot be prepared
  std::function<engine::OperatingPoint()> operating_point;
  [[nodiscard]] bool is_sparse() const { return name == "sparse"; }
};

[[nodiscard]] PreparedEngine prepare_engine(const model::Network& network, EngineChoice choice, double reltol, Diagnostics& diagnostics);

}  // namespace pwlsim::cli
