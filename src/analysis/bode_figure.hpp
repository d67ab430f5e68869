#pragma once
/// Small signals as a Bode plot: magnitudes in decibels above phases that go on without jumps.

#include "analysis/small_signal.hpp"
#include "waveform/svg_plot.hpp"

namespace pwlsim::analysis {

/// At most six signals, or the loop gain with its crossovers and gain margins where there is one.
[[nodiscard]] waveform::Figure bode_figure(const std::string& title, const SmallSignalResult& result);

}  // namespace pwlsim::analysis
