#pragma once
/// `pwlsim inspect circuit.net`: from the file to the exit status.

#include "cli/command_line.hpp"

namespace pwlsim::cli {

/// Reads and checks the deck and prints its model to standard output.
[[nodiscard]] int run_inspect_session(const InspectOptions& options);

}  // namespace pwlsim::cli
