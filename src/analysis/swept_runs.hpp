#pragma once
/// The runs of a deck with .step, as statistics, JSON and pictures have them.

#include <optional>
#include <string>
#include <vector>

#include "analysis/report.hpp"
#include "analysis/run_recorder.hpp"
#include "analysis/transient.hpp"
#include "circuit/analyses.hpp"
#include "measure/measuring.hpp"

namespace pwlsim::analysis {

struct SweptRun {
  bool done = false;         ///< it reached its end
  bool interrupted = false;  ///< it was ended, or not begun
  std::string id, message;   ///< of a failure
  double end = 0.0;          ///< time reached, s
  engine::Statistics statistics;
  engine::Certificate certificate;
  std::vector<engine::Remark> remarks;
  measure::Results measurements;
  std::uint64_t rows = 0;
  double seconds_write = 0.0;
};

/// A run whose curves are kept for pictures.
struct DrawnRun {
  std::size_t run = 0;
  std::optional<RunRecorder> recorder;  ///< empty where the run came to no rows
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
  /// Where to record a run; null where it is not drawn.
  [[nodiscard]] std::optional<RunRecorder>* recorder_of(std::size_t run);
  /// Counts summed up, sizes and residuals the largest.
  void sum_up(RunReport& report) const;
};

[[nodiscard]] SweptRun swept_run(const TransientRun& run);

}  // namespace pwlsim::analysis
