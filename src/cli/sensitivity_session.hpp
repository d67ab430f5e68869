#pragma once
/// `.sens`: derivatives of what the runs have measured, as a table, a file and messages.

#include <optional>

#include "analysis/run_json.hpp"
#include "cli/messages.hpp"
#include "cli/output.hpp"
#include "cli/status.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {

/// Where the table goes.
struct SensitivityOutput {
  bool is_printed = true;
  Stream stream = Stream::output;
  int digits = 0;
  waveform::OutputFile* file = nullptr;  ///< may be null
};

/// Of the runs of the deck, which are done; `is_exact`: by the exact engine.
int run_sensitivities(const circuit::Compiled& compiled, bool is_exact, const SensitivityOutput& output, analysis::RunOutcome& outcome,
                      Messages& messages);

/// What there is to say about them; `where`: " in the run with …", or nothing.
void report_derivatives(const analysis::DerivativeTable& table, Messages& messages, const std::string& where = "");

}  // namespace pwlsim::cli
