#pragma once
/// The runs of a deck with .step, for statistics, JSON and pictures.

#include <optional>
#include <string>
#include <vector>

#include "analysis/report.hpp"
#include "analysis/run_recorder.hpp"
#include "analysis/sensitivity.hpp"
#include "analysis/small_signal.hpp"
#include "analysis/steady_state.hpp"
#include "analysis/transient.hpp"
#include "circuit/analyses.hpp"
#include "measure/measuring.hpp"

namespace pwlsim::analysis {

struct SweptRun {
  bool done = false;         ///< it reached its end
  bool interrupted = false;  ///< it was ended by a signal, or not started
  std::string id, message;   ///< of a failure
  std::string file;          ///< with only its rows; empty if its rows share a file with others, or if there are none
  double end = 0.0;          ///< time reached, s
  engine::Statistics statistics;
  engine::Certificate certificate;
  std::vector<engine::Remark> remarks;
  measure::Results measurements;
  measure::Record measured;             ///< of the run, until its derivatives are known
  std::vector<double> operating_point;  ///< of the saved signals; empty if not requested, or not found
  std::uint64_t rows = 0;
  double seconds_write = 0.0;
  DerivativeTable sensitivities;
  std::optional<SmallSignalResult> small_signal;  ///< of .ac; kept for JSON and pictures
  std::vector<double> singular;                   ///< frequencies at which the response is infinite
  std::vector<std::string> impulsive;             ///< signals without a response because of impulses
  std::shared_ptr<SteadyState> orbit;             ///< null: not requested, or not found
};

/// Why it did not reach its end; empty if it did.
[[nodiscard]] std::string failure_text(const SweptRun& run);

/// A run whose curves are kept for pictures.
struct DrawnRun {
  std::size_t run = 0;
  std::optional<RunRecorder> recorder;  ///< empty if the run has no rows
};

struct SweptRuns {
  circuit::Sweeps sweeps;
  std::vector<SweptRun> list;   ///< none: nothing was stepped
  std::vector<DrawnRun> drawn;  ///< at most `most_drawn`, evenly spread, the first and the last among them
  static constexpr std::size_t most_drawn = 12;

  SweptRuns() = default;
  SweptRuns(const circuit::Sweeps& steps, bool with_pictures);

  /// "R=1000, C=1e-06"
  [[nodiscard]] std::string name(std::size_t run) const;
  /// The recorder of a run; null if it is not drawn.
  [[nodiscard]] std::optional<RunRecorder>* recorder_of(std::size_t run);
  /// Sums of counts; the largest of sizes and residuals.
  void sum_up(RunReport& report) const;
};

/// A run that has failed already stays failed.
void take_transient(const TransientRun& transient, SweptRun& run);
/// Call it first; a run without .tran is complete with it.
void take_operating_point(const engine::OperatingPoint& point, SweptRun& run);

/// The head of a CSV of runs: the stepped names, then `columns`.
[[nodiscard]] std::string sweep_head(const circuit::Sweeps& sweeps, const std::vector<std::string>& columns);
/// The beginning of each of its lines.
[[nodiscard]] std::string sweep_prefix(const circuit::Sweeps& sweeps, std::size_t run);
/// CSV, one line per run: the stepped values, then the signals at the operating point with this many significant digits (0: all); "failed" if
/// there are none.
[[nodiscard]] std::string operating_point_table(const SweptRuns& runs, const std::vector<std::string>& signals, int digits = 0);
/// The same for the measurements that are shown.
[[nodiscard]] std::string measurement_table(const SweptRuns& runs, const circuit::Measurements& measurements, int digits = 0);
/// CSV, one line per run: the stepped values, the name of its own file without the folder, rows, time reached, failure.
[[nodiscard]] std::string file_table(const SweptRuns& runs);

}  // namespace pwlsim::analysis
