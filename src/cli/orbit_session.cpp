/// `.pss`: the orbit, its rows beside those of .tran where the deck has both, and the start of .tran from it.

#include <algorithm>

#include "analysis/orbit_verdict.hpp"
#include "analysis/report.hpp"
#include "analysis/steady_state.hpp"
#include "cli/analysis_session.hpp"
#include "cli/signals.hpp"
#include "cli/split_files.hpp"

namespace pwlsim::cli {
namespace {

using analysis::Ending;
using waveform::OutputFile;

class OrbitSession : public AnalysisSession {
 public:
  [[nodiscard]] bool is_asked(const circuit::Analyses& analyses) const override { return analyses.steady_state.has_value(); }
  [[nodiscard]] bool needs_those_before() const override { return false; }

  [[nodiscard]] int open_files(RunContext& run) override {
    const RunOptions& options = run.options;
    if (!run.analyses().transient) return 0;
    if (!run.is_stepped()) return run.open(options.no_rows ? options.output : orbit_file_name(options.output), file_);
    const bool has_table = !options.no_rows && !takes_one_table(options.output) && options.format == analysis::RowFormat::csv;
    return has_table ? run.open(orbit_file_name(options.output), run.sweep_files.orbit) : 0;
  }

  [[nodiscard]] int run(RunContext& run) override {
    if (!analysis::has_orbit_engine(*run.compiled, run.options.engine))
      return run.fail(Status::run_failed, "E-pss-engine", analysis::orbit_needs_exact_engine);
    const double before = run.seconds();
    run.outcome.steady_state =
        run.orbit_search ? run.orbit_search() : analysis::find_steady_state(*run.compiled, run.options.engine, caught_signal());
    run.seconds_search = run.seconds() - before;
    const analysis::SteadyState& state = *run.outcome.steady_state;
    for (const Diagnostic& message : state.messages) run.messages.report(message);
    const int status = state.is_found || state.has_best_attempt ? rows(run, state) : 0;
    if (!state.is_found) {
      const int failed = fail(run, state);
      return caught_signal() != 0 ? status_of_signal(caught_signal()) : failed;
    }
    return status == 0 && run.analyses().transient ? start_from_orbit(run, state) : status;
  }

 private:
  /// A mistake of the card is shown there.
  static int fail(RunContext& run, const analysis::SteadyState& state) {
    if (!state.is_wrong_input) return run.fail(Status::run_failed, state.id, state.message);
    run.messages.report({Severity::error, state.id, run.analyses().steady_state->span, state.message}, run.sources);
    return static_cast<int>(Status::wrong_input);
  }

  static int start_from_orbit(RunContext& run, const analysis::SteadyState& state) {
    Diagnostics diagnostics;
    run.engine.simulate = analysis::from_orbit(*run.compiled, state, diagnostics);
    run.messages.report(diagnostics, run.sources);
    if (!run.engine.simulate) return static_cast<int>(Status::run_failed);
    if (run.options.no_rows) run.engine.simulate = analysis::without_rows(std::move(run.engine.simulate));
    return 0;
  }

  int rows(RunContext& run, const analysis::SteadyState& state) {
    const bool is_alone = !run.analyses().transient;
    OutputFile& file = is_alone ? *run.rows_file : *file_;
    analysis::RunControl control{run.options.events, true, {}, &caught_signal()};
    control.longest_window = analysis::most_periods_measured * state.orbit.period;
    if (is_alone && run.has_pictures()) control.recorder = &run.recorder.emplace(0.0, state.orbit.period, run.compiled->recorded_signals());
    const auto writer = analysis::row_writer(run.options.format, *run.compiled, file);
    const auto simulate = run.options.no_rows ? analysis::without_rows(state.simulate) : state.simulate;
    analysis::TransientRun orbit = analysis::run_transient(state.compiled, simulate, file, *writer, control);
    const bool is_complete = orbit.ending == Ending::completed;
    if (is_alone) {
      run.take_remarks(orbit.answer);
      run.report.statistics.rows = orbit.rows;
      run.note_rows(orbit.ending == Ending::write_failed, is_complete, orbit.answer.time);
    }
    run.outcome.measurements = std::move(orbit.measurements);
    run.measured_orbit = std::move(orbit.measured);
    const int measured = run.report_measurements(run.outcome.measurements, is_complete);
    run.report.seconds.total = run.seconds();
    if (!is_complete) return std::max(run.conclude(orbit, file), measured);
    if (state.is_found) run.messages.remark(analysis::orbit_summary(state, run.options.no_rows ? "nothing" : file.name()));
    if (is_alone) run.tell_details();
    return measured;
  }

  std::optional<OutputFile> file_;  ///< beside the rows of .tran
};

}  // namespace

std::unique_ptr<AnalysisSession> orbit_session() { return std::make_unique<OrbitSession>(); }

}  // namespace pwlsim::cli
