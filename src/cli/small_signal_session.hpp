#pragma once
/// `.ac` of one run: response, rows, messages.

#include "analysis/run_json.hpp"
#include "circuit/compile.hpp"
#include "cli/messages.hpp"
#include "waveform/output_file.hpp"

namespace pwlsim::cli {

/// Around outcome.steady_state where the deck has .pss, else of a linear circuit as it is. Beside a .tran without .pss, as in decks of other simulators, it is
/// left out with a warning where it cannot be. `file`: of the rows; null: none. The answer is the exit status.
[[nodiscard]] int run_small_signal(const circuit::Compiled& compiled, const SourceStore& sources, waveform::OutputFile* file,
                                   analysis::RunOutcome& outcome, Messages& messages);

}  // namespace pwlsim::cli
