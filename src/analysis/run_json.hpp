#pragma once
/// A run as one JSON object, for scripts: the request, the results, and the files.

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

/// The results of a session, possibly incomplete.
struct RunOutcome {
  struct Rows {
    std::string file;       ///< file of the rows; "NAME.partial" if writing failed
    std::string format;     ///< "csv" or "raw"
    bool complete = false;  ///< the run reached Tstop and its rows are in `file`
    double end = 0.0;       ///< time reached, s
  };

  std::string deck, title;
  int status = 0;  ///< of the program at its exit
  std::optional<Rows> rows;
  std::vector<std::string> signals;
  std::vector<std::string> drawn_signals;              ///< further signals of the page
  std::string schematic;                               ///< of the page, as JSON; empty if there is none
  std::optional<std::vector<double>> operating_point;  ///< of the signals
  measure::Results measurements;
  std::optional<SteadyState> steady_state;
  std::optional<SmallSignalResult> small_signal;
  DerivativeTable sensitivities;
  std::optional<Check> check;  ///< of --check
  SweptRuns sweep;             ///< of a deck with .step
  std::string plot, report;    ///< files written, or empty
};

/// Ended by a line feed; keys in docs/reference/output.md. Statistics are null if no model was built (`run.engine` is empty).
[[nodiscard]] std::string run_json(const RunOutcome& outcome, const RunReport& run);

}  // namespace pwlsim::analysis
