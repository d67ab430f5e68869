#pragma once
/// A run as one self-contained web page: waveforms with zoom, cursors and measurements, events and modes on a time
/// line, idealisations, certificate, statistics. Its parts are src/analysis/page and third_party/uplot, built into the program.

#include <string>

#include "analysis/run_json.hpp"
#include "analysis/run_recorder.hpp"

namespace pwlsim::analysis {

/// `recorder`: null without rows.
[[nodiscard]] std::string html_report(const RunOutcome& outcome, const RunReport& run, const RunRecorder* recorder);

}  // namespace pwlsim::analysis
