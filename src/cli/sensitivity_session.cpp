#include "cli/sensitivity_session.hpp"

#include <fmt/format.h>

#include "analysis/quantity.hpp"
#include "cli/analysis_session.hpp"
#include "cli/signals.hpp"
#include "cli/split_files.hpp"

namespace pwlsim::cli {
namespace {

/// `.sens`: derivatives of what the analyses before it have measured, as a table, a file and messages.
class SensitivitySession : public AnalysisSession {
 public:
  [[nodiscard]] bool is_asked(const circuit::Analyses& analyses) const override { return analyses.sensitivities.has_value(); }

  [[nodiscard]] int open_files(RunContext& run) override {
    if (run.options.no_rows || takes_one_table(run.options.output)) return 0;
    return run.open(sensitivity_file_name(run.options.output), run.is_stepped() ? run.sweep_files.derivatives : file_);
  }

  [[nodiscard]] int run(RunContext& run) override {
    analysis::RunOutcome& outcome = run.outcome;
    const analysis::SteadyState* orbit = outcome.steady_state ? &*outcome.steady_state : nullptr;
    outcome.sensitivities =
        analysis::deck_derivatives(*run.compiled, orbit, run.engine.has_modes, caught_signal(), {&run.measured_run, &run.measured_orbit});
    report_derivatives(outcome.sensitivities, run.messages);
    int status = 0;
    if (!run.options.json)
      status = print(analysis::derivative_text(outcome.sensitivities, digits_for(run.table_stream())), run.messages, run.table_stream());
    if (file_ && status == 0) status = write_whole(*file_, analysis::derivative_csv(outcome.sensitivities), run.messages);
    if (status == 0 && analysis::are_interrupted(outcome.sensitivities))
      return fail_by_signal(run.messages, "stopped by a signal before all derivatives were known" +
                                              (file_ ? "; those up to then are in " + file_->name() : std::string()));
    if (file_ && status == 0)
      run.messages.remark(fmt::format("wrote {}: {}\n", file_->name(), analysis::counted(outcome.sensitivities.size(), "derivative")));
    return status;
  }

 private:
  std::optional<waveform::OutputFile> file_;
};

}  // namespace

std::unique_ptr<AnalysisSession> sensitivity_session() { return std::make_unique<SensitivitySession>(); }

void report_derivatives(const analysis::DerivativeTable& table, Messages& messages, const std::string& where) {
  for (const analysis::Derivative& d : table) {
    if (d.failure == analysis::interrupted_derivative) continue;
    if (!d.failure.empty())
      messages.report({Severity::warning,
                       "W-sens-failed",
                       {},
                       fmt::format("{} has no derivative to {}{}: {}", d.measurement, d.parameter, where, d.failure)});
    else if (!d.kink.empty())
      messages.report({Severity::warning,
                       "W-sens-one-sided",
                       {},
                       fmt::format("the derivative of {} to {} is {:.6g} from the left and {:.6g} from the right{}: {}", d.measurement,
                                   d.parameter, d.left, d.right, where, d.kink)});
  }
}

}  // namespace pwlsim::cli
