#include "analysis/run_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "analysis/quantity.hpp"

namespace pwlsim::analysis {
namespace {

constexpr std::size_t most_panels = 8, most_curves_of_panel = 6;
/// Of the names of one panel, so that they find room above it.
constexpr std::size_t most_letters = 60;

waveform::Curve curve(const std::string& name, const measure::SolutionRecord& solution, std::size_t signal,
                      const std::string& colour = {}) {
  measure::SolutionRecord::Line line = solution.line(signal);
  return {name, std::move(line.times), std::move(line.values), false, colour};
}

}  // namespace

std::vector<std::vector<std::size_t>> panels_of(const std::vector<std::string>& names) {
  std::vector<std::vector<std::size_t>> panels;
  for (const std::string_view unit : std::array<std::string_view, 3>{"V", "A", ""}) {
    std::size_t letters = 0;
    bool open = false;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (unit_of_signal(names[k]) != unit) continue;
      if (!open || panels.back().size() == most_curves_of_panel || letters + names[k].size() > most_letters) {
        panels.emplace_back();
        letters = 0;
        open = true;
      }
      panels.back().push_back(k);
      letters += names[k].size();
    }
  }
  return panels;
}

std::vector<waveform::Marks> event_marks(const std::vector<engine::Event>& events) {
  std::array<waveform::Marks, 3> marks{{{"edges", {}, {}}, {"switching", {}, {}}, {"jumps", {}, {}}}};
  for (const engine::Event& event : events) {
    if (event.source_edge) marks[0].x.push_back(event.time);
    if (event.mode_change) marks[1].x.push_back(event.time);
    if (event.jump) marks[2].x.push_back(event.time);
  }
  std::vector<waveform::Marks> result;
  for (waveform::Marks& each : marks)
    if (!each.x.empty()) result.push_back(std::move(each));
  return result;
}

waveform::Figure run_figure(const std::string& title, const std::vector<std::string>& names, const RunRecorder& recorder) {
  const measure::SolutionRecord& solution = recorder.solution();
  const std::size_t count = std::min(names.size(), solution.signals());  // there may be more, of a page
  const std::vector<std::string> kept(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(count));
  waveform::Figure figure{title, "time", "s", {}, event_marks(recorder.events()), recorder.lanes()};
  std::size_t drawn = 0;
  for (const auto& members : panels_of(kept)) {
    if (figure.panels.size() == most_panels) break;
    waveform::Panel panel{"", {}, std::string(unit_of_signal(kept[members.front()]))};
    for (const std::size_t k : members) panel.curves.push_back(curve(kept[k], solution, k));
    drawn += members.size();
    figure.panels.push_back(std::move(panel));
  }
  if (drawn < names.size()) figure.title += fmt::format(" ({} of {} signals)", drawn, names.size());
  return figure;
}

std::vector<waveform::Marks> run_marks(const SweptRuns& runs) {
  std::vector<waveform::Marks> rows;
  bool any = false;
  for (std::size_t index = 0; index < runs.drawn.size(); ++index) {
    const DrawnRun& drawn = runs.drawn[index];
    if (!drawn.recorder) continue;
    waveform::Marks row{runs.name(drawn.run), {}, colour_of_run(runs, index)};
    for (const engine::Event& event : drawn.recorder->events())
      if (event.mode_change || event.jump) row.x.push_back(event.time);
    any = any || !row.x.empty();
    rows.push_back(std::move(row));
  }
  return any ? rows : std::vector<waveform::Marks>{};
}

std::string colour_of_run(const SweptRuns& runs, std::size_t index) {
  return waveform::ramp_colour(runs.drawn.size() < 2 ? 0.0 : static_cast<double>(index) / static_cast<double>(runs.drawn.size() - 1));
}

waveform::Figure sweep_figure(const std::string& title, const std::vector<std::string>& names, const SweptRuns& runs) {
  waveform::Figure figure{title, "time", "s", {}, run_marks(runs), {}, {}, fmt::format("tick: {}", run_marks_title)};
  const std::size_t panels = std::min({names.size(), most_panels, RunRecorder::most_signals});
  for (std::size_t k = 0; k < panels; ++k) figure.panels.push_back({names[k], {}, std::string(unit_of_signal(names[k]))});
  for (std::size_t index = 0; index < runs.drawn.size(); ++index) {
    const DrawnRun& drawn = runs.drawn[index];
    if (!drawn.recorder) continue;
    const std::string colour = colour_of_run(runs, index);
    figure.legend.push_back({runs.name(drawn.run), colour});
    for (std::size_t k = 0; k < panels; ++k) figure.panels[k].curves.push_back(curve("", drawn.recorder->solution(), k, colour));
  }
  std::vector<std::string> parts;
  if (panels < names.size()) parts.push_back(fmt::format("{} of {} signals", panels, names.size()));
  if (figure.legend.size() < runs.list.size()) parts.push_back(fmt::format("{} of {} runs", figure.legend.size(), runs.list.size()));
  if (!parts.empty()) figure.title += fmt::format(" ({})", fmt::join(parts, ", "));
  return figure;
}

}  // namespace pwlsim::analysis
