#pragma once
/// `pwlsim circuit.net`: from the file to the exit status.

#include "cli/command_line.hpp"

namespace pwlsim::cli {

/// Reads, checks and runs the deck, writes its results, and says on standard error what there is to say.
[[nodiscard]] int run_session(const RunOptions& options);

}  // namespace pwlsim::cli
