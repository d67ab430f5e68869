#pragma once
/// `pwlsim circuit.net`: from the file to the exit status.

#include "cli/command_line.hpp"

namespace pwlsim::cli {

/// Reads, checks and runs the deck, writes its results, and prints messages on standard error.
[[nodiscard]] int run_session(const RunOptions& options);

}  // namespace pwlsim::cli
