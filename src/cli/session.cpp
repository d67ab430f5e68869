#include "cli/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "analysis/abandonable.hpp"
#include "analysis/fitted_diodes.hpp"
#include "analysis/gate_run.hpp"
#include "analysis/html_report.hpp"
#include "analysis/report.hpp"
#include "analysis/row_grid.hpp"
#include "analysis/run_figure.hpp"
#include "analysis/steady_state.hpp"
#include "cli/analysis_session.hpp"
#include "cli/deck_reader.hpp"
#include "cli/heap.hpp"
#include "cli/schematic_json.hpp"
#include "cli/signals.hpp"
#include "cli/split_files.hpp"
#include "cli/sweep_session.hpp"
#include "netlist/load.hpp"
#include "waveform/png.hpp"

namespace pwlsim::cli {
namespace {

class Session {
 public:
  explicit Session(const RunOptions& options) : run_(options) {}

  int run() {
    run_.outcome.deck = run_.options.deck;
    run_.outcome.status = run_analyses();
    run_.report.seconds.total = run_.seconds();
    run_.outcome.status = std::max(run_.outcome.status, write_statistics());
    return run_.options.json ? std::max(run_.outcome.status, print_json()) : run_.outcome.status;
  }

 private:
  int run_analyses() {
    int status = prepare();
    if (status == 0) status = open_files();
    if (status != 0) return status;
    if (run_.is_stepped()) status = sweep();
    for (const auto& analysis : analyses_)
      if (!run_.is_stepped() && (status == 0 || !analysis->needs_those_before())) status = std::max(status, analysis->run(run_));
    run_.outcome.status = status;
    const bool rows_are_lost = status == static_cast<int>(Status::file_error) || status == static_cast<int>(Status::closed_pipe);
    return rows_are_lost ? status : std::max(status, write_pictures());
  }

  /// 0, or the status of a signal that came while nothing had been written yet.
  int interrupted_before_run() {
    return caught_signal() != 0 ? fail_by_signal(run_.messages, "interrupted before the run began; nothing was written") : 0;
  }

  int prepare();
  [[nodiscard]] bool is_orbit_alone() const;
  [[nodiscard]] bool may_repeat_with_gates() const;
  [[nodiscard]] std::optional<circuit::Compiled> compiled_with_gates() const;
  int open_files();
  int check_split();
  void warn_of_size();
  int check_can_be_made();
  int check_one_table();
  int sweep();
  int write_pictures();
  void take_messages();
  int write_statistics();
  int print_json();

  RunContext run_;
  netlist::Deck deck_;
  circuit::DrawnNames drawn_;                               ///< names that a picture shows
  std::vector<std::unique_ptr<AnalysisSession>> analyses_;  ///< those that the deck asks for
  std::optional<waveform::OutputFile> statistics_file_;
};

int Session::prepare() {
  DeckReading reading = read_deck(run_.options.deck, {.measure = true}, run_.sources, run_.messages, !run_.options.report.empty());
  run_.report.seconds.parse = reading.seconds_parse;
  run_.report.seconds.flatten = reading.seconds_flatten;
  run_.outcome.title = reading.deck.title;
  if (!reading.compiled) return static_cast<int>(reading.status);
  run_.compiled = std::move(reading.compiled);
  deck_ = std::move(reading.deck);
  drawn_ = std::move(reading.drawn);
  run_.files = std::move(reading.files);
  run_.outcome.schematic = schematic_json(reading.drawing, reading.places);
  const std::vector<std::string> names = analysis::column_names(*run_.compiled);
  run_.outcome.signals.assign(names.begin() + 1, names.end());
  for (std::size_t k = run_.compiled->saved_signals(); k < run_.compiled->recorded_signals(); ++k)
    run_.outcome.drawn_signals.push_back(run_.compiled->network.signals[k].name);
  if (const int signalled = interrupted_before_run(); signalled != 0) return signalled;
  Diagnostics diagnostics;
  const double model_start = run_.seconds();
  run_.reltol = analysis::relative_tolerance(run_.options.reltol, run_.analyses());
  if (!run_.is_stepped()) {
    share_heap();
    run_.messages.report(analysis::fit_diodes(*run_.compiled, run_.options.engine, run_.reltol, &caught_signal()), run_.sources);
  }
  analyses_ = analysis_sessions(run_.analyses());
  if (is_orbit_alone()) {
    run_.engine = analysis::exact_engine_when_needed(run_.compiled->network);
    run_.orbit_search = analysis::prepare_orbit(*run_.compiled, run_.options.engine, caught_signal(), diagnostics);
  } else {
    run_.engine = analysis::prepare_engine(run_.compiled->network, run_.options.engine, run_.reltol, diagnostics, caught_signal());
  }
  run_.report.engine = run_.engine.name;
  run_.report.seconds.model = run_.seconds() - model_start;
  run_.messages.report(diagnostics, run_.sources);
  if (const int signalled = interrupted_before_run(); signalled != 0) return signalled;
  if (!run_.engine.simulate || diagnostics.has_errors()) return static_cast<int>(Status::wrong_input);
  if (may_repeat_with_gates())
    run_.engine.simulate = analysis::with_gates_at_need(
        std::move(run_.engine.simulate), *run_.compiled, [this] { return compiled_with_gates(); }, run_.options.engine, run_.reltol,
        &caught_signal());
  if (run_.options.no_rows) run_.engine.simulate = analysis::without_rows(std::move(run_.engine.simulate));
  return 0;
}

/// The orbit has a model of its own: that of a run is not needed.
bool Session::is_orbit_alone() const {
  const circuit::Analyses& deck = run_.analyses();
  const model::Network& network = run_.compiled->network;
  return deck.steady_state && !deck.transient && !deck.operating_point && !run_.is_stepped() && analysis::is_quick(network) &&
         analysis::has_modes(network, run_.options.engine);
}

/// A run alone, of transistors with gates: what other analyses take from it would not be of its network. Others pass their rows on at once.
bool Session::may_repeat_with_gates() const {
  const circuit::Analyses& deck = run_.analyses();
  return run_.compiled->has_mosfets && deck.transient && !deck.steady_state && !deck.small_signal && !deck.sensitivities &&
         !run_.is_stepped() && !run_.options.check;
}

std::optional<circuit::Compiled> Session::compiled_with_gates() const {
  SourceStore sources = run_.sources;
  Diagnostics ignored;
  netlist::Deck deck = deck_;
  netlist::Deck option = netlist::parse("options", "\n.options gatecap\n", sources, ignored);
  std::move(option.cards.begin(), option.cards.end(), std::back_inserter(deck.cards));
  return circuit::compile(deck, sources, ignored, {.measure = true, .drawn = drawn_});
}

int Session::check_split() {
  const std::size_t runs = run_.analyses().sweeps.runs();
  if (runs == 0) return run_.fail(Status::wrong_input, "E-no-step", "the deck has no .step: there is only one run; try without --split");
  if (!run_.analyses().transient)
    return run_.fail(Status::wrong_input, "E-no-transient", "the deck has no .tran: there are no rows to split; try without --split");
  for (std::size_t run = 0; run < runs; ++run)
    if (const int status = check_output(split_file(run_.options.output, run), run_.files, run_.messages); status != 0) return status;
  return 0;
}

/// --check compares the waveforms of one run.
int Session::check_can_be_made() {
  if (!run_.analyses().transient)
    return run_.fail(Status::wrong_input, "E-no-transient", "the deck has no .tran: there are no waveforms to check; try without --check");
  if (run_.is_stepped())
    return run_.fail(Status::wrong_input, "E-check-sweep",
                     "--check compares one run, and the deck has .step; try a deck with one of its runs");
  return 0;
}

/// Before gigabytes are written. Pipes and devices take what they are given.
void Session::warn_of_size() {
  constexpr double large = 1e9, text_bytes = 19.0;  // of a number of 16 digits with what stands around it, on average
  if (takes_one_table(run_.options.output)) return;
  const auto runs = static_cast<double>(std::max<std::size_t>(1, run_.analyses().sweeps.runs()));
  const auto rows = static_cast<double>(analysis::row_grid(*run_.analyses().transient).rows);
  const auto columns = static_cast<double>(1 + run_.compiled->saved_signals() + run_.analyses().sweeps.list.size());
  const double bytes = runs * rows * columns * (run_.options.format == analysis::RowFormat::raw ? sizeof(double) : text_bytes);
  if (bytes > large)
    run_.messages.report(
        {Severity::warning,
         "W-large-output",
         {},
         fmt::format(
             "about {:.2g} GB of rows go to {} ({:.3g} rows of {} columns); try a larger Tstep, .save of fewer signals, or --no-rows",
             1e-9 * bytes, run_.options.output, runs * rows, columns)});
}

/// Standard output, a pipe or a device takes the rows of one analysis.
int Session::check_one_table() {
  const bool goes_to_pipe = takes_one_table(run_.options.output) && !run_.options.no_rows;
  const circuit::Analyses& deck = run_.analyses();
  // Of a sweep the orbits beside runs have no rows there.
  const bool has_another = (deck.transient && !run_.is_stepped()) || (deck.small_signal && !deck.transient);
  if (!goes_to_pipe || !deck.steady_state || !has_another) return 0;
  return run_.fail(Status::wrong_input, "E-option-conflict",
                   fmt::format("each analysis of the deck has its own rows, and {} takes one table; try -o with a file name",
                               table_name(run_.options.output)));
}

int Session::open_files() {
  const RunOptions& options = run_.options;
  const bool has_run = run_.analyses().transient.has_value(), has_rows = has_run || run_.analyses().steady_state;
  int status = options.split ? check_split() : 0;
  if (status == 0 && options.check) status = check_can_be_made();
  if (status == 0 && has_rows) status = run_.open(run_.rows_name(), run_.rows_file);
  if (status == 0) status = check_one_table();
  if (status == 0 && has_run) warn_of_size();
  if (status == 0 && !options.plot.empty() && !has_rows && !run_.analyses().small_signal)
    status = run_.fail(Status::wrong_input, "E-no-transient", "the deck has no .tran: there are no waveforms to draw; try without --plot");
  if (status == 0 && !options.plot.empty() && has_rows) status = run_.plot_file.open(options.plot, run_.files, run_.messages);
  for (const auto& analysis : analyses_)
    if (status == 0) status = analysis->open_files(run_);
  if (status == 0 && !options.report.empty()) status = run_.open(options.report, run_.report_file);
  if (status == 0 && !options.stats.empty()) status = run_.open(options.stats, statistics_file_);
  return status;
}

int Session::sweep() {
  run_.outcome.sweep = analysis::SweptRuns(run_.analyses().sweeps, run_.rows_file && run_.has_pictures());
  circuit::Compiled first = *run_.compiled;
  auto& measured = first.measurements.list;
  measured.insert(measured.end(), first.orbit_measurements.list.begin(), first.orbit_measurements.list.end());
  const SweepTask task{run_.options,    deck_, run_.sources, first, run_.reltol, run_.rows_file ? &*run_.rows_file : nullptr,
                       run_.sweep_files};
  const int status = run_sweep(task, run_.messages, run_.report, run_.outcome.sweep);
  if (run_.engine.warning) run_.messages.report(*run_.engine.warning);
  run_.report.seconds.total = run_.seconds();
  if (!run_.rows_file) return status;
  double end = 0.0;
  for (const analysis::SweptRun& run : run_.outcome.sweep.list) end = std::max(end, run.end);
  run_.note_rows(run_.rows_file->failed(), status == 0, end);
  if (status == 0) run_.tell_details();
  return status;
}

void Session::take_messages() {
  run_.report.notes = run_.messages.heads();
  run_.report.departures = run_.messages.departures();
}

int Session::write_pictures() {
  analysis::RunOutcome& outcome = run_.outcome;
  int status = 0;
  const bool has_run = run_.recorder || !outcome.sweep.list.empty();  // not where an analysis before it failed
  if (run_.plot_file.is_open() && has_run) {
    const std::string svg =
        waveform::svg(outcome.sweep.list.empty() ? analysis::run_figure(outcome.title, outcome.signals, *run_.recorder)
                                                 : analysis::sweep_figure(outcome.title, outcome.signals, outcome.sweep));
    status = write_picture(run_.plot_file, svg, run_, outcome.plot);
  }
  for (const auto& analysis : analyses_) status = std::max(status, analysis->write_pictures(run_));
  if (!run_.report_file) return status;
  take_messages();
  run_.report.seconds.total = run_.seconds();
  const std::string page = analysis::html_report(outcome, run_.report, run_.recorder ? &*run_.recorder : nullptr);
  const int written = write_whole(*run_.report_file, page, run_.messages);
  if (written != 0) return std::max(status, written);
  outcome.report = run_.report_file->name();
  run_.messages.remark(fmt::format("wrote {}\n", outcome.report));
  return status;
}

int Session::write_statistics() {
  take_messages();
  if (!statistics_file_) return 0;
  return write_whole(*statistics_file_, analysis::statistics_json(run_.report), run_.messages);
}

int Session::print_json() {
  take_messages();
  return print(analysis::run_json(run_.outcome, run_.report), run_.messages);
}

}  // namespace

int run_session(const RunOptions& options) {
  Session session(options);
  const int status = session.run();
  if (analysis::any_abandoned()) std::_Exit(status);  // large decks take long to destroy, too
  return status;
}

}  // namespace pwlsim::cli
