/// `.ac`: around the orbit of .pss, or of a linear circuit as it is: response, rows, Bode plot.

#include <fmt/format.h>

#include "analysis/bode_figure.hpp"
#include "analysis/quantity.hpp"
#include "analysis/small_signal_report.hpp"
#include "analysis/steady_state.hpp"
#include "cli/analysis_session.hpp"
#include "cli/signals.hpp"
#include "cli/small_signal_session.hpp"
#include "cli/split_files.hpp"
#include "waveform/png.hpp"

namespace pwlsim::cli {
namespace {

class SmallSignalSession : public AnalysisSession {
 public:
  [[nodiscard]] bool is_asked(const circuit::Analyses& analyses) const override { return analyses.small_signal.has_value(); }

  [[nodiscard]] int open_files(RunContext& run) override {
    const RunOptions& options = run.options;
    const bool has_rows = run.rows_file.has_value();
    const bool has_run = run.analyses().transient.has_value(), goes_to_pipe = takes_one_table(options.output) && !options.no_rows;
    if (const int wrong = check(run); wrong != 0) return wrong;
    if (goes_to_pipe && has_run)
      run.messages.report({Severity::warning, "W-ignored-card", run.analyses().small_signal->span,
                           fmt::format("the rows of .ac are left out: {} takes those of .tran", table_name(options.output))},
                          run.sources);
    int status = 0;
    if (!options.no_rows && !(goes_to_pipe && has_run))
      status = run.open(small_signal_file_name(options.output), run.is_stepped() ? run.sweep_files.response : file_);
    if (status == 0 && !options.plot.empty())
      status = bode_file_.open(has_rows ? bode_file_name(options.plot) : options.plot, run.files, run.messages);
    return status;
  }

  [[nodiscard]] int run(RunContext& run) override {
    auto& response = run.outcome.small_signal;
    if (run.outcome.steady_state) {
      analysis::DeckResponse found = analysis::deck_response(*run.compiled, &*run.outcome.steady_state, &caught_signal());
      if (!found.id.empty()) return fail(run, found.id, found.message);
      response = std::move(found.result);
    } else {
      response = linear_->result(&caught_signal());
    }
    for (const double f : response->singular) run.messages.report(singular_response_warning(f));
    if (!response->impulsive.empty()) run.messages.report(impulsive_response_warning(response->impulsive));
    const int status = file_ ? write_whole(*file_, analysis::small_signal_csv(*response), run.messages) : 0;
    const std::size_t asked = run.analyses().small_signal->frequencies.size();
    if (status == 0 && response->frequencies.size() < asked)
      return fail_by_signal(run.messages, fmt::format("stopped by a signal after {} of {} frequencies{}", response->frequencies.size(),
                                                      asked, file_ ? "; the rows up to then are in " + file_->name() : ""));
    if (status == 0 && (file_ || run.options.no_rows))
      run.messages.remark(analysis::small_signal_summary(*response, file_ ? file_->name() : "nothing"));
    return status;
  }

  [[nodiscard]] int write_pictures(RunContext& run) override {
    if (!bode_file_.is_open() || !(run.outcome.small_signal || analysis::has_response(run.outcome.sweep))) return 0;
    std::string beside;
    const std::string svg = waveform::svg(run.is_stepped() ? analysis::bode_figure(run.outcome.title, run.outcome.sweep)
                                                           : analysis::bode_figure(run.outcome.title, *run.outcome.small_signal));
    return write_picture(bode_file_, svg, run, run.outcome.plot.empty() ? run.outcome.plot : beside);
  }

 private:
  static int fail(RunContext& run, const std::string& id, const std::string& message) {
    const circuit::SmallSignalAnalysis& card = *run.analyses().small_signal;
    const bool names_input = card.input != circuit::SmallSignalAnalysis::Input::marked || !card.loop.empty();
    run.messages.report({Severity::error, id, names_input && id == "E-ac-no-input" ? card.input_span : card.span, message}, run.sources);
    return static_cast<int>(Status::wrong_input);
  }

  /// Before anything is written; of a sweep the first run represents the deck.
  int check(RunContext& run) {
    std::string id, message;
    if (run.analyses().steady_state) {
      message = analysis::small_signal_problem_of_orbit(*run.compiled, id);
      if (id.empty() && !analysis::has_modes(run.compiled->network, run.options.engine)) {
        id = "E-pss-engine";
        message = analysis::response_needs_modes;
      }
    } else {
      linear_.emplace(*run.compiled);
      id = linear_->id();
      message = linear_->message();
    }
    return id.empty() ? 0 : fail(run, id, message);
  }

  std::optional<analysis::LinearSmallSignals> linear_;  ///< of a deck without .pss
  std::optional<waveform::OutputFile> file_;
  PictureFile bode_file_;
};

}  // namespace

Diagnostic singular_response_warning(double frequency, const std::string& where) {
  return {
      Severity::warning,
      "W-ac-singular",
      {},
      fmt::format("the response is infinite at {}{}: a free direction is in resonance there", analysis::quantity(frequency, "Hz"), where)};
}

Diagnostic impulsive_response_warning(const std::vector<std::string>& signals, const std::string& where) {
  return {Severity::warning, "W-ac-impulse", {}, analysis::impulsive_text(signals, where)};
}

std::unique_ptr<AnalysisSession> small_signal_session() { return std::make_unique<SmallSignalSession>(); }

}  // namespace pwlsim::cli
