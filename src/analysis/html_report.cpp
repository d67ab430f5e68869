#include "analysis/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "analysis/joined_rows.hpp"
#include "analysis/json.hpp"
#include "analysis/page_parts.hpp"
#include "analysis/quantity.hpp"
#include "analysis/run_figure.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

template <class Values, class Write>
std::string array_of(const Values& values, const Write& write) {
  std::string text = "[";
  for (const auto& value : values) {
    if (text.size() > 1) text += ',';
    text += write(value);
  }
  return text + ']';
}

std::string numbers(const std::vector<double>& values) { return array_of(values, waveform::shortest); }
/// What a screen can show.
std::string short_numbers(const std::vector<double>& values) {
  return array_of(values, [](double value) { return std::isfinite(value) ? fmt::format("{:.7g}", value) : "null"; });
}
std::string index_text(std::size_t index) { return std::to_string(index); }

std::string lane_text(const waveform::Lane& lane) {
  return json_line({{"name", json_string(lane.name)}, {"times", numbers(lane.times)}, {"shares", short_numbers(lane.shares)}});
}

std::string marks_text(const waveform::Marks& marks) {
  return json_line({{"name", json_string(marks.name)}, {"x", numbers(marks.x)}, {"colour", json_string(marks.colour)}});
}

std::string event_text(const ToldEvent& told) {
  std::vector<std::string> kinds;
  if (told.event.source_edge) kinds.push_back(json_string("source edge"));
  if (told.event.mode_change) kinds.push_back(json_string("mode change"));
  if (told.event.jump) kinds.push_back(json_string("jump"));
  std::string changes = fmt::format("{}", fmt::join(told.changes, ", "));
  if (told.more_changes > 0) changes += fmt::format(" and {} more", told.more_changes);
  return json_line({{"time", json_number(told.event.time)}, {"kinds", json_line(kinds)}, {"changes", json_string(changes)}});
}

std::vector<std::string> kept_signals(const RunOutcome& outcome, std::size_t count) {
  return {outcome.signals.begin(), outcome.signals.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::string signals_text(const std::vector<std::string>& names, const waveform::ThinnedRows::Rows& rows) {
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < names.size(); ++k)
    texts.push_back(json_line(
        {{"name", json_string(names[k])}, {"unit", json_string(unit_of_signal(names[k]))}, {"values", short_numbers(rows.columns[k])}}));
  return json_line(texts);
}

std::string data_text(const RunOutcome& outcome, const RunReport& run, const RunRecorder& recorder) {
  const waveform::ThinnedRows::Rows rows = recorder.rows();
  const std::vector<std::string> names = kept_signals(outcome, rows.columns.size());
  return json_line({{"run", run_json(outcome, run)},
                    {"from", json_number(recorder.from())},
                    {"to", json_number(recorder.to())},
                    {"thinned", json_truth(recorder.rows_thinned())},
                    {"times", numbers(rows.times)},
                    {"signals", signals_text(names, rows)},
                    {"panels", array_of(panels_of(names), [](const auto& members) { return array_of(members, index_text); })},
                    {"ports", index_text(recorder.ports())},
                    {"lanes", array_of(recorder.lanes(), lane_text)},
                    {"marks", array_of(event_marks(recorder.events()), marks_text)},
                    {"eventCount", std::to_string(recorder.event_count())},
                    {"events", array_of(recorder.told(), event_text)}});
}

constexpr std::size_t most_numbers = 1'500'000;

/// As many signals of all drawn runs as a page can hold; a panel each.
std::size_t shown_signals(const JoinedRows& joined, std::size_t signals) {
  const std::size_t curves = most_numbers / std::max<std::size_t>(joined.times.size() * joined.columns.size(), 1);
  constexpr std::size_t most_panels = 20;
  return std::min({signals, most_panels, std::max<std::size_t>(curves, 1)});
}

std::string sweep_data_text(const RunOutcome& outcome, const RunReport& run) {
  std::vector<waveform::ThinnedRows::Rows> rows;
  std::vector<std::string> names, colours;
  double from = std::numeric_limits<double>::infinity(), to = 0.0;
  bool is_thinned = false;
  for (std::size_t index = 0; index < outcome.sweep.drawn.size(); ++index) {
    const DrawnRun& drawn = outcome.sweep.drawn[index];
    if (!drawn.recorder) continue;
    rows.push_back(drawn.recorder->rows());
    names.push_back(outcome.sweep.name(drawn.run));
    colours.push_back(colour_of_run(outcome.sweep, index));
    from = std::min(from, drawn.recorder->from());
    to = std::max(to, drawn.recorder->to());
    is_thinned = is_thinned || drawn.recorder->rows_thinned();
  }
  const JoinedRows joined = join_rows(rows);
  const std::size_t signals = rows.empty() ? 0 : shown_signals(joined, rows.front().columns.size());
  std::vector<std::string> curves, panels(signals, "[");
  for (std::size_t k = 0; k < signals; ++k) {
    for (std::size_t r = 0; r < names.size(); ++r) {
      panels[k] += (r == 0 ? "" : ",") + index_text(curves.size());
      curves.push_back(json_line({{"name", json_string(outcome.signals[k] + ", " + names[r])},
                                  {"unit", json_string(unit_of_signal(outcome.signals[k]))},
                                  {"colour", json_string(colours[r])},
                                  {"values", short_numbers(joined.columns[r][k])}}));
    }
    panels[k] += "]";
  }
  return json_line({{"run", run_json(outcome, run)},
                    {"from", json_number(rows.empty() ? 0.0 : from)},
                    {"to", json_number(to)},
                    {"thinned", json_truth(is_thinned)},
                    {"times", numbers(joined.times)},
                    {"signals", json_line(curves)},
                    {"panels", json_line(panels)},
                    {"drawnRuns", index_text(names.size())},
                    {"ports", "0"},
                    {"lanes", "[]"},
                    {"marks", array_of(run_marks(outcome.sweep), marks_text)},
                    {"marksTitle", json_string(run_marks_title)},
                    {"eventCount", "0"},
                    {"events", "[]"}});
}

/// No text of the run can end the element that holds it.
std::string for_script(const std::string& json) {
  std::string result;
  for (const char c : json) {
    if (c == '<')
      result += "\\u003c";
    else
      result += c;
  }
  return result;
}

}  // namespace

std::string html_report(const RunOutcome& outcome, const RunReport& run, const RunRecorder* recorder) {
  const RunRecorder nothing(0.0, 0.0, 0);
  const bool is_sweep = !outcome.sweep.list.empty();
  const std::array<std::pair<std::string_view, std::string>, 5> parts{
      {{"@plot_style@", std::string(page_plot_style)},
       {"@style@", std::string(page_style)},
       {"@data@",
        for_script(is_sweep ? sweep_data_text(outcome, run) : data_text(outcome, run, recorder != nullptr ? *recorder : nothing))},
       {"@plot_script@", std::string(page_plot_script)},
       {"@script@", std::string(page_script)}}};
  std::string page;
  std::string_view rest = page_frame;
  for (const auto& [mark, text] : parts) {  // in the order of the frame
    const std::size_t at = rest.find(mark);
    page.append(rest.substr(0, at)).append(text);
    rest.remove_prefix(at + mark.size());
  }
  return page.append(rest);
}

}  // namespace pwlsim::analysis
