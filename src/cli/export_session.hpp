#pragma once
/// `pwlsim export circuit.net -o out.cir`: from the file to the exit status.

#include "cli/command_line.hpp"

namespace pwlsim::cli {

/// Reads and checks the deck and writes its smoothed equivalent for ngspice; for a schematic and an output named x.net, its netlist.
[[nodiscard]] int run_export_session(const ExportOptions& options);

}  // namespace pwlsim::cli
