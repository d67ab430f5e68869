#include "cli/run_context.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/efficiency.hpp"
#include "analysis/quantity.hpp"
#include "analysis/report.hpp"
#include "cli/signals.hpp"
#include "cli/split_files.hpp"

namespace pwlsim::cli {

using analysis::Ending;
using waveform::OutputFile;

std::string RunContext::rows_name() const { return options.split ? split_table(options.output) : options.output; }

double RunContext::seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }

/// A remark on signals that nobody named, measured or draws: with --verbose it is said.
bool RunContext::concerns_nobody(const engine::Remark& remark) const {
  if (remark.signals.empty() || options.verbose || compiled->names_signals || compiled->has_machines || has_pictures()) return false;
  const auto& probes = compiled->measurements.probe_signals;
  return std::none_of(probes.begin(), probes.end(), [&](int probe) {
    const std::string& name = compiled->network.signals[static_cast<std::size_t>(probe)].name;
    return std::find(remark.signals.begin(), remark.signals.end(), name) != remark.signals.end();
  });
}

void RunContext::take_remarks(const engine::Answer& answer) {
  for (const engine::Remark& remark : answer.remarks) {
    if (concerns_nobody(remark))
      messages.keep(analysis::message_of(remark));
    else
      messages.report(analysis::message_of(remark));
  }
  report.statistics = answer.statistics;
  if (!answer.engine.empty()) report.engine = answer.engine;
  report.jumps = answer.jumps;
  if (options.events)
    for (const std::string& text : analysis::jump_texts(answer.jumps, answer.statistics.jumps, compiled->hidden))
      messages.report({Severity::note, "N-jump", {}, text});
  report.certificate = answer.certificate;
  report.seconds.simulate = seconds_search + answer.statistics.seconds_simulate;
  report.seconds.certificate = answer.statistics.seconds_certificate;
}

/// Of a run that ended early the first stands for all.
void RunContext::report_failures(const measure::Results& results, bool is_complete) {
  std::vector<const measure::Result*> failed;
  for (const measure::Result& result : results.list)
    if (!result.failure.empty()) failed.push_back(&result);
  if (failed.empty()) return;
  const std::size_t others = is_complete ? 0 : failed.size() - 1;
  failed.resize(failed.size() - others);
  for (const measure::Result* result : failed) {
    Diagnostic warning = measure::failure_warning(*result);
    if (others > 0) warning.text += fmt::format(" (and so did {})", analysis::counted(others, "other measurement"));
    messages.report(warning, sources);
  }
}

/// Measurements that failed do not make the run one that failed.
int RunContext::report_measurements(const measure::Results& results, bool is_complete) {
  if (results.empty()) return 0;
  report_failures(results, is_complete);
  for (const measure::Result& result : results.list)
    if (!result.left_out.empty()) messages.report(measure::left_out_warning(result), sources);
  for (const measure::FourierResult& result : results.fourier)
    if (!result.failure.empty())
      messages.report(
          {Severity::warning, "W-measurement-failed", {}, fmt::format("Fourier analysis of {} failed: {}", result.column, result.failure)},
          sources);
  for (const Diagnostic& warning : analysis::efficiency_warnings(*compiled, results)) messages.report(warning, sources);
  if (options.json) return 0;
  return print(measure::results_text(results, digits_for(table_stream())), messages, table_stream());
}

void RunContext::note_rows(bool write_failed, bool complete, double end) {
  if (options.no_rows) return;
  const bool lost = write_failed && !rows_file->partial_name().empty();
  outcome.rows = {lost ? rows_file->partial_name() : rows_file->name(), options.format == analysis::RowFormat::raw ? "raw" : "csv",
                  complete, end};
}

/// What stands behind the summary.
void RunContext::tell_details() {
  if (options.verbose) messages.remark(analysis::details(report));
  messages.remark(options.verbose ? analysis::departures_table(messages.departures()) : analysis::departures_line(messages.departures()));
}

int RunContext::conclude(const analysis::TransientRun& run, const OutputFile& file) {
  const std::string kept = options.no_rows ? run.message : fmt::format("{}; the rows up to then are in {}", run.message, file.name());
  switch (run.ending) {
    case Ending::completed:
      messages.remark(analysis::summary(report, options.no_rows ? "nothing" : file.name(), run.answer.time));
      tell_details();
      return 0;
    case Ending::failed:
      return fail(Status::run_failed, run.id, kept);
    case Ending::interrupted:
      fail(Status::run_failed, run.id, kept);
      return status_of_signal(caught_signal());
    case Ending::closed_pipe:
      return static_cast<int>(Status::closed_pipe);
    case Ending::write_failed:
      break;
  }
  return fail(Status::file_error, run.id, run.message);
}

}  // namespace pwlsim::cli
