#pragma once
/// The runs of a deck with .step.

#include "analysis/swept_runs.hpp"
#include "circuit/compile.hpp"
#include "cli/command_line.hpp"
#include "cli/messages.hpp"
#include "cli/run_context.hpp"
#include "netlist/ast.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {

struct SweepTask {
  const RunOptions& options;
  const netlist::Deck& deck;
  const SourceStore& sources;
  const circuit::Compiled& first;        ///< the deck with the values of the first run
  double reltol = 0.0;                   ///< of the sparse engine
  waveform::OutputFile* rows = nullptr;  ///< null if the deck has no .tran; with --split the table of the runs
  SweepFiles& beside;
};

/// Runs them on all cores, writes their rows in order, or those of each run to its own file, commits the file, and prints operating points and measurements as tables. A run that
/// fails is reported and counted, and does not stop the others; after a signal the rows written so far stay. Returns the exit status.
/// Adds statistics to `report`, and stores the result of each run in `runs`, which was made from the sweeps of `task.first`.
[[nodiscard]] int run_sweep(const SweepTask& task, Messages& messages, analysis::RunReport& report, analysis::SweptRuns& runs);

}  // namespace pwlsim::cli
