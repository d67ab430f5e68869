#include "analysis/swept_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

void add(engine::Statistics& sum, const engine::Statistics& one) {
  sum.islands = std::max(sum.islands, one.islands);
  sum.states = std::max(sum.states, one.states);
  sum.ports = std::max(sum.ports, one.ports);
  sum.switches = std::max(sum.switches, one.switches);
  sum.modes_visited += one.modes_visited;
  sum.events += one.events;
  sum.jumps += one.jumps;
  sum.accumulations += one.accumulations;
  sum.lcp_pivots += one.lcp_pivots;
  sum.klu_factorizations += one.klu_factorizations;
  sum.klu_solves += one.klu_solves;
  sum.steps += one.steps;
  sum.seconds_simulate += one.seconds_simulate;
  sum.seconds_certificate += one.seconds_certificate;
}

void add(engine::Certificate& worst, const engine::Certificate& one, bool is_first) {
  worst.complementarity = std::max(worst.complementarity, one.complementarity);
  worst.kcl_kvl = std::max(worst.kcl_kvl, one.kcl_kvl);
  worst.energy = std::max(worst.energy, one.energy);
  worst.has_passivity = one.has_passivity && (is_first || worst.has_passivity);
  worst.passive = one.passive && (is_first || worst.passive);
  worst.points_checked += one.points_checked;
}

using Value = std::function<std::optional<double>(const SweptRun& run, std::size_t column)>;

std::string table_of(const SweptRuns& runs, const std::vector<std::string>& names, int digits, const Value& value) {
  std::string text = sweep_head(runs.sweeps, names);
  for (std::size_t run = 0; run < runs.list.size(); ++run) {
    for (const double stepped : runs.sweeps.point(run)) text += waveform::rounded(stepped, digits) + ",";
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::optional<double> found = value(runs.list[run], k);
      text += (found ? waveform::rounded(*found, digits) : "failed") + ",";
    }
    text.back() = '\n';
  }
  return text;
}

}  // namespace

std::string failure_text(const SweptRun& run) {
  if (run.done) return "";
  return run.id.empty() ? "interrupted" : fmt::format("{}: {}", run.id, run.message);
}

SweptRuns::SweptRuns(const circuit::Sweeps& steps, bool with_pictures) : sweeps(steps), list(steps.runs()) {
  const std::size_t count = with_pictures ? std::min(list.size(), most_drawn) : 0;
  for (std::size_t k = 0; k < count; ++k) drawn.push_back({count == 1 ? 0 : k * (list.size() - 1) / (count - 1), std::nullopt});
}

std::string SweptRuns::name(std::size_t run) const {
  std::string text;
  const std::vector<double> values = sweeps.point(run);
  for (std::size_t k = 0; k < values.size(); ++k)
    text += fmt::format("{}{}={}", k == 0 ? "" : ", ", sweeps.list[k].name, waveform::shortest(values[k]));
  return text;
}

std::optional<RunRecorder>* SweptRuns::recorder_of(std::size_t run) {
  const auto found = std::find_if(drawn.begin(), drawn.end(), [&](const DrawnRun& each) { return each.run == run; });
  return found == drawn.end() ? nullptr : &found->recorder;
}

void SweptRuns::sum_up(RunReport& report) const {
  report.runs = list.size();
  for (const SweptRun& run : list) {
    add(report.statistics, run.statistics);
    report.statistics.rows += run.rows;
    add(report.certificate, run.certificate, &run == &list.front());
    report.seconds.write += run.seconds_write;
    report.failed_runs += static_cast<std::uint64_t>(!run.done);
  }
  report.seconds.simulate = report.statistics.seconds_simulate;
  report.seconds.certificate = report.statistics.seconds_certificate;
}

void take_transient(const TransientRun& transient, SweptRun& run) {
  run.done = run.id.empty() && transient.ending == Ending::completed;
  run.interrupted = transient.ending == Ending::interrupted;
  if (run.id.empty()) {
    run.id = transient.id;
    run.message = transient.message;
  }
  run.end = transient.answer.time;
  run.statistics = transient.answer.statistics;
  run.certificate = transient.answer.certificate;
  run.remarks = transient.answer.remarks;
  run.measurements = transient.measurements;
  run.measured = transient.measured;
  run.rows = transient.rows;
  run.seconds_write = transient.seconds_write;
}

void take_operating_point(const engine::OperatingPoint& point, SweptRun& run) {
  run.statistics = point.answer.statistics;
  run.certificate = point.answer.certificate;
  run.remarks = point.answer.remarks;
  run.id = point.answer.id;
  run.message = point.answer.message;
  run.done = point.answer.outcome == engine::Outcome::completed;
  if (run.done) run.operating_point = point.values;
}

std::string sweep_head(const circuit::Sweeps& sweeps, const std::vector<std::string>& columns) {
  std::string text;
  for (const circuit::Sweep& sweep : sweeps.list) text += waveform::csv_field(sweep.name) + ",";
  for (const std::string& column : columns) text += waveform::csv_field(column) + ",";
  text.back() = '\n';
  return text;
}

std::string sweep_prefix(const circuit::Sweeps& sweeps, std::size_t run) {
  std::string text;
  for (const double stepped : sweeps.point(run)) text += waveform::shortest(stepped) + ",";
  return text;
}

std::string operating_point_table(const SweptRuns& runs, const std::vector<std::string>& signals, int digits) {
  return table_of(runs, signals, digits, [](const SweptRun& run, std::size_t k) {
    return k < run.operating_point.size() ? std::optional(run.operating_point[k]) : std::nullopt;
  });
}

std::string measurement_table(const SweptRuns& runs, const circuit::Measurements& measurements, int digits) {
  std::vector<std::string> names;
  for (const circuit::Measurement& measurement : measurements.list)
    if (measurement.shown) names.push_back(measurement.name);
  return table_of(runs, names, digits, [](const SweptRun& run, std::size_t k) {
    const auto& results = run.measurements.list;
    return k < results.size() && results[k].failure.empty() ? std::optional(results[k].value) : std::nullopt;
  });
}

std::string file_table(const SweptRuns& runs) {
  std::string text = sweep_head(runs.sweeps, {"file", "rows", "end", "failure"});
  for (std::size_t k = 0; k < runs.list.size(); ++k) {
    const SweptRun& run = runs.list[k];
    text += sweep_prefix(runs.sweeps, k);
    const std::string name = std::filesystem::path(run.file).filename().string();
    text += fmt::format("{},{},{},{}\n", waveform::csv_field(name), run.rows, waveform::shortest(run.end),
                        waveform::csv_field(failure_text(run)));
  }
  return text;
}

}  // namespace pwlsim::analysis
