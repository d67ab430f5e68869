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
  const circuit::Compiled& first;        ///< the deck as the first run has it
  double reltol = 0.0;                   ///< of the sparse engine
  waveform::OutputFile* rows = nullptr;  ///< null where the deck has no .tran; with --split of the table of the runs
  SweepFiles& beside;
};

/// Runs them on all cores, writes their rows in order, or each run's to a file of its own, and commits the file, prints operating points and measurements as tables. A run that
/// fails is said and counted, and does not stop the others; after a signal the rows that there are stay. The answer is the exit status.
/// Statistics are summed up in `report`, and `runs`, made of the sweeps of `task.first`, takes what came of each.
[[nodiscard]] int run_sweep(const SweepTask& task, Messages& messages, analysis::RunReport& report, analysis::SweptRuns& runs);

}  // namespace pwlsim::cli
