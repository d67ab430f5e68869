/// `.tran`: rows, measurements, and --check of them.

#include <algorithm>

#include "analysis/check.hpp"
#include "analysis/kept_rows.hpp"
#include "analysis/report.hpp"
#include "cli/analysis_session.hpp"
#include "cli/progress.hpp"
#include "cli/signals.hpp"

namespace pwlsim::cli {
namespace {

using analysis::Ending;

constexpr double check_seconds = 20.0;  ///< that --check may take beside the run

class TransientSession : public AnalysisSession {
 public:
  [[nodiscard]] bool is_asked(const circuit::Analyses& analyses) const override { return analyses.transient.has_value(); }

  [[nodiscard]] int run(RunContext& run) override {
    analysis::TransientRun transient = simulate(run);
    if (run.engine.warning) run.messages.report(*run.engine.warning);
    run.take_remarks(transient.answer);
    run.report.statistics.rows = transient.rows;
    run.report.seconds.write = transient.seconds_write;
    run.report.seconds.total = run.seconds();
    const bool is_complete = transient.ending == Ending::completed;
    run.note_rows(transient.ending == Ending::write_failed, is_complete, transient.answer.time);
    measure::Results own = std::move(transient.measurements);
    run.measured_run = std::move(transient.measured);
    const int measured = is_complete ? 0 : run.report_measurements(own, false);
    const int status = run.conclude(transient, *run.rows_file);  // an error comes last
    const int measured_whole = is_complete ? run.report_measurements(own, true) : 0;
    run.outcome.measurements.add(std::move(own));
    return std::max({status, measured, measured_whole, kept_rows_ && is_complete ? check(run) : 0});
  }

 private:
  analysis::TransientRun simulate(RunContext& run) {
    const circuit::TransientAnalysis& card = *run.analyses().transient;
    const RunOptions& options = run.options;
    Progress progress(options.progress, card.stop.seconds);
    const bool keeps_jumps = options.events || options.json || run.report_file || !options.stats.empty();
    analysis::RunControl control{options.events, keeps_jumps, {}, &caught_signal()};
    if (progress.shown()) control.progress = [&progress](double time) { progress.reached(time); };
    if (run.has_pictures())
      control.recorder = &run.recorder.emplace(card.start.seconds, card.stop.seconds, run.compiled->recorded_signals());
    writer_ = analysis::row_writer(options.format, *run.compiled, *run.rows_file);
    if (options.check) kept_rows_.emplace(*writer_, 1 + run.compiled->saved_signals());
    return analysis::run_transient(*run.compiled, run.engine.simulate, *run.rows_file, kept_rows_ ? *kept_rows_ : *writer_, control);
  }

  /// The rows of a complete run beside the other engine.
  int check(RunContext& run) {
    run.outcome.check = analysis::check_run(*run.compiled, *kept_rows_, {run.engine.name, run.reltol, check_seconds, &caught_signal()});
    const analysis::Check& check = *run.outcome.check;
    if (caught_signal() != 0) return fail_by_signal(run.messages, "interrupted during the check; the rows are complete");
    const int printed = run.options.json ? 0 : print(analysis::check_text(check), run.messages, run.table_stream());
    if (check.agreement == analysis::Agreement::differs) return run.fail(Status::run_failed, "E-check-differs", check.reason);
    if (check.agreement == analysis::Agreement::undecided)
      run.messages.report({Severity::warning, "W-check-undecided", {}, "the check came to no verdict: " + check.reason});
    return printed;
  }

  std::unique_ptr<waveform::RowWriter> writer_;
  std::optional<analysis::KeptRows> kept_rows_;  ///< for --check
};

}  // namespace

std::unique_ptr<AnalysisSession> transient_session() { return std::make_unique<TransientSession>(); }

}  // namespace pwlsim::cli
