#pragma once
/// A run as one JSON object, for scripts: what was asked, what came of it, where the files are.

#include <optional>
#include <string>
#include <vector>

#include "analysis/check.hpp"
#include "analysis/report.hpp"
#include "analysis/sensitivity.hpp"
#include "analysis/steady_state.hpp"
#include "analysis/swept_runs.hpp"
#include "measure/measuring.hpp"

namespace pwlsim::analysis {

/// What a session did, as far as it came.
struct RunOutcome {
  struct Rows {
    std::string file;       ///< where they are; "NAME.partial" where writing failed
    std::string format;     ///< "csv" or "raw"
    bool complete = false;  ///< the run reached Tstop and its rows are in `file`
    double end = 0.0;       ///< time reached, s
  };

  std::string deck, title;
  int status = 0;  ///< of the program at its exit
  std::optional<Rows> rows;
  std::vector<std::string> signals;
  std::vector<std::string> drawn_signals;              ///< that the page has besides
  std::string schematic;                               ///< of the page, as JSON; empty where there is none
  std::optional<std::vector<double>> operating_point;  ///< of the signals
  measure::Results measurements;
  std::optional<SteadyState> steady_state;
  std::optional<SmallSignalResult> small_signal;
  DerivativeTable sensitivities;
  std::optional<Check> check;  ///< of --check
  SweptRuns sweep;             ///< of a deck with .step
  std::string plot, report;    ///< files written, or empty
};

/// Ended by a line feed; keys in docs/reference/output.md. Statistics are null where no model came about (`run.engine` is empty).
[[nodiscard]] std::string run_json(const RunOutcome& outcome, const RunReport& run);

}  // namespace pwlsim::analysis
