#pragma once
/// `pwlsim compare circuit.net`: from the file to the exit status.

#include "cli/command_line.hpp"

namespace pwlsim::cli {

/// Runs the deck, and its smoothed equivalent in ngspice, and prints how far apart they are. If ngspice is not installed it reports this, with status 0.
[[nodiscard]] int run_compare_session(const CompareOptions& options);

}  // namespace pwlsim::cli
