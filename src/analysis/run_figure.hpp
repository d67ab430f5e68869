#pragma once
/// A run as a picture: its signals in panels by unit, its events and which ports conduct below.

#include <string>
#include <vector>

#include "analysis/run_recorder.hpp"
#include "analysis/swept_runs.hpp"
#include "waveform/svg_plot.hpp"

namespace pwlsim::analysis {

/// `names`: the saved signals. At most eight panels of six curves are drawn; the title says how many signals are left.
[[nodiscard]] waveform::Figure run_figure(const std::string& title, const std::vector<std::string>& names, const RunRecorder& recorder);

/// The runs of a sweep: a panel a signal, a colour a run, at most eight panels and the runs that are kept for drawing; the title says how many are left.
[[nodiscard]] waveform::Figure sweep_figure(const std::string& title, const std::vector<std::string>& names, const SweptRuns& runs);

/// A row for each drawn run, in its colour: the times at which a diode or switch changes or a state jumps. None where there is no such time in any.
[[nodiscard]] std::vector<waveform::Marks> run_marks(const SweptRuns& runs);
/// What the ticks of these rows are.
inline constexpr const char* run_marks_title = "a diode or switch changes, or a state jumps";

/// Of drawn run number `index`.
[[nodiscard]] std::string colour_of_run(const SweptRuns& runs, std::size_t index);

/// Numbers of signals that share a panel: of one unit, volts first, at most six together.
[[nodiscard]] std::vector<std::vector<std::size_t>> panels_of(const std::vector<std::string>& names);

/// Times of events by kind: edges of sources, changes of mode, jumps; kinds without events are left out.
[[nodiscard]] std::vector<waveform::Marks> event_marks(const std::vector<engine::Event>& events);

}  // namespace pwlsim::analysis
