#pragma once
/// The analyses of a deck, as a run carries them out: one kind a file. Another one is one more file, and its line in `analysis_sessions`.

#include <memory>
#include <vector>

#include "cli/run_context.hpp"

namespace pwlsim::cli {

/// One kind of analysis. All answers are exit status.
class AnalysisSession {
 public:
  virtual ~AnalysisSession() = default;
  /// Whether the deck has a card of this kind.
  [[nodiscard]] virtual bool is_asked(const circuit::Analyses& analyses) const = 0;
  /// It is left out where one before it has failed.
  [[nodiscard]] virtual bool needs_those_before() const { return true; }
  /// Files that it alone writes; the file of rows, --plot and --report are open or refused already.
  [[nodiscard]] virtual int open_files(RunContext& /*run*/) { return 0; }
  [[nodiscard]] virtual int run(RunContext& run) = 0;
  /// Pictures of its own.
  [[nodiscard]] virtual int write_pictures(RunContext& /*run*/) { return 0; }
};

/// Those of the deck, in the order in which they run.
[[nodiscard]] std::vector<std::unique_ptr<AnalysisSession>> analysis_sessions(const circuit::Analyses& analyses);

[[nodiscard]] std::unique_ptr<AnalysisSession> operating_point_session();  ///< .op
[[nodiscard]] std::unique_ptr<AnalysisSession> orbit_session();            ///< .pss
[[nodiscard]] std::unique_ptr<AnalysisSession> small_signal_session();     ///< .ac
[[nodiscard]] std::unique_ptr<AnalysisSession> transient_session();        ///< .tran
[[nodiscard]] std::unique_ptr<AnalysisSession> sensitivity_session();      ///< .sens

/// Commits a picture and says so; `noted` takes its name.
[[nodiscard]] int write_picture(PictureFile& file, const std::string& svg, RunContext& run, std::string& noted);

}  // namespace pwlsim::cli
