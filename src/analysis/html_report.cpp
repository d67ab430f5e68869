#include "analysis/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "analysis/json.hpp"
#include "analysis/orbit_page.hpp"
#include "analysis/page_parts.hpp"
#include "analysis/quantity.hpp"
#include "analysis/run_figure.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

using measure::SolutionRecord;

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
/// Times of ticks and bars: of millions of them more digits make a page of megabytes.
std::string mark_times(const std::vector<double>& values) {
  return array_of(values, [](double value) { return fmt::format("{:.12g}", value); });
}
/// What a screen can show.
std::string short_numbers(const std::vector<double>& values) {
  return array_of(values, [](double value) { return std::isfinite(value) ? fmt::format("{:.7g}", value) : "null"; });
}
std::string index_text(std::size_t index) { return std::to_string(index); }

std::string lane_text(const waveform::Lane& lane) {
  return json_line({{"name", json_string(lane.name)}, {"times", mark_times(lane.times)}, {"shares", short_numbers(lane.shares)}});
}

std::string marks_text(const waveform::Marks& marks) {
  return json_line({{"name", json_string(marks.name)}, {"x", mark_times(marks.x)}, {"colour", json_string(marks.colour)}});
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

/// The saved ones come first.
std::vector<std::string> recorded_names(const RunOutcome& outcome, std::size_t count) {
  std::vector<std::string> names = outcome.signals;
  names.insert(names.end(), outcome.drawn_signals.begin(), outcome.drawn_signals.end());
  names.resize(count);
  return names;
}

std::string schematic_text(const RunOutcome& outcome) { return outcome.schematic.empty() ? "null" : outcome.schematic; }

/// A number to so many digits that its error is below `error`; null where a run that overflows has none.
std::string number_to(double value, double error) {
  constexpr int most_digits = 17;
  if (value == 0.0) return "0";
  if (!std::isfinite(value)) return "null";
  const double wanted = std::ceil(std::log10(std::abs(value) / error)) + 1.0;
  const double digits = std::isnan(wanted) ? most_digits : wanted;
  return fmt::format("{:.{}g}", value, static_cast<int>(std::clamp(digits, 1.0, 1.0 * most_digits)));
}

/// Where statistics keep their digits.
std::string statistic(double value) { return fmt::format("{:.13g}", value); }

/// Bins and pieces of one run: their edges.
std::string record_text(const SolutionRecord& solution, const std::vector<SolutionRecord::Bin>& bins) {
  std::vector<double> bin_edges, edges;
  for (const SolutionRecord::Bin& bin : bins) bin_edges.push_back(bin.from);
  if (!bins.empty()) bin_edges.push_back(bins.back().to);
  for (const SolutionRecord::Piece& piece : solution.pieces()) edges.push_back(piece.from);
  if (!solution.pieces().empty()) edges.push_back(solution.pieces().back().to);
  return json_line({{"bins", numbers(bin_edges)}, {"edges", numbers(edges)}});
}

/// The lengths of a signal's series as hexadecimal digits, less one each.
std::string lengths_text(const SolutionRecord& solution, std::size_t signal) {
  std::string text;
  for (const SolutionRecord::Piece& piece : solution.pieces()) text += "0123456789abcdef"[piece.lengths[signal] - 1];
  return text;
}

/// Digits of coefficients beyond this share of the signal's size are nobody's.
constexpr double least_share = 3e-15;

std::string coefficients_text(const SolutionRecord& solution, std::size_t signal) {
  double size = 0.0;
  std::vector<double> all;
  for (const SolutionRecord::Piece& piece : solution.pieces()) {
    const auto series = measure::series_of(piece, signal);
    const auto& c = series.coefficients();
    all.insert(all.end(), c.begin(), c.begin() + piece.lengths[signal]);
    size = std::max(size, std::abs(c[0]));
  }
  return array_of(all, [error = least_share * size](double value) { return number_to(value, error); });
}

struct PageSignal {
  std::string name, unit, colour;
  std::size_t record = 0, signal = 0;
};

std::string signal_text(const PageSignal& shown, const SolutionRecord& solution, const std::vector<SolutionRecord::Bin>& bins) {
  const auto column = [&](double SolutionRecord::Share::*part) {
    return array_of(bins, [&](const SolutionRecord::Bin& bin) { return statistic(bin.shares[shown.signal].*part); });
  };
  using Share = SolutionRecord::Share;
  return json_line({{"name", json_string(shown.name)},
                    {"unit", json_string(shown.unit)},
                    {"colour", json_string(shown.colour)},
                    {"record", index_text(shown.record)},
                    {"lengths", json_string(lengths_text(solution, shown.signal))},
                    {"coefficients", coefficients_text(solution, shown.signal)},
                    {"least", column(&Share::least)},
                    {"largest", column(&Share::largest)},
                    {"mean", column(&Share::mean)},
                    {"square", column(&Share::square)}});
}

/// The solutions that a page holds, and its signals in them.
struct PageData {
  std::vector<std::string> records, signals;
  bool is_thinned = false;
};

PageData page_data(const std::vector<const SolutionRecord*>& solutions, const std::vector<PageSignal>& shown) {
  PageData data;
  std::vector<std::vector<SolutionRecord::Bin>> bins;
  for (const SolutionRecord* solution : solutions) {
    bins.push_back(solution->bins(std::max<std::size_t>(1, solution->bins_of_page() / solutions.size())));
    data.records.push_back(record_text(*solution, bins.back()));
    data.is_thinned = data.is_thinned || solution->is_thinned();
  }
  for (const PageSignal& each : shown) data.signals.push_back(signal_text(each, *solutions[each.record], bins[each.record]));
  return data;
}

std::string data_text(const RunOutcome& outcome, const RunReport& run, const RunRecorder& recorder) {
  const SolutionRecord& solution = recorder.solution();
  const std::vector<std::string> names = recorded_names(outcome, solution.empty() ? 0 : solution.signals());
  std::vector<PageSignal> shown;
  for (std::size_t k = 0; k < names.size(); ++k) shown.push_back({names[k], std::string(unit_of_signal(names[k])), "", 0, k});
  const PageData page = page_data({&solution}, shown);
  return json_line({{"run", run_json(outcome, run)},
                    {"from", json_number(recorder.from())},
                    {"to", json_number(recorder.to())},
                    {"thinned", json_truth(page.is_thinned)},
                    {"records", json_line(page.records)},
                    {"signals", json_line(page.signals)},
                    {"panels", array_of(panels_of(names), [](const auto& members) { return array_of(members, index_text); })},
                    {"saved", index_text(std::min(names.size(), outcome.signals.size()))},
                    {"leftOut", index_text(outcome.signals.size() + outcome.drawn_signals.size() - names.size())},
                    {"schematic", schematic_text(outcome)},
                    {"ports", index_text(recorder.ports())},
                    {"lanes", array_of(recorder.lanes(), lane_text)},
                    {"marks", array_of(event_marks(recorder.events()), marks_text)},
                    {"eventCount", std::to_string(recorder.event_count())},
                    {"events", array_of(recorder.told(), event_text)}});
}

/// The drawn runs of a sweep, and their common time.
struct SweepPage {
  std::vector<const SolutionRecord*> solutions;
  std::vector<std::string> names, colours;
  double from = std::numeric_limits<double>::infinity(), to = 0.0;
  std::vector<PageSignal> shown;
  std::vector<std::string> panels;  ///< of each quantity: the numbers of what is shown in it

  explicit SweepPage(const SweptRuns& sweep) {
    for (std::size_t index = 0; index < sweep.drawn.size(); ++index) {
      const DrawnRun& drawn = sweep.drawn[index];
      if (!drawn.recorder) continue;
      solutions.push_back(&drawn.recorder->solution());
      names.push_back(sweep.name(drawn.run));
      colours.push_back(colour_of_run(sweep, index));
      from = std::min(from, drawn.recorder->from());
      to = std::max(to, drawn.recorder->to());
    }
    if (solutions.empty()) from = 0.0;
  }

  /// One panel for each of these quantities, with the curves of all runs.
  void add_panels(std::span<const std::string> quantities) {
    panels.assign(quantities.size(), "[");
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      for (std::size_t r = 0; r < names.size(); ++r) {
        panels[k] += (r == 0 ? "" : ",") + index_text(shown.size());
        shown.push_back({quantities[k] + ", " + names[r], std::string(unit_of_signal(quantities[k])), colours[r], r, k});
      }
      panels[k] += "]";
    }
  }
};

std::string sweep_data_text(const RunOutcome& outcome, const RunReport& run) {
  constexpr std::size_t most_panels = 20;
  SweepPage sweep(outcome.sweep);
  const std::size_t signals = sweep.solutions.empty() ? 0 : std::min(most_panels, sweep.solutions.front()->signals());
  sweep.add_panels(std::span(outcome.signals).first(signals));
  const PageData page = page_data(sweep.solutions, sweep.shown);
  return json_line({{"run", run_json(outcome, run)},
                    {"from", json_number(sweep.from)},
                    {"to", json_number(sweep.to)},
                    {"thinned", json_truth(page.is_thinned)},
                    {"records", json_line(page.records)},
                    {"signals", json_line(page.signals)},
                    {"panels", json_line(sweep.panels)},
                    {"quantities", array_of(kept_signals(outcome, signals), json_string)},
                    {"runNames", array_of(sweep.names, json_string)},
                    {"drawnRuns", index_text(sweep.names.size())},
                    {"saved", index_text(sweep.shown.size())},
                    {"schematic", schematic_text(outcome)},
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
  const std::array<std::pair<std::string_view, std::string>, 6> parts{
      {{"@plot_style@", std::string(page_plot_style)},
       {"@style@", std::string(page_style)},
       {"@steady@", orbit_section(outcome)},
       {"@data@",
        for_script(is_sweep ? sweep_data_text(outcome, run) : data_text(outcome, run, recorder != nullptr ? *recorder : nothing))},
       {"@plot_script@", std::string(page_plot_script)},
       {"@script@", page_script()}}};
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
