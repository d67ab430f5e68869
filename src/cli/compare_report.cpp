#include "cli/compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/json.hpp"
#include "analysis/quantity.hpp"
#include "waveform/svg_plot.hpp"

namespace pwlsim::cli {
namespace {

using analysis::json_number;
using analysis::json_string;
using analysis::json_truth;
using analysis::quantity;

const spice::Level* finest(const spice::Study& study) { return study.signals.empty() ? nullptr : &study.levels[study.finest_level]; }

std::string method(const spice::Level& level) {
  return std::string(level.deck.gear ? "gear" : "trap") + (level.deck.snubber.impedance > 0.0 ? "+rc" : "");
}

std::string signal_lines(const CompareReport& report) {
  std::size_t width = 6;
  for (const auto& signal : report.comparison.signals) width = std::max(width, signal.name.size());
  std::string text = fmt::format("\n{:<{}}  {:>10}  {:>10}  {:>12}  {:>14}  {:>10}\n", "signal", width, "maximum", "difference", "at t (s)",
                                 "discretisation", "smoothing");
  for (const auto& signal : report.comparison.signals) {
    const char* verdict = signal.explained ? "explained" : signal.settled ? "NOT explained" : "not settled";
    text += fmt::format("{:<{}}  {:>10.4g}  {:>10.1e}  {:>12.5g}  {:>14.1e}  {:>10.1e}  {}\n", signal.name, width, signal.scale,
                        signal.difference, signal.time, signal.discretisation, signal.smoothing, verdict);
  }
  text += fmt::format(
      "Differences are the largest at {} times between events, relative to the signal's maximum. ngspice solves a smoothed circuit:\n"
      "discretisation and smoothing are its own errors, estimated by refining it. \"explained\": the difference is at most {:g} times "
      "their sum.\n"
      "\"NOT explained\": the smoothed circuit has another limit, as an elastic stop in place of an inelastic one. \"not settled\": "
      "ngspice's\n"
      "own answer still moves, so that its error is not known.\n",
      report.samples, spice::safety);
  return text;
}

std::string event_lines(const CompareReport& report) {
  if (report.events_skipped) return "\nToo many events to compare their times.\n";
  if (report.comparison.events.empty()) return "";
  std::string text = fmt::format("\n{:<12}  {:>14}  {:>16}  {:>14}  {:>12}\n", "element", "changes pwlsim", "changes ngspice",
                                 "worst time off", "at t (s)");
  for (const auto& events : report.comparison.events)
    text += fmt::format("{:<12}  {:>14}  {:>16}  {:>14}  {:>12.6g}\n", events.name, events.exact, events.ngspice,
                        quantity(events.worst, "s"), events.at);
  return text;
}

std::string level_lines(const spice::Study& study) {
  std::string text = fmt::format("\n{:<10}  {:>10}  {:>8}  {:>8}  {:>6}  {:>9}  {:>9}  {:>9}\n", "refined", "step (s)", "reltol", "X",
                                 "method", "points", "CPU (s)", "change");
  for (const spice::Level& level : study.levels) {
    const std::string change = level.change < 0.0 ? "-" : fmt::format("{:.1e}", level.change);
    text += fmt::format("{:<10}  {:>10.3g}  {:>8.1e}  {:>8.1e}  {:>6}  {:>9}  {:>9.4g}  {:>9}\n", level.smoothing ? "smoothing" : "step",
                        level.deck.largest_step, level.deck.reltol, level.deck.sharpness, method(level), level.points, level.seconds,
                        level.failure.empty() ? change : "failed: " + level.failure);
  }
  return text;
}

std::string times_line(const CompareReport& report) {
  const auto& statistics = report.exact.statistics;
  const double own = statistics.seconds_simulate;
  std::string text = fmt::format("pwlsim ({} engine): {} for {} rows and {} events\n", report.engine, quantity(own, "s"),
                                 report.grid.times.size(), statistics.events);
  if (const spice::Level* level = finest(report.study))
    text += fmt::format("ngspice, finest level: {} of CPU time for {} points\n", quantity(level->seconds, "s"), level->points);
  return text;
}

/// On average over the sample times: where a contact interrupts an inductor's current, two right answers may lie apart for an instant.
bool is_agreed(const spice::ComparedSignal& signal) {
  constexpr double agreement = 2e-2;
  return signal.explained || signal.mean <= agreement;
}

/// The signal that differs most by some measure, of those that `counts` names.
template <class Measure, class Counts>
const spice::ComparedSignal* most_different(const spice::Comparison& comparison, const Measure& measure, const Counts& counts) {
  const spice::ComparedSignal* worst = nullptr;
  for (const spice::ComparedSignal& signal : comparison.signals)
    if (counts(signal) && (worst == nullptr || measure(signal) > measure(*worst))) worst = &signal;
  return worst;
}

const char* reason_of(const spice::ComparedSignal& signal) {
  return signal.settled ? "the smoothed circuit has another limit than the ideal one" : "ngspice's own answer has not settled there";
}

constexpr double remarkable = 1e-2;  ///< of an instant: it is named

std::string percent(double share) {
  constexpr double rounding = 1e-9;
  return share < rounding ? "rounding" : fmt::format("{:.{}g} %", 100.0 * share, share < 0.1 ? 2 : 3);
}

/// What ngspice said of its last failure.
std::string words_of_failures(const spice::Study& study) {
  return study.levels.empty() ? "" : fmt::format(" ({})", study.levels.back().failure);
}

void write_levels(analysis::JsonWriter& json, const spice::Study& study) {
  json.key("levels");
  json.begin_array();
  for (const spice::Level& level : study.levels)
    json.value(analysis::json_line({{"refined", json_string(level.smoothing ? "smoothing" : "step")},
                                    {"largest_step", json_number(level.deck.largest_step)},
                                    {"reltol", json_number(level.deck.reltol)},
                                    {"smooth", json_number(level.deck.sharpness)},
                                    {"method", json_string(method(level))},
                                    {"points", std::to_string(level.points)},
                                    {"seconds", json_number(level.seconds)},
                                    {"change", level.change < 0.0 ? "null" : json_number(level.change)},
                                    {"failure", level.failure.empty() ? "null" : json_string(level.failure)}}));
  json.end_array();
}

void write_signals(analysis::JsonWriter& json, const spice::Comparison& comparison) {
  json.key("signals");
  json.begin_array();
  for (const auto& signal : comparison.signals)
    json.value(analysis::json_line({{"name", json_string(signal.name)},
                                    {"maximum", json_number(signal.scale)},
                                    {"difference", json_number(signal.difference)},
                                    {"mean_difference", json_number(signal.mean)},
                                    {"at", json_number(signal.time)},
                                    {"discretisation", json_number(signal.discretisation)},
                                    {"smoothing", json_number(signal.smoothing)},
                                    {"settled", json_truth(signal.settled)},
                                    {"explained", json_truth(signal.explained)}}));
  json.end_array();
}

void write_events(analysis::JsonWriter& json, const CompareReport& report) {
  json.key("events");
  json.begin_array();
  for (const auto& events : report.comparison.events)
    json.value(analysis::json_line({{"name", json_string(events.name)},
                                    {"pwlsim", std::to_string(events.exact)},
                                    {"ngspice", std::to_string(events.ngspice)},
                                    {"worst", json_number(events.worst)},
                                    {"at", json_number(events.at)}}));
  json.end_array();
}

}  // namespace

std::string compare_verdict(const CompareReport& report) {
  const std::string window =
      report.is_cut ? fmt::format(" (the first {} of {})", quantity(report.until, "s", 3), quantity(report.stop, "s", 3)) : "";
  const std::string own = "pwlsim " + quantity(report.seconds_window, "s", 3);
  const spice::Level* level = finest(report.study);
  if (level == nullptr)
    return fmt::format("no verdict{}: ngspice did not reach the end at any setting{}; {}", window, words_of_failures(report.study), own);
  const std::string times = fmt::format("ngspice {}, {}", quantity(level->seconds, "s", 3), own);
  const auto average = [](const spice::ComparedSignal& signal) { return signal.mean; };
  const auto largest = [](const spice::ComparedSignal& signal) { return signal.difference; };
  if (const auto* worst = most_different(report.comparison, average, [](const auto& signal) { return !is_agreed(signal); }))
    return fmt::format("differs by {} in {}{}: {}; {}", percent(worst->mean), worst->name, window, reason_of(*worst), times);
  const auto* worst = most_different(report.comparison, average, [](const auto&) { return true; });
  if (worst == nullptr) return fmt::format("no signal differs from zero{}: {}", window, times);
  const auto* apart =
      most_different(report.comparison, largest, [](const auto& signal) { return !signal.explained && signal.difference > remarkable; });
  const std::string instant = apart == nullptr ? ""
                                               : fmt::format("; {} is {} apart at t = {}: {}", apart->name, percent(apart->difference),
                                                             quantity(apart->time, "s", 5), reason_of(*apart));
  return fmt::format("agrees to {}{}: {}{}", percent(worst->mean), window, times, instant);
}

std::string compare_text(const CompareReport& report, bool verbose) {
  const std::string verdict = fmt::format("{}: {}\n", report.deck, compare_verdict(report));
  if (!verbose) return verdict;
  std::string text = verdict + times_line(report);
  text += report.comparison.signals.empty() ? "\nngspice did not reach the end with any setting: there is nothing to compare.\n"
                                            : signal_lines(report);
  return text + event_lines(report) + level_lines(report.study);
}

std::string compare_json(const CompareReport& report) {
  analysis::JsonWriter json;
  const spice::Level* level = finest(report.study);
  json.begin_object();
  json.member("deck", json_string(report.deck));
  json.member("engine", json_string(report.engine));
  json.member("skipped", "null");
  json.member("verdict", json_string(compare_verdict(report)));
  json.member("until", json_number(report.until));
  json.member("samples", std::to_string(report.samples));
  json.member("pwlsim", analysis::json_line({{"seconds_window", json_number(report.seconds_window)},
                                             {"seconds_simulate", json_number(report.exact.statistics.seconds_simulate)},
                                             {"seconds_model", json_number(report.exact.statistics.seconds_model)},
                                             {"rows", std::to_string(report.grid.times.size())},
                                             {"events", std::to_string(report.exact.statistics.events)}}));
  json.member("ngspice", level == nullptr
                             ? "null"
                             : analysis::json_line({{"seconds", json_number(level->seconds)}, {"points", std::to_string(level->points)}}));
  write_signals(json, report.comparison);
  write_events(json, report);
  write_levels(json, report.study);
  json.end_object();
  return json.take();
}

std::string compare_svg(const CompareReport& report, const std::vector<std::string>& names) {
  constexpr std::size_t most_panels = 12;
  waveform::Figure figure{fmt::format("{}: pwlsim and ngspice on the smoothed circuit", report.deck), "time", "s", {}};
  for (std::size_t k = 0; k < std::min(names.size(), most_panels); ++k) {
    waveform::Panel panel{names[k], {{"pwlsim", report.grid.times, report.grid.columns[k], false}}};
    if (k < report.study.finest.signals.size()) {
      const spice::SignalReader reader(report.study.waveforms, report.study.finest.signals[k]);
      waveform::Curve curve{"ngspice", {}, {}, true};
      for (std::size_t row = 0; row < report.study.waveforms.rows(); ++row) {
        curve.x.push_back(report.study.waveforms.at(row, 0));
        curve.y.push_back(reader.at_row(row));
      }
      panel.curves.push_back(std::move(curve));
    }
    figure.panels.push_back(std::move(panel));
  }
  return waveform::svg(figure);
}

}  // namespace pwlsim::cli
