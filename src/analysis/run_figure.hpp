#pragma once
/// A run as a picture: its signals in panels by unit; below them its events and the conducting ports.

#include <string>
#include <vector>

#include "analysis/run_recorder.hpp"
#include "analysis/swept_runs.hpp"
#include "waveform/svg_plot.hpp"

namespace pwlsim::analysis {

/// `names`: the saved signals. At most eight panels of six curves are drawn; the title says how many signals are drawn.
[[nodiscard]] waveform::Figure run_figure(const std::string& title, const std::vector<std::string>& names, const RunRecorder& recorder);

/// The runs of a sweep: one panel per signal, one colour per run, at most eight panels and the runs that are kept for drawing; the title says how many are drawn.
[[nodiscard]] waveform::Figure sweep_figure(const std::string& title, const std::vector<std::string>& names, const SweptRuns& runs);

/// A row for each drawn run, in its colour: the times at which a diode or switch changes or a state jumps. None if no run has such a time.
[[nodiscard]] std::vector<waveform::Marks> run_marks(const SweptRuns& runs);
/// The meaning of the ticks of these rows.
inline constexpr const char* run_marks_title = "a diode or switch changes, or a state jumps";

/// The colour of drawn run number `index`.
[[nodiscard]] std::string colour_of_run(const SweptRuns& runs, std::size_t index);

/// Numbers of signals that share a panel: of one unit, volts first, at most six together.
[[nodiscard]] std::vector<std::vector<std::size_t>> panels_of(const std::vector<std::string>& names);

/// Times of events by kind: edges of sources, changes of mode, jumps; kinds without events are left out.
[[nodiscard]] std::vector<waveform::Marks> event_marks(const std::vector<engine::Event>& events);

}  // namespace pwlsim::analysis
