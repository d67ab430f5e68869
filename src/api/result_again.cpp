// What a result answers by doing its run again.

#include <pwlsim/result.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "analysis/html_report.hpp"
#include "analysis/run_recorder.hpp"
#include "analysis/sampling.hpp"
#include "api/messages.hpp"
#include "api/result_data.hpp"
#include "base/names.hpp"

namespace pwlsim {
namespace {

const KeptRun& kept_run(const Result::Data& data) {
  if (!data.kept) throw api::error("E-not-kept", "the result did not keep its model; try a run with Options::evaluable");
  return *data.kept;
}

/// Of the signal among all that the network has.
std::size_t number_of(const Result::Data& data, std::string_view name) {
  for (std::size_t k = 0; k < data.signals.size(); ++k)
    if (same_name(data.signals[k], name)) return k;
  (void)Result(std::make_shared<Result::Data>(data)).signal(name);  // says what is wrong
  return 0;
}

void check_times(const std::vector<double>& times, double end) {
  for (const double time : times)
    if (!(time >= 0.0 && time <= end))
      throw api::error("E-range", fmt::format("the run has no value at t = {} s; try times from 0 to {} s", time, end));
}

class NoRowWriter : public waveform::RowWriter {
 public:
  bool write(std::span<const double>) override { return true; }
  bool flush() override { return true; }
};

}  // namespace

std::vector<double> Result::at(std::string_view name, const std::vector<double>& times) const {
  const std::size_t number = number_of(*data_, name);
  const KeptRun& kept = kept_run(*data_);
  check_times(times, data_->end);
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
  std::vector<double> ascending;
  for (const std::size_t k : order)
    if (ascending.empty() || times[k] != ascending.back()) ascending.push_back(times[k]);
  analysis::RunControl control;
  std::optional<api::Controllers> controllers;
  if (kept.controllers) control.sampler = &controllers.emplace(api::Controllers::repeating(*kept.controllers));
  const analysis::SampledRun run =
      analysis::sample(kept.compiled->analyses, kept.compiled->network.signals.size(), kept.simulate, ascending, control);
  const std::vector<double>& column = run.columns[number];
  if (column.size() != ascending.size()) throw api::error("E-range", "the run could not be done again up to these times");
  std::vector<double> values(times.size());
  std::size_t place = 0;
  for (const std::size_t k : order) {
    while (ascending[place] != times[k]) ++place;
    values[k] = column[place];
  }
  return values;
}

std::string Result::report() const {
  const KeptRun& kept = kept_run(*data_);
  const circuit::TransientAnalysis& transient = *kept.compiled->analyses.transient;
  analysis::RunRecorder recorder(transient.start.seconds, transient.stop.seconds, kept.compiled->saved_signals());
  NoRowWriter rows;
  analysis::RunControl control;
  control.jumps = true;
  std::optional<api::Controllers> controllers;
  if (kept.controllers) control.sampler = &controllers.emplace(api::Controllers::repeating(*kept.controllers));
  control.recorder = &recorder;
  analysis::TransientRun run = analysis::run_rows(*kept.compiled, kept.simulate, rows, control);
  analysis::RunOutcome outcome;
  outcome.deck = outcome.title = kept.compiled->title;
  outcome.signals = data_->signals;
  outcome.rows = {"", "", run.ending == analysis::Ending::completed, run.answer.time};
  outcome.measurements = std::move(run.measurements);
  analysis::RunReport report;
  report.engine = data_->statistics.engine;
  report.statistics = run.answer.statistics;
  report.certificate = run.answer.certificate;
  report.seconds.simulate = report.seconds.total = run.answer.statistics.seconds_simulate;
  report.jumps = run.answer.jumps;
  for (const Message& message : data_->messages) report.notes.push_back(message.full.substr(0, message.full.find('\n')));
  report.departures = kept.departures;
  return analysis::html_report(outcome, report, &recorder);
}

}  // namespace pwlsim
