#include "analysis/swept_runs.hpp"

#include <fmt/format.h>

#include <algorithm>

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

}  // namespace

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

SweptRun swept_run(const TransientRun& run) {
  SweptRun swept;
  swept.done = run.ending == Ending::completed;
  swept.interrupted = run.ending == Ending::interrupted;
  swept.id = run.id;
  swept.message = run.message;
  swept.end = run.answer.time;
  swept.statistics = run.answer.statistics;
  swept.certificate = run.answer.certificate;
  swept.remarks = run.answer.remarks;
  swept.measurements = run.measurements;
  swept.rows = run.rows;
  swept.seconds_write = run.seconds_write;
  return swept;
}

}  // namespace pwlsim::analysis
