#pragma once
/// The analyses of a deck: one file per kind. A new kind is a new file and its line in `analysis_sessions`.

#include <memory>
#include <vector>

#include "cli/run_context.hpp"

namespace pwlsim::cli {

/// One kind of analysis. Functions return an exit status.
class AnalysisSession {
 public:
  virtual ~AnalysisSession() = default;
  /// Whether the deck has a card of this kind.
  [[nodiscard]] virtual bool is_asked(const circuit::Analyses& analyses) const = 0;
  /// Whether it is skipped if an earlier one has failed.
  [[nodiscard]] virtual bool needs_those_before() const { return true; }
  /// Opens the files that only it writes; the file of rows, --plot and --report are already open or refused.
  [[nodiscard]] virtual int open_files(RunContext& /*run*/) { return 0; }
  [[nodiscard]] virtual int run(RunContext& run) = 0;
  /// Draws its own pictures.
  [[nodiscard]] virtual int write_pictures(RunContext& /*run*/) { return 0; }
};

/// Those of the deck, in the order in which they run.
[[nodiscard]] std::vector<std::unique_ptr<AnalysisSession>> analysis_sessions(const circuit::Analyses& analyses);

[[nodiscard]] std::unique_ptr<AnalysisSession> operating_point_session();  ///< .op
[[nodiscard]] std::unique_ptr<AnalysisSession> orbit_session();            ///< .pss
[[nodiscard]] std::unique_ptr<AnalysisSession> small_signal_session();     ///< .ac
[[nodiscard]] std::unique_ptr<AnalysisSession> transient_session();        ///< .tran
[[nodiscard]] std::unique_ptr<AnalysisSession> sensitivity_session();      ///< .sens

/// Commits a picture and prints a line; `noted` receives its name.
[[nodiscard]] int write_picture(PictureFile& file, const std::string& svg, RunContext& run, std::string& noted);

}  // namespace pwlsim::cli
