/// `.ac`: around the orbit of .pss, or of a linear circuit as it is: response, rows, Bode plot.

#include <fmt/format.h>

#include "analysis/bode_figure.hpp"
#include "analysis/quantity.hpp"
#include "analysis/steady_state.hpp"
#include "cli/analysis_session.hpp"
#include "cli/split_files.hpp"
#include "waveform/png.hpp"

namespace pwlsim::cli {
namespace {

struct Failure {
  std::string id, message;
};

/// Empty where there is a response.
Failure find_response(const circuit::Compiled& compiled, analysis::RunOutcome& outcome) {
  if (!compiled.analyses.steady_state) {
    Failure failure;
    outcome.small_signal = analysis::linear_small_signals(compiled, failure.id, failure.message);
    return failure;
  }
  const analysis::SteadyState& state = *outcome.steady_state;
  if (!state.inputs->id.empty()) return {state.inputs->id, state.inputs->message};
  if (!state.orbit.kink.empty()) return {"E-ac-no-derivative", "the orbit has no derivative: " + state.orbit.kink};
  outcome.small_signal = analysis::small_signals(compiled, state);
  return {};
}

/// Beside a .tran without .pss, as in decks of other simulators, it is left out with a warning where it cannot be.
class SmallSignalSession : public AnalysisSession {
 public:
  [[nodiscard]] bool is_asked(const circuit::Analyses& analyses) const override { return analyses.small_signal.has_value(); }

  [[nodiscard]] int open_files(RunContext& run) override {
    const RunOptions& options = run.options;
    const bool has_rows = run.rows_file.has_value();
    const bool has_run = run.analyses().transient.has_value(),
               goes_to_pipe = options.output == "-" && !run.is_stepped() && !options.no_rows;
    if (goes_to_pipe && has_run)
      run.messages.report({Severity::warning, "W-ignored-card", run.analyses().small_signal->span,
                           "the rows of .ac are left out: standard output takes those of .tran"},
                          run.sources);
    int status = 0;
    if (!options.no_rows && !run.is_stepped() && !(goes_to_pipe && has_run))
      status = run.open(small_signal_file_name(run.rows_name()), file_);
    if (status == 0 && !options.plot.empty())
      status = bode_file_.open(has_rows ? bode_file_name(options.plot) : options.plot, run.files, run.messages);
    return status;
  }

  [[nodiscard]] int run(RunContext& run) override {
    auto& response = run.outcome.small_signal;
    if (const Failure failure = find_response(*run.compiled, run.outcome); !failure.id.empty()) {
      response.reset();
      const circuit::Analyses& analyses = run.analyses();
      if (analyses.steady_state || !analyses.transient) return run.fail(Status::wrong_input, failure.id, failure.message);
      run.messages.report(
          {Severity::warning, "W-ignored-card", analyses.small_signal->span, fmt::format(".ac is ignored: {}", failure.message)},
          run.sources);
      return 0;
    }
    for (const double f : response->singular)
      run.messages.report({Severity::warning,
                           "W-ac-singular",
                           {},
                           fmt::format("the response is infinite at {}: a free direction of the orbit is in resonance there",
                                       analysis::quantity(f, "Hz"))});
    if (!file_) return 0;
    const int status = write_whole(*file_, analysis::small_signal_csv(*response), run.messages);
    if (status == 0) run.messages.remark(analysis::small_signal_summary(*response, file_->name()));
    return status;
  }

  [[nodiscard]] int write_pictures(RunContext& run) override {
    if (!bode_file_.is_open() || !run.outcome.small_signal) return 0;
    std::string beside;
    const std::string svg = waveform::svg(analysis::bode_figure(run.outcome.title, *run.outcome.small_signal));
    return write_picture(bode_file_, svg, run, run.outcome.plot.empty() ? run.outcome.plot : beside);
  }

 private:
  std::optional<waveform::OutputFile> file_;
  PictureFile bode_file_;
};

}  // namespace

std::unique_ptr<AnalysisSession> small_signal_session() { return std::make_unique<SmallSignalSession>(); }

}  // namespace pwlsim::cli
