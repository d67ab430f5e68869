#pragma once
/// Small signals as a Bode plot: magnitudes in decibels above phases without jumps.

#include "analysis/small_signal.hpp"
#include "analysis/swept_runs.hpp"
#include "waveform/svg_plot.hpp"

namespace pwlsim::analysis {

/// At most six signals, or the loop gain with its crossovers and gain margins if there is one.
[[nodiscard]] waveform::Figure bode_figure(const std::string& title, const SmallSignalResult& result);

/// Whether a run of .step has a Bode plot.
[[nodiscard]] bool has_response(const SweptRuns& runs);
/// The first signal, or the loop gain, of at most six of the runs, evenly spread.
[[nodiscard]] waveform::Figure bode_figure(const std::string& title, const SweptRuns& runs);

}  // namespace pwlsim::analysis
