#include "cli/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "analysis/abandonable.hpp"
#include "analysis/bode_figure.hpp"
#include "analysis/check.hpp"
#include "analysis/efficiency.hpp"
#include "analysis/fitted_diodes.hpp"
#include "analysis/html_report.hpp"
#include "analysis/kept_rows.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/quantity.hpp"
#include "analysis/report.hpp"
#include "analysis/row_grid.hpp"
#include "analysis/run_figure.hpp"
#include "analysis/run_json.hpp"
#include "analysis/run_recorder.hpp"
#include "analysis/steady_state.hpp"
#include "analysis/transient.hpp"
#include "cli/deck_reader.hpp"
#include "cli/picture_file.hpp"
#include "cli/progress.hpp"
#include "cli/schematic_json.hpp"
#include "cli/sensitivity_session.hpp"
#include "cli/signals.hpp"
#include "cli/small_signal_session.hpp"
#include "cli/split_files.hpp"
#include "cli/sweep_session.hpp"

namespace pwlsim::cli {
namespace {

using analysis::Ending;
using waveform::OutputFile;
using Clock = std::chrono::steady_clock;

constexpr double check_seconds = 20.0;  ///< that --check may take beside the run

class Session {
 public:
  explicit Session(const RunOptions& options) : options_(options), messages_(options.quiet) {}

  int run() {
    outcome_.deck = options_.deck;
    outcome_.status = run_analyses();
    report_.seconds.total = since(start_);
    outcome_.status = std::max(outcome_.status, write_statistics());
    return options_.json ? std::max(outcome_.status, print_json()) : outcome_.status;
  }

 private:
  int run_analyses() {
    int status = prepare();
    if (status == 0) status = open_files();
    if (status != 0) return status;
    if (compiled_->analyses.sweeps.runs() > 0) {
      status = sweep();
    } else {
      if (compiled_->analyses.operating_point) status = operating_point();
      if (compiled_->analyses.steady_state) status = std::max(status, steady_state());
      if (compiled_->analyses.small_signal && status == 0) status = run_small_signal(*compiled_, sources_, small_signal_file_ ? &*small_signal_file_ : nullptr, outcome_, messages_);
      if (compiled_->analyses.transient && status == 0) status = std::max(status, transient());
      if (compiled_->analyses.sensitivities && status == 0) status = sensitivities();
    }
    outcome_.status = status;
    const bool rows_are_lost = status == static_cast<int>(Status::file_error) || status == static_cast<int>(Status::closed_pipe);
    return rows_are_lost ? status : std::max(status, write_pictures());
  }

  static double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

  int fail(Status status, std::string id, std::string text) { return cli::fail(messages_, status, std::move(id), std::move(text)); }
  /// 0, or the status of a signal that came while nothing had been written yet.
  int interrupted_before_run() {
    const int signal_number = caught_signal();
    if (signal_number == 0) return 0;
    messages_.report({Severity::error, "E-interrupted", {}, "interrupted before the run began; nothing was written"});
    return status_of_signal(signal_number);
  }

  int prepare();
  int open_files();
  int check_split();
  void warn_of_size();
  int check_can_be_made();
  int sweep();
  int operating_point();
  int steady_state();
  int orbit_rows(const analysis::SteadyState& state);
  int transient();
  int sensitivities();
  int check();
  int conclude(const analysis::TransientRun& run, const OutputFile& file);
  int report_measurements(const measure::Results& results, bool is_complete);
  void report_failures(const measure::Results& results, bool is_complete);
  int write_pictures();
  void take_messages();
  int written(int status, const std::string& name, std::string& noted);
  int write_statistics();
  int print_json();
  void note_rows(bool write_failed, bool complete, double end);
  void tell_details();
  bool concerns_nobody(const engine::Remark& remark) const;
  void take_remarks(const engine::Answer& answer);

  const RunOptions& options_;
  const Clock::time_point start_ = Clock::now();
  Messages messages_;
  SourceStore sources_;
  netlist::Deck deck_;
  std::vector<std::string> files_;  ///< that were read
  std::optional<circuit::Compiled> compiled_;
  analysis::PreparedEngine engine_;
  double reltol_ = 0.0;
  std::optional<OutputFile> orbit_file_, small_signal_file_, sensitivity_file_, rows_file_, statistics_file_, report_file_;
  PictureFile plot_file_, bode_file_;
  std::optional<analysis::KeptRows> kept_rows_;  ///< for --check
  std::optional<analysis::RunRecorder> recorder_;
  analysis::RunReport report_;
  analysis::RunOutcome outcome_;
};

int Session::prepare() {
  DeckReading reading = read_deck(options_.deck, {.measure = true}, sources_, messages_, !options_.report.empty());
  report_.seconds.parse = reading.seconds_parse;
  report_.seconds.flatten = reading.seconds_flatten;
  outcome_.title = reading.deck.title;
  if (!reading.compiled) return static_cast<int>(reading.status);
  compiled_ = std::move(reading.compiled);
  deck_ = std::move(reading.deck);
  files_ = std::move(reading.files);
  outcome_.schematic = schematic_json(reading.drawing, reading.places);
  const std::vector<std::string> names = analysis::column_names(*compiled_);
  outcome_.signals.assign(names.begin() + 1, names.end());
  for (std::size_t k = compiled_->saved_signals(); k < compiled_->recorded_signals(); ++k)
    outcome_.drawn_signals.push_back(compiled_->network.signals[k].name);
  if (const int signalled = interrupted_before_run(); signalled != 0) return signalled;
  Diagnostics diagnostics;
  const auto model_start = Clock::now();
  reltol_ = analysis::relative_tolerance(options_.reltol, compiled_->analyses);
  if (compiled_->analyses.sweeps.runs() == 0)
    if (auto note = analysis::fit_diodes(*compiled_, options_.engine, reltol_, &caught_signal())) messages_.report(*note, sources_);
  engine_ = analysis::prepare_engine(compiled_->network, options_.engine, reltol_, diagnostics, caught_signal());
  report_.engine = engine_.name;
  report_.seconds.model = since(model_start);
  messages_.report(diagnostics, sources_);
  if (const int signalled = interrupted_before_run(); signalled != 0) return signalled;
  if (!engine_.simulate || diagnostics.has_errors()) return static_cast<int>(Status::wrong_input);
  if (options_.no_rows) engine_.simulate = analysis::without_rows(std::move(engine_.simulate));
  return 0;
}

int Session::check_split() {
  const std::size_t runs = compiled_->analyses.sweeps.runs();
  if (runs == 0) return fail(Status::wrong_input, "E-no-step", "the deck has no .step: there is only one run; try without --split");
  if (!compiled_->analyses.transient)
    return fail(Status::wrong_input, "E-no-transient", "the deck has no .tran: there are no rows to split; try without --split");
  for (std::size_t run = 0; run < runs; ++run)
    if (const int status = check_output(split_file(options_.output, run), files_, messages_); status != 0) return status;
  return 0;
}

/// --check compares the waveforms of one run.
int Session::check_can_be_made() {
  if (!compiled_->analyses.transient)
    return fail(Status::wrong_input, "E-no-transient", "the deck has no .tran: there are no waveforms to check; try without --check");
  if (compiled_->analyses.sweeps.runs() > 0)
    return fail(Status::wrong_input, "E-check-sweep", "--check compares one run, and the deck has .step; try a deck with one of its runs");
  return 0;
}

/// Before gigabytes are written. Pipes and devices take what they are given.
void Session::warn_of_size() {
  constexpr double large = 1e9, text_bytes = 19.0;  // of a number of 16 digits with what stands around it, on average
  std::error_code unknown;
  const auto kind = std::filesystem::status(options_.output, unknown).type();
  if (options_.output == "-" || (kind != std::filesystem::file_type::regular && kind != std::filesystem::file_type::not_found)) return;
  const auto runs = static_cast<double>(std::max<std::size_t>(1, compiled_->analyses.sweeps.runs()));
  const auto rows = static_cast<double>(analysis::row_grid(*compiled_->analyses.transient).rows);
  const auto columns = static_cast<double>(1 + compiled_->saved_signals() + compiled_->analyses.sweeps.list.size());
  const double bytes = runs * rows * columns * (options_.format == analysis::RowFormat::raw ? sizeof(double) : text_bytes);
  if (bytes > large)
    messages_.report(
        {Severity::warning,
         "W-large-output",
         {},
         fmt::format(
             "about {:.2g} GB of rows go to {} ({:.3g} rows of {} columns); try a larger Tstep, .save of fewer signals, or --no-rows",
             1e-9 * bytes, options_.output, runs * rows, columns)});
}

int Session::open_files() {
  int status = options_.split ? check_split() : 0;
  if (status == 0 && options_.check) status = check_can_be_made();
  const std::string rows = options_.split ? split_table(options_.output) : options_.output;
  const bool has_orbit = compiled_->analyses.steady_state.has_value();
  if (status == 0 && (compiled_->analyses.transient || has_orbit)) status = open_output(rows, files_, messages_, rows_file_);
  const bool is_stepped = compiled_->analyses.sweeps.runs() > 0;
  const bool has_run = compiled_->analyses.transient.has_value(), goes_to_pipe = options_.output == "-" && !is_stepped && !options_.no_rows;
  if (status == 0 && goes_to_pipe && has_orbit && (has_run || compiled_->analyses.small_signal))
    return fail(Status::wrong_input, "E-option-conflict",
                "the analyses of the deck have rows of their own each, and standard output takes one table; try -o with a file name");
  const bool has_response_rows = compiled_->analyses.small_signal && !options_.no_rows && !is_stepped && !(goes_to_pipe && has_run);
  if (compiled_->analyses.small_signal && goes_to_pipe && has_run)
    messages_.report({Severity::warning, "W-ignored-card", compiled_->analyses.small_signal->span, "the rows of .ac are left out: standard output takes those of .tran"},
                     sources_);
  if (status == 0 && has_response_rows)
    status = open_output(small_signal_file_name(rows), files_, messages_, small_signal_file_);
  if (status == 0 && compiled_->analyses.sensitivities && !options_.no_rows && !is_stepped && options_.output != "-")
    status = open_output(sensitivity_file_name(rows), files_, messages_, sensitivity_file_);
  if (status == 0 && compiled_->analyses.transient && has_orbit && !is_stepped) status = open_output(orbit_file_name(rows), files_, messages_, orbit_file_);
  if (status == 0 && compiled_->analyses.transient) warn_of_size();
  const bool has_rows = compiled_->analyses.transient || has_orbit;
  if (status == 0 && !options_.plot.empty() && !has_rows && !compiled_->analyses.small_signal)
    status = fail(Status::wrong_input, "E-no-transient", "the deck has no .tran: there are no waveforms to draw; try without --plot");
  if (status == 0 && !options_.plot.empty() && has_rows) status = plot_file_.open(options_.plot, files_, messages_);
  if (status == 0 && !options_.plot.empty() && compiled_->analyses.small_signal)
    status = bode_file_.open(has_rows ? bode_file_name(options_.plot) : options_.plot, files_, messages_);
  if (status == 0 && !options_.report.empty()) status = open_output(options_.report, files_, messages_, report_file_);
  if (status == 0 && !options_.stats.empty()) status = open_output(options_.stats, files_, messages_, statistics_file_);
  return status;
}

/// A remark on signals that nobody named, measured or draws: with --verbose it is said.
bool Session::concerns_nobody(const engine::Remark& remark) const {
  if (remark.signals.empty() || options_.verbose || compiled_->names_signals || plot_file_.is_open() || report_file_) return false;
  const auto& probes = compiled_->measurements.probe_signals;
  return std::none_of(probes.begin(), probes.end(), [&](int probe) {
    const std::string& name = compiled_->network.signals[static_cast<std::size_t>(probe)].name;
    return std::find(remark.signals.begin(), remark.signals.end(), name) != remark.signals.end();
  });
}

void Session::take_remarks(const engine::Answer& answer) {
  for (const engine::Remark& remark : answer.remarks) {
    if (concerns_nobody(remark))
      messages_.keep(analysis::message_of(remark));
    else
      messages_.report(analysis::message_of(remark));
  }
  report_.statistics = answer.statistics;
  report_.jumps = answer.jumps;
  if (options_.events)
    for (const std::string& text : analysis::jump_texts(answer.jumps, answer.statistics.jumps, compiled_->hidden))
      messages_.report({Severity::note, "N-jump", {}, text});
  report_.certificate = answer.certificate;
  report_.seconds.simulate = answer.statistics.seconds_simulate;
  report_.seconds.certificate = answer.statistics.seconds_certificate;
}

int Session::sweep() {
  outcome_.sweep = analysis::SweptRuns(compiled_->analyses.sweeps, rows_file_ && (plot_file_.is_open() || report_file_));
  circuit::Compiled first = *compiled_;
  auto& measured = first.measurements.list;
  measured.insert(measured.end(), first.orbit_measurements.list.begin(), first.orbit_measurements.list.end());
  const SweepTask task{options_, deck_, sources_, first, reltol_, rows_file_ ? &*rows_file_ : nullptr};
  const int status = run_sweep(task, messages_, report_, outcome_.sweep);
  if (engine_.warning) messages_.report(*engine_.warning);
  report_.seconds.total = since(start_);
  if (!rows_file_) return status;
  double end = 0.0;
  for (const analysis::SweptRun& run : outcome_.sweep.list) end = std::max(end, run.end);
  note_rows(rows_file_->failed(), status == 0, end);
  if (status == 0) tell_details();
  return status;
}

int Session::operating_point() {
  const engine::OperatingPoint point = engine_.operating_point();
  take_remarks(point.answer);
  if (point.answer.outcome == engine::Outcome::interrupted) {
    fail(Status::run_failed, point.answer.id, point.answer.message);
    return status_of_signal(caught_signal());
  }
  if (point.answer.outcome != engine::Outcome::completed) return fail(Status::run_failed, point.answer.id, point.answer.message);
  outcome_.operating_point = point.values;
  outcome_.operating_point->resize(outcome_.signals.size());
  if (options_.json) return 0;
  const Stream stream = options_.output == "-" ? Stream::error : Stream::output;
  return print(analysis::operating_point_text(outcome_.signals, *outcome_.operating_point, digits_for(stream)), messages_, stream);
}

/// The orbit; then its rows, beside those of .tran where the deck has both.
int Session::steady_state() {
  if (engine_.name != "exact")
    return fail(Status::run_failed, "E-pss-engine", analysis::orbit_needs_exact_engine);
  outcome_.steady_state = analysis::find_steady_state(*compiled_, caught_signal());
  const analysis::SteadyState& state = *outcome_.steady_state;
  for (const Diagnostic& message : state.messages) messages_.report(message);
  int status = state.is_found || state.has_best_attempt ? orbit_rows(state) : 0;
  if (!state.is_found) {
    const int failed = fail(state.is_wrong_input ? Status::wrong_input : Status::run_failed, state.id, state.message);
    return caught_signal() != 0 ? status_of_signal(caught_signal()) : failed;
  }
  if (status == 0 && compiled_->analyses.transient) {
    Diagnostics diagnostics;
    engine_.simulate = analysis::from_orbit(*compiled_, state, diagnostics);
    messages_.report(diagnostics, sources_);
    if (!engine_.simulate) return static_cast<int>(Status::run_failed);
    if (options_.no_rows) engine_.simulate = analysis::without_rows(std::move(engine_.simulate));
  }
  return status;
}

int Session::orbit_rows(const analysis::SteadyState& state) {
  const bool is_alone = !compiled_->analyses.transient;
  OutputFile& file = is_alone ? *rows_file_ : *orbit_file_;
  analysis::RunControl control{options_.events, true, {}, &caught_signal()};
  control.longest_window = analysis::most_periods_measured * state.orbit.period;
  if (is_alone && (plot_file_.is_open() || report_file_))
    control.recorder = &recorder_.emplace(0.0, state.orbit.period, compiled_->recorded_signals());
  const auto writer = analysis::row_writer(options_.format, *compiled_, file);
  analysis::TransientRun run = analysis::run_transient(state.compiled, options_.no_rows ? analysis::without_rows(state.simulate) : state.simulate, file, *writer, control);
  if (is_alone) {
    take_remarks(run.answer);
    report_.statistics.rows = run.rows;
    note_rows(run.ending == Ending::write_failed, run.ending == Ending::completed, run.answer.time);
  }
  outcome_.measurements = std::move(run.measurements);
  const int measured = report_measurements(outcome_.measurements, run.ending == Ending::completed);
  report_.seconds.total = since(start_);
  if (run.ending != Ending::completed) return std::max(conclude(run, file), measured);
  if (state.is_found) messages_.remark(analysis::orbit_summary(state, options_.no_rows ? "nothing" : file.name()));
  if (is_alone) tell_details();
  return measured;
}

int Session::transient() {
  const double stop = compiled_->analyses.transient->stop.seconds;
  analysis::TransientRun run;
  {
    Progress progress(options_.progress, stop);
    analysis::RunControl control{
        options_.events, options_.events || options_.json || report_file_ || !options_.stats.empty(), {}, &caught_signal()};
    if (progress.shown()) control.progress = [&progress](double time) { progress.reached(time); };
    if (plot_file_.is_open() || report_file_)
      control.recorder = &recorder_.emplace(compiled_->analyses.transient->start.seconds, stop, compiled_->recorded_signals());
    const auto writer = analysis::row_writer(options_.format, *compiled_, *rows_file_);
    if (options_.check) kept_rows_.emplace(*writer, 1 + compiled_->saved_signals());
    run = analysis::run_transient(*compiled_, engine_.simulate, *rows_file_, kept_rows_ ? *kept_rows_ : *writer, control);
  }
  if (engine_.warning) messages_.report(*engine_.warning);
  take_remarks(run.answer);
  report_.statistics.rows = run.rows;
  report_.seconds.write = run.seconds_write;
  report_.seconds.total = since(start_);
  note_rows(run.ending == Ending::write_failed, run.ending == Ending::completed, run.answer.time);
  measure::Results own = std::move(run.measurements);
  const bool is_complete = run.ending == Ending::completed;
  const int measured = is_complete ? 0 : report_measurements(own, false);
  const int status = conclude(run, *rows_file_);  // an error comes last
  const int measured_whole = is_complete ? report_measurements(own, true) : 0;
  outcome_.measurements.add(std::move(own));
  return std::max({status, measured, measured_whole, kept_rows_ && run.ending == Ending::completed ? check() : 0});
}

/// Of what has been measured.
int Session::sensitivities() {
  const Stream stream = options_.output == "-" ? Stream::error : Stream::output;
  return run_sensitivities(*compiled_, engine_.name == "exact", {!options_.json, stream, digits_for(stream), sensitivity_file_ ? &*sensitivity_file_ : nullptr},
                           outcome_, messages_);
}

/// The rows of a complete run beside the other engine.
int Session::check() {
  outcome_.check = analysis::check_run(*compiled_, *kept_rows_, {engine_.name, reltol_, check_seconds, &caught_signal()});
  const analysis::Check& check = *outcome_.check;
  if (caught_signal() != 0) {
    fail(Status::run_failed, "E-interrupted", "interrupted during the check; the rows are complete");
    return status_of_signal(caught_signal());
  }
  const auto stream = options_.output == "-" ? Stream::error : Stream::output;
  const int printed = options_.json ? 0 : print(analysis::check_text(check), messages_, stream);
  if (check.agreement == analysis::Agreement::differs) return fail(Status::run_failed, "E-check-differs", check.reason);
  if (check.agreement == analysis::Agreement::undecided)
    messages_.report({Severity::warning, "W-check-undecided", {}, "the check came to no verdict: " + check.reason});
  return printed;
}

/// Of a run that ended early the first stands for all.
void Session::report_failures(const measure::Results& results, bool is_complete) {
  std::vector<const measure::Result*> failed;
  for (const measure::Result& result : results.list)
    if (!result.failure.empty()) failed.push_back(&result);
  if (failed.empty()) return;
  const std::size_t others = is_complete ? 0 : failed.size() - 1;
  failed.resize(failed.size() - others);
  for (const measure::Result* result : failed) {
    Diagnostic warning = measure::failure_warning(*result);
    if (others > 0) warning.text += fmt::format(" (and so did {})", analysis::counted(others, "other measurement"));
    messages_.report(warning, sources_);
  }
}

/// Measurements that failed do not make the run one that failed.
int Session::report_measurements(const measure::Results& results, bool is_complete) {
  if (results.empty()) return 0;
  report_failures(results, is_complete);
  for (const measure::Result& result : results.list)
    if (!result.left_out.empty()) messages_.report(measure::left_out_warning(result), sources_);
  for (const measure::FourierResult& result : results.fourier)
    if (!result.failure.empty())
      messages_.report(
          {Severity::warning, "W-measurement-failed", {}, fmt::format("Fourier analysis of {} failed: {}", result.column, result.failure)},
          sources_);
  for (const Diagnostic& warning : analysis::efficiency_warnings(*compiled_, results)) messages_.report(warning, sources_);
  if (options_.json) return 0;
  const Stream stream = options_.output == "-" ? Stream::error : Stream::output;
  return print(measure::results_text(results, digits_for(stream)), messages_, stream);
}

void Session::note_rows(bool write_failed, bool complete, double end) {
  if (options_.no_rows) return;
  const bool lost = write_failed && !rows_file_->partial_name().empty();
  outcome_.rows = {lost ? rows_file_->partial_name() : rows_file_->name(), options_.format == analysis::RowFormat::raw ? "raw" : "csv",
                   complete, end};
}

/// What stands behind the summary.
void Session::tell_details() {
  if (options_.verbose) messages_.remark(analysis::details(report_));
  messages_.remark(options_.verbose ? analysis::departures_table(messages_.departures())
                                    : analysis::departures_line(messages_.departures()));
}

int Session::conclude(const analysis::TransientRun& run, const OutputFile& file) {
  const std::string kept =
      options_.no_rows ? run.message : fmt::format("{}; the rows up to then are in {}", run.message, file.name());
  switch (run.ending) {
    case Ending::completed:
      messages_.remark(analysis::summary(report_, options_.no_rows ? "nothing" : file.name(), run.answer.time));
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

void Session::take_messages() {
  report_.notes = messages_.heads();
  report_.departures = messages_.departures();
}

int Session::written(int status, const std::string& name, std::string& noted) {
  if (status != 0) return status;
  noted = name;
  messages_.remark(fmt::format("wrote {}\n", name));
  return 0;
}

int Session::write_pictures() {
  int status = 0;
  if (plot_file_.is_open()) {
    const std::string svg =
        waveform::svg(outcome_.sweep.list.empty() ? analysis::run_figure(outcome_.title, outcome_.signals, *recorder_)
                                                  : analysis::sweep_figure(outcome_.title, outcome_.signals, outcome_.sweep));
    status = written(plot_file_.write(svg, messages_), plot_file_.name(), outcome_.plot);
  }
  if (bode_file_.is_open() && outcome_.small_signal) {
    std::string name;
    const std::string svg = waveform::svg(analysis::bode_figure(outcome_.title, *outcome_.small_signal));
    status = std::max(status, written(bode_file_.write(svg, messages_), bode_file_.name(), outcome_.plot.empty() ? outcome_.plot : name));
  }
  if (!report_file_) return status;
  take_messages();
  report_.seconds.total = since(start_);
  const std::string page = analysis::html_report(outcome_, report_, recorder_ ? &*recorder_ : nullptr);
  return std::max(status, written(write_whole(*report_file_, page, messages_), report_file_->name(), outcome_.report));
}

int Session::write_statistics() {
  take_messages();
  if (!statistics_file_) return 0;
  return write_whole(*statistics_file_, analysis::statistics_json(report_), messages_);
}

int Session::print_json() {
  take_messages();
  return print(analysis::run_json(outcome_, report_), messages_);
}

}  // namespace

int run_session(const RunOptions& options) {
  Session session(options);
  const int status = session.run();
  if (analysis::any_abandoned()) std::_Exit(status);  // large decks take long to destroy, too
  return status;
}

}  // namespace pwlsim::cli
