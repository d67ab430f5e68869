#include "cli/sweep_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "analysis/fitted_diodes.hpp"
#include "analysis/ordered_rows.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/quantity.hpp"
#include "analysis/small_signal_columns.hpp"
#include "analysis/small_signal_report.hpp"
#include "analysis/stepped_sources.hpp"
#include "analysis/transient.hpp"
#include "cli/output.hpp"
#include "cli/progress.hpp"
#include "cli/sensitivity_session.hpp"
#include "cli/signals.hpp"
#include "cli/small_signal_session.hpp"
#include "cli/split_files.hpp"
#include "cli/status.hpp"
#include "waveform/raw_file.hpp"

namespace pwlsim::cli {
namespace {

using analysis::SweptRun;

constexpr std::size_t runs_ahead = 4;  ///< of each thread, of the first run that is not finished
constexpr auto between_looks = std::chrono::milliseconds(50);
constexpr std::size_t most_failures_told = 20;
constexpr const char* cannot_write = "E-cannot-write";

class Sweep {
 public:
  Sweep(const SweepTask& task, Messages& messages, analysis::RunReport& report, analysis::SweptRuns& runs)
      : task_(task),
        messages_(messages),
        report_(report),
        runs_(runs),
        records_(runs.list),
        sweeps_(runs.sweeps),
        threads_(
            std::clamp<std::size_t>(task.options.jobs != 0 ? task.options.jobs : std::thread::hardware_concurrency(), 1, records_.size())),
        columns_(analysis::column_names(task.first)) {}

  int run() {
    if (task_.rows != nullptr && !task_.options.split) begin_rows(*task_.rows);
    orbits_.begin(task_.beside.orbit, sweeps_, columns_, runs_ahead * threads_);
    if (task_.beside.response)
      responses_.begin(task_.beside.response, sweeps_, analysis::small_signal_columns(task_.first), runs_ahead * threads_);
    derivatives_.begin(task_.beside.derivatives, sweeps_, analysis::derivative_columns(), runs_ahead * threads_);
    look_for_sources();
    {
      Progress progress(task_.options.progress, static_cast<double>(records_.size()));
      run_all(progress);
    }
    runs_.sum_up(report_);
    tell_remarks();
    int status = std::max(tell_failures(), task_.rows != nullptr ? complete(*task_.rows) : 0);
    for (std::optional<waveform::OutputFile>* file : {&task_.beside.orbit, &task_.beside.response, &task_.beside.derivatives})
      if (*file) status = std::max(status, complete_beside(**file));
    tell_measurements(&measure::Result::failure, measure::failure_warning);
    tell_measurements(&measure::Result::left_out, measure::left_out_warning);
    for (std::size_t run = 0; run < records_.size(); ++run)
      if (!records_[run].sensitivities.empty())
        report_derivatives(records_[run].sensitivities, messages_, fmt::format(" in the run with {}", name(run)));
    for (std::size_t run = 0; run < records_.size(); ++run) {
      if (!records_[run].impulsive.empty())
        messages_.report(impulsive_response_warning(records_[run].impulsive, fmt::format(" in the run with {}", name(run))));
      for (const double f : records_[run].singular)
        messages_.report(singular_response_warning(f, fmt::format(" in the run with {}", name(run))));
    }
    return task_.options.json ? status : std::max(status, print_tables());
  }

 private:
  /// A table beside the rows: lines of all runs, in their order.
  class Beside {
   public:
    void begin(std::optional<waveform::OutputFile>& file, const circuit::Sweeps& sweeps, const std::vector<std::string>& columns,
               std::size_t ahead) {
      if (!file) return;
      file->write(analysis::sweep_head(sweeps, columns));
      rows_.emplace(*file, ahead, 0);
    }
    [[nodiscard]] bool is_wanted() const { return rows_.has_value(); }
    void wait_to_begin(std::size_t run) {
      if (rows_) rows_->wait_to_begin(run);
    }
    void finish(std::size_t run, std::string text) {
      if (rows_) (void)rows_->finish(run, std::move(text));
    }

   private:
    std::optional<analysis::OrderedRows> rows_;
  };

  /// Of one run, for these tables.
  struct Texts {
    std::string orbit, response, derivatives;
  };

  [[nodiscard]] bool is_raw() const { return task_.options.format == analysis::RowFormat::raw; }
  [[nodiscard]] std::string name(std::size_t run) const { return runs_.name(run); }

  void begin_rows(waveform::OutputFile& file) {
    rows_.emplace(file, runs_ahead * threads_, is_raw() ? (columns_.size() + sweeps_.list.size()) * sizeof(double) : 0);
    if (is_raw()) {
      std::vector<waveform::RawVector> vectors = analysis::raw_vectors(task_.first);
      for (const circuit::Sweep& sweep : sweeps_.list) vectors.push_back({sweep.name, "notype"});
      raw_.emplace(file, task_.first.title, vectors, true);
    } else {
      file.write(analysis::sweep_head(sweeps_, columns_));
    }
  }

  [[nodiscard]] analysis::RowFormatter format_of(std::size_t run) const {
    return is_raw() ? analysis::stepped_doubles(sweeps_.point(run)) : analysis::stepped_csv(sweeps_.point(run));
  }

  void run_all(Progress& progress) {
    std::vector<std::thread> threads;
    try {
      for (std::size_t k = 0; k < threads_; ++k) threads.emplace_back([this] { work(); });
    } catch (const std::system_error&) {  // no more threads are to be had: the run goes on with those there are
      if (threads.empty()) work();
    }
    for (std::unique_lock lock(mutex_); finished_ < records_.size();) {
      one_finished_.wait_for(lock, between_looks);
      progress.finished(static_cast<double>(finished_));
    }
    for (std::thread& thread : threads) thread.join();
  }

  void work() {
    for (std::size_t run = begun_++; run < records_.size(); run = begun_++) {
      if (rows_) rows_->wait_to_begin(run);
      for (Beside* table : {&orbits_, &responses_, &derivatives_}) table->wait_to_begin(run);
      one_run(run);
      const std::scoped_lock lock(mutex_);
      ++finished_;
      one_finished_.notify_one();
    }
  }

  void one_run(std::size_t run) {
    SweptRun& record = records_[run];
    bool has_rows = false;
    Texts texts;
    try {
      if (caught_signal() != 0 || writing_failed_ || (rows_ && rows_->failed()))
        record.interrupted = true;
      else
        has_rows = simulate(run, record, texts);
    } catch (...) {  // want of memory, or a defect of the program: the other runs go on
      record.id = "E-internal";
      record.message = "the run met a state it should never reach, or no memory is left";
    }
    if (!has_rows && rows_) (void)rows_->finish(run, "");
    orbits_.finish(run, std::move(texts.orbit));
    responses_.finish(run, std::move(texts.response));
    derivatives_.finish(run, std::move(texts.derivatives));
  }

  /// Where constant sources are stepped and there is nothing but a .tran, the model is the same in all runs. Not for files of their own, which have the
  /// bits of a deck with these values.
  void look_for_sources() {
    const circuit::Analyses& analyses = task_.first.analyses;
    const bool has_others = analyses.steady_state || analyses.operating_point || analyses.sensitivities || analyses.small_signal;
    if (task_.options.split || !analyses.transient || has_others) return;
    std::vector<std::string> names;
    for (const circuit::Sweep& sweep : sweeps_.list) {
      if (!sweep.is_source()) return;
      names.push_back(sweep.name);
    }
    Diagnostics diagnostics;
    SourceStore sources = task_.sources;
    auto compiled = circuit::compile(task_.deck, sources, diagnostics, {.measure = true, .held = names});
    if (!compiled || diagnostics.has_errors()) return;
    sources_ = analysis::SteppedSources::make(std::move(*compiled), names.size(), task_.options.engine);
  }

  bool simulate_sources(std::size_t run, SweptRun& record) {
    analysis::Simulate simulate = sources_->simulate(sweeps_.point(run));
    if (task_.options.no_rows) simulate = analysis::without_rows(std::move(simulate));
    return run_transient(run, *sources_->compiled(), simulate, record);
  }

  /// False where the rows went elsewhere than into the one file.
  bool run_transient(std::size_t run, const circuit::Compiled& compiled, const analysis::Simulate& simulate, SweptRun& record) {
    if (task_.options.split) {
      write_file(run, compiled, simulate, record);
    } else {
      analysis::SteppedRows writer(*rows_, run, columns_.size(), format_of(run));
      take_transient(analysis::run_rows(compiled, simulate, writer, control_of(run, compiled)), record);
    }
    return !task_.options.split;
  }

  /// False where the run did not come to rows of the one file.
  bool simulate(std::size_t run, SweptRun& record, Texts& texts) {
    if (sources_) return simulate_sources(run, record);
    Diagnostics diagnostics;
    SourceStore sources = task_.sources;  // shipped subcircuits are added
    auto compiled = circuit::compile(task_.deck, sources, diagnostics, {.measure = true, .run = run});
    analysis::PreparedEngine engine;
    if (compiled) (void)analysis::fit_diodes(*compiled, task_.options.engine, task_.reltol, &caught_signal());
    if (compiled) engine = analysis::prepare_engine(compiled->network, task_.options.engine, task_.reltol, diagnostics, caught_signal());
    if (!engine.simulate || diagnostics.has_errors()) {
      if (compiled && caught_signal() != 0)
        record.interrupted = true;
      else
        note_error(diagnostics, record);
      return false;
    }
    const bool runs_on = compiled->analyses.transient.has_value(), has_modes = engine.has_modes;
    const std::string prefix = analysis::sweep_prefix(sweeps_, run);
    std::optional<circuit::Compiled> deck;
    if (compiled->analyses.sensitivities) deck = compiled;
    if (compiled->analyses.steady_state && !take_orbit(*compiled, engine, record)) return false;
    if (task_.options.no_rows) engine.simulate = analysis::without_rows(std::move(engine.simulate));
    if (compiled->analyses.operating_point) take_operating_point(engine.operating_point(), record);
    const bool responds = task_.first.analyses.small_signal.has_value();
    if (responds) take_response(*compiled, prefix, record, texts);
    if (!compiled->analyses.transient) {
      record.done = record.id.empty() && !record.interrupted && (record.done || responds);
      return false;
    }
    const bool has_rows = run_transient(run, *compiled, engine.simulate, record);
    if (deck && record.done) {
      const analysis::MeasuredBefore measured =
          runs_on ? analysis::MeasuredBefore{&record.measured, nullptr} : analysis::MeasuredBefore{nullptr, &record.measured};
      record.sensitivities = analysis::deck_derivatives(*deck, record.orbit.get(), has_modes, caught_signal(), measured);
      texts.derivatives = analysis::derivative_rows(record.sensitivities, prefix);
      record.interrupted |= analysis::are_interrupted(record.sensitivities);
      record.done &= !record.interrupted;
    }
    record.measured = {};
    if (record.orbit) finish_orbit(runs_on, prefix, record, texts);
    return has_rows;
  }

  /// Small signals around the orbit, or of a linear circuit.
  void take_response(const circuit::Compiled& compiled, const std::string& prefix, SweptRun& record, Texts& texts) const {
    analysis::DeckResponse response = analysis::deck_response(compiled, record.orbit.get(), &caught_signal());
    if (record.id.empty()) {
      record.id = response.id;
      record.message = response.message;
    }
    if (!response.result) return;
    record.interrupted |= response.result->frequencies.size() < compiled.analyses.small_signal->frequencies.size();
    texts.response = analysis::small_signal_rows(*response.result, prefix);
    record.singular = response.result->singular;
    record.impulsive = response.result->impulsive;
    if (task_.options.json || !task_.options.plot.empty()) record.small_signal = std::move(response.result);
  }

  /// The run is one period of the orbit, or starts on it where the deck has .tran, too. False where there is none.
  bool take_orbit(circuit::Compiled& compiled, analysis::PreparedEngine& engine, SweptRun& record) const {
    if (!analysis::has_orbit_engine(compiled, task_.options.engine)) {
      record.id = "E-pss-engine";
      record.message = analysis::orbit_needs_exact_engine;
      return false;
    }
    const auto state =
        std::make_shared<analysis::SteadyState>(analysis::find_steady_state(compiled, task_.options.engine, caught_signal()));
    if (!state->is_found) {
      record.id = state->id;
      record.message = state->message;
      return false;
    }
    record.orbit = state;
    if (compiled.analyses.transient) {
      Diagnostics diagnostics;
      engine.simulate = analysis::from_orbit(compiled, *state, diagnostics);
      if (!engine.simulate) {
        note_error(diagnostics, record);
        return false;
      }
    } else {
      compiled = state->compiled;
      engine.simulate = state->simulate;
    }
    return true;
  }

  /// Remarks, measurements and rows of the orbit itself; what only its run needs goes.
  void finish_orbit(bool runs_on, const std::string& prefix, SweptRun& record, Texts& texts) const {
    analysis::SteadyState& state = *record.orbit;
    for (const Diagnostic& message : state.messages) record.remarks.push_back({message.id, message.text});
    if (runs_on)
      record.measurements.add(
          analysis::orbit_rows(state, prefix, orbits_.is_wanted() ? &texts.orbit : nullptr, task_.options.events, caught_signal()));
    state.orbit.trace = {};
    state.apart.reset();
    state.compiled = {};
    state.simulate = nullptr;
  }

  /// What a run by itself writes. After a failure to write no further run begins.
  void write_file(std::size_t run, const circuit::Compiled& compiled, const analysis::Simulate& simulate, SweptRun& record) {
    const std::string name = split_file(task_.options.output, run);
    std::string problem;
    auto file = waveform::OutputFile::open(name, problem);
    if (!file) return note_unwritten(fmt::format("{}: {}", name, problem), record);
    const auto writer = analysis::row_writer(task_.options.format, compiled, *file);
    const analysis::TransientRun rows = analysis::run_transient(compiled, simulate, *file, *writer, control_of(run, compiled));
    take_transient(rows, record);
    if (rows.ending == analysis::Ending::write_failed || rows.ending == analysis::Ending::closed_pipe)
      note_unwritten(rows.message, record);
    else
      record.file = name;
  }

  void note_unwritten(std::string why, SweptRun& record) {
    record.done = false;
    record.id = cannot_write;
    record.message = std::move(why);
    writing_failed_ = true;
  }

  analysis::RunControl control_of(std::size_t run, const circuit::Compiled& compiled) {
    analysis::RunControl control{task_.options.events, false, {}, &caught_signal()};
    const circuit::TransientAnalysis& transient = *compiled.analyses.transient;
    if (auto* const recorder = runs_.recorder_of(run); recorder != nullptr)
      control.recorder = &recorder->emplace(transient.start.seconds, transient.stop.seconds, compiled.saved_signals(), runs_.drawn.size());
    return control;
  }

  static void note_error(const Diagnostics& diagnostics, SweptRun& record) {
    for (const Diagnostic& diagnostic : diagnostics.all()) {
      if (diagnostic.severity != Severity::error) continue;
      record.id = diagnostic.id;
      record.message = diagnostic.text;
      return;
    }
  }

  /// The first remark of each kind, with how many runs have one.
  void tell_remarks() {
    std::map<std::string, std::pair<std::size_t, std::size_t>> first_and_count;
    for (std::size_t run = 0; run < records_.size(); ++run) {
      std::string last;
      for (const engine::Remark& remark : records_[run].remarks) {
        if (remark.id == last) continue;
        last = remark.id;
        ++first_and_count.try_emplace(remark.id, run, 0).first->second.second;
      }
    }
    for (const auto& [id, place] : first_and_count) {
      const auto& remarks = records_[place.first].remarks;
      const auto remark =
          std::find_if(remarks.begin(), remarks.end(), [&wanted = id](const engine::Remark& other) { return other.id == wanted; });
      const std::string others =
          place.second > 1 ? fmt::format(" (and likewise in {})", analysis::counted(place.second - 1, "other run")) : "";
      messages_.report(analysis::message_of({id, fmt::format("run with {}: {}{}", name(place.first), remark->text, others)}));
    }
  }

  int tell_failures() {
    std::size_t failures = 0, told = 0;
    for (std::size_t run = 0; run < records_.size(); ++run) {
      const SweptRun& record = records_[run];
      if (record.done || record.interrupted || record.id.empty()) continue;
      ++failures;
      if (told >= most_failures_told && record.id != cannot_write) continue;
      ++told;
      (void)fail(messages_, Status::run_failed, record.id, fmt::format("run with {}: {}", name(run), record.message));
    }
    if (failures > told) messages_.report({Severity::note, "N-more-failures", {}, fmt::format("{} more runs failed", failures - told)});
    if (caught_signal() != 0) {
      const auto done = std::count_if(records_.begin(), records_.end(), [](const SweptRun& record) { return record.done; });
      return fail_by_signal(messages_, fmt::format("stopped by a signal after {} of {} runs{}", done, records_.size(),
                                                   task_.rows == nullptr || task_.options.no_rows
                                                       ? ""
                                                       : (task_.options.split ? "; their files are listed in " : "; their rows are in ") +
                                                             task_.rows->name()));
    }
    return static_cast<int>(writing_failed_ ? Status::file_error : failures > 0 ? Status::run_failed : Status::done);
  }

  void say_written(const std::string& what) {
    const auto done = report_.runs - report_.failed_runs;
    messages_.remark(fmt::format("wrote {}: {} runs{}, {} rows, {} events\n", what, done,
                                 report_.failed_runs > 0 ? fmt::format(" of {}", report_.runs) : "", report_.statistics.rows,
                                 report_.statistics.events));
  }

  /// A table that every run has its lines in.
  int complete_beside(waveform::OutputFile& file) {
    if (file.commit()) {
      messages_.remark(fmt::format("wrote {}: {} runs\n", file.name(), report_.runs - report_.failed_runs));
      return 0;
    }
    if (file.closed_pipe()) return static_cast<int>(Status::closed_pipe);
    return fail(messages_, Status::file_error, cannot_write, fmt::format("{}: {}", file.name(), file.problem()));
  }

  int complete_table(waveform::OutputFile& file) {
    const int status = write_whole(file, analysis::file_table(runs_), messages_);
    const auto files = std::count_if(records_.begin(), records_.end(), [](const SweptRun& record) { return !record.file.empty(); });
    if (status == 0) say_written(fmt::format("{} and {} file{} of runs", file.name(), files, files == 1 ? "" : "s"));
    return status;
  }

  int complete(waveform::OutputFile& file) {
    if (task_.options.split) return complete_table(file);
    const bool is_counted = !raw_ || raw_->flush();
    if (is_counted && file.commit()) {
      say_written(task_.options.no_rows ? "nothing" : file.name());
      return 0;
    }
    if (file.closed_pipe()) return static_cast<int>(Status::closed_pipe);
    std::string text = fmt::format("{}: {}", file.name(), file.problem());
    if (!file.partial_name().empty()) text += fmt::format("; the rows written are in {}", file.partial_name());
    return fail(messages_, Status::file_error, "E-cannot-write", text);
  }

  /// Tables of a line a run, as CSV; then those of .four. An empty line between them.
  int print_tables() {
    const Stream stream = task_.options.output == "-" ? Stream::error : Stream::output;
    const int digits = digits_for(stream);
    std::vector<std::string> tables;
    const std::vector<std::string> signals(columns_.begin() + 1, columns_.end());
    if (task_.first.analyses.operating_point) tables.push_back(analysis::operating_point_table(runs_, signals, digits));
    const auto& list = task_.first.measurements.list;
    if (std::any_of(list.begin(), list.end(), [](const auto& m) { return m.shown; }))
      tables.push_back(analysis::measurement_table(runs_, task_.first.measurements, digits));
    std::string text = fmt::format("{}", fmt::join(tables, "\n"));
    for (std::size_t run = 0; run < records_.size(); ++run)
      for (const measure::FourierResult& result : records_[run].measurements.fourier)
        text += fmt::format("{}\n{}", name(run), measure::fourier_text(result));
    for (std::size_t run = 0; run < records_.size(); ++run)
      if (!records_[run].sensitivities.empty())
        text += fmt::format("\n{}\n{}", name(run), analysis::derivative_text(records_[run].sensitivities, digits));
    return text.empty() ? 0 : print(text, messages_, stream);
  }

  /// Of each measurement the first run in which that text of it is not empty, with how many others have one.
  void tell_measurements(std::string measure::Result::*text, Diagnostic (*warning_of)(const measure::Result&, const std::string&)) {
    for (std::size_t k = 0; k < task_.first.measurements.list.size(); ++k) {
      const auto has_text = [&](const SweptRun& record) {
        return record.done && k < record.measurements.list.size() && !(record.measurements.list[k].*text).empty();
      };
      const auto first = std::find_if(records_.begin(), records_.end(), has_text);
      if (first == records_.end()) continue;
      const auto others = std::count_if(first + 1, records_.end(), has_text);
      const std::string run = name(static_cast<std::size_t>(first - records_.begin()));
      Diagnostic warning = warning_of(first->measurements.list[k], fmt::format(" in the run with {}", run));
      if (others > 0) warning.text += fmt::format(" (and in {})", analysis::counted(static_cast<std::uint64_t>(others), "other run"));
      messages_.report(warning, task_.sources);
    }
  }

  const SweepTask& task_;
  Messages& messages_;
  analysis::RunReport& report_;
  analysis::SweptRuns& runs_;
  std::vector<SweptRun>& records_;
  const circuit::Sweeps& sweeps_;
  std::size_t threads_;
  std::vector<std::string> columns_;
  std::optional<analysis::SteppedSources> sources_;
  std::optional<waveform::RawWriter> raw_;     ///< of the head and the number of rows
  std::optional<analysis::OrderedRows> rows_;  ///< of a deck with .tran
  Beside orbits_, responses_, derivatives_;
  std::atomic<std::size_t> begun_ = 0;
  std::atomic<bool> writing_failed_ = false;  ///< of a run's own file
  std::mutex mutex_;                          ///< of finished_
  std::condition_variable one_finished_;
  std::size_t finished_ = 0;
};

}  // namespace

int run_sweep(const SweepTask& task, Messages& messages, analysis::RunReport& report, analysis::SweptRuns& runs) {
  return Sweep(task, messages, report, runs).run();
}

}  // namespace pwlsim::cli
