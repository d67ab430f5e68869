#include "cli/sweep_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>

#include "analysis/ordered_rows.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/transient.hpp"
#include "cli/output.hpp"
#include "cli/progress.hpp"
#include "cli/signals.hpp"
#include "cli/status.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::cli {
namespace {

using analysis::Ending;

constexpr std::size_t runs_ahead = 4;  ///< of each thread, of the first run that is not finished
constexpr auto between_looks = std::chrono::milliseconds(50);
constexpr std::size_t most_failures_told = 20;

/// What is kept of a run.
struct RunRecord {
  bool done = false;
  bool interrupted = false;
  std::string id, message;  ///< of a failure
  engine::Statistics statistics;
  engine::Certificate certificate;
  std::vector<engine::Remark> remarks;
  measure::Results measurements;
  std::uint64_t rows = 0;
};

void add(engine::Statistics& sum, const engine::Statistics& one) {
  sum.islands = std::max(sum.islands, one.islands);
  sum.states = std::max(sum.states, one.states);
  sum.ports = std::max(sum.ports, one.ports);
  sum.switches = std::max(sum.switches, one.switches);
  sum.modes_visited += one.modes_visited;
  sum.events += one.events;
  sum.jumps += one.jumps;
  sum.accumulations += one.accumulations;
  sum.lcp_pivots += one.lcp_pivots;
  sum.klu_factorizations += one.klu_factorizations;
  sum.klu_solves += one.klu_solves;
  sum.steps += one.steps;
  sum.seconds_simulate += one.seconds_simulate;
  sum.seconds_certificate += one.seconds_certificate;
}

void add(engine::Certificate& worst, const engine::Certificate& one, bool is_first) {
  worst.complementarity = std::max(worst.complementarity, one.complementarity);
  worst.kcl_kvl = std::max(worst.kcl_kvl, one.kcl_kvl);
  worst.energy = std::max(worst.energy, one.energy);
  worst.has_passivity = one.has_passivity && (is_first || worst.has_passivity);
  worst.passive = one.passive && (is_first || worst.passive);
  worst.points_checked += one.points_checked;
}

class Sweep {
 public:
  Sweep(const SweepTask& task, Messages& messages, analysis::RunReport& report)
      : task_(task),
        messages_(messages),
        report_(report),
        sweeps_(task.first.analyses.sweeps),
        threads_(std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, sweeps_.runs())),
        records_(sweeps_.runs()),
        rows_(task.rows, runs_ahead * threads_) {}

  int run() {
    rows_.write_head(head());
    {
      Progress progress(task_.options.progress, static_cast<double>(records_.size()));
      run_all(progress);
    }
    sum_up();
    tell_remarks();
    const int status = std::max(tell_failures(), complete());
    return std::max(status, print_measurements());
  }

 private:
  /// "1000,1e-06,"
  [[nodiscard]] std::string prefix(std::size_t run) const {
    std::string text;
    for (const double value : sweeps_.point(run)) text += waveform::shortest(value) + ",";
    return text;
  }
  /// "R=1000, C=1e-06"
  [[nodiscard]] std::string name(std::size_t run) const {
    std::string text;
    const std::vector<double> values = sweeps_.point(run);
    for (std::size_t k = 0; k < values.size(); ++k)
      text += fmt::format("{}{}={}", k == 0 ? "" : ", ", sweeps_.list[k].name, waveform::shortest(values[k]));
    return text;
  }
  [[nodiscard]] std::string swept_names() const {
    std::string text;
    for (const circuit::Sweep& sweep : sweeps_.list) text += waveform::csv_field(sweep.name) + ",";
    return text;
  }
  [[nodiscard]] std::string head() const {
    std::string text = swept_names();
    for (const std::string& column : analysis::column_names(task_.first)) text += waveform::csv_field(column) + ",";
    text.back() = '\n';
    return text;
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
      rows_.wait_to_begin(run);
      one_run(run);
      const std::scoped_lock lock(mutex_);
      ++finished_;
      one_finished_.notify_one();
    }
  }

  void one_run(std::size_t run) {
    RunRecord& record = records_[run];
    bool has_rows = false;
    try {
      if (caught_signal() != 0 || rows_.failed())
        record.interrupted = true;
      else
        has_rows = simulate(run, record);
    } catch (...) {  // want of memory, or a defect of the program: the other runs go on
      record.id = "E-internal";
      record.message = "the run met a state it should never reach, or no memory is left";
    }
    if (!has_rows) (void)rows_.finish(run, "");
  }

  /// False where the run did not come to rows.
  bool simulate(std::size_t run, RunRecord& record) {
    Diagnostics diagnostics;
    SourceStore sources = task_.sources;  // shipped subcircuits are added
    const auto compiled = circuit::compile(task_.deck, sources, diagnostics, {.measure = true, .run = run});
    analysis::PreparedEngine engine;
    if (compiled) engine = analysis::prepare_engine(compiled->network, task_.options.engine, task_.reltol, diagnostics);
    if (!engine.simulate || diagnostics.has_errors()) {
      note_error(diagnostics, record);
      return false;
    }
    analysis::SteppedRows writer(rows_, run, prefix(run), analysis::column_names(*compiled).size());
    const analysis::TransientRun result =
        analysis::run_rows(*compiled, engine.simulate, writer, {task_.options.events, false, {}, &caught_signal(), nullptr});
    record.done = result.ending == Ending::completed;
    record.interrupted = result.ending == Ending::interrupted;
    record.id = result.id;
    record.message = result.message;
    record.statistics = result.answer.statistics;
    record.certificate = result.answer.certificate;
    record.remarks = result.answer.remarks;
    record.measurements = result.measurements;
    record.rows = result.rows;
    return true;
  }

  static void note_error(const Diagnostics& diagnostics, RunRecord& record) {
    for (const Diagnostic& diagnostic : diagnostics.all()) {
      if (diagnostic.severity != Severity::error) continue;
      record.id = diagnostic.id;
      record.message = diagnostic.text;
      return;
    }
  }

  void sum_up() {
    report_.runs = records_.size();
    bool is_first = true;
    for (const RunRecord& record : records_) {
      add(report_.statistics, record.statistics);
      report_.statistics.rows += record.rows;
      add(report_.certificate, record.certificate, is_first);
      is_first = false;
      report_.failed_runs += static_cast<std::uint64_t>(!record.done);
    }
    report_.seconds.simulate = report_.statistics.seconds_simulate;
    report_.seconds.certificate = report_.statistics.seconds_certificate;
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
      const std::string others = place.second > 1 ? fmt::format(" (and likewise in {} other runs)", place.second - 1) : "";
      messages_.report(analysis::message_of({id, fmt::format("run with {}: {}{}", name(place.first), remark->text, others)}));
    }
  }

  int tell_failures() {
    std::size_t failures = 0;
    for (std::size_t run = 0; run < records_.size(); ++run) {
      const RunRecord& record = records_[run];
      if (record.done || record.interrupted || record.id.empty()) continue;
      if (++failures <= most_failures_told)
        (void)fail(messages_, Status::run_failed, record.id, fmt::format("run with {}: {}", name(run), record.message));
    }
    if (failures > most_failures_told)
      messages_.report({Severity::note, "N-more-failures", {}, fmt::format("{} more runs failed", failures - most_failures_told)});
    if (const int signal_number = caught_signal(); signal_number != 0) {
      const auto done = std::count_if(records_.begin(), records_.end(), [](const RunRecord& record) { return record.done; });
      (void)fail(messages_, Status::run_failed, "E-interrupted",
                 fmt::format("stopped by a signal after {} of {} runs; their rows are in {}", done, records_.size(), task_.rows.name()));
      return status_of_signal(signal_number);
    }
    return failures > 0 ? static_cast<int>(Status::run_failed) : 0;
  }

  int complete() {
    if (task_.rows.commit()) {
      const auto done = report_.runs - report_.failed_runs;
      messages_.remark(fmt::format("wrote {}: {} runs{}, {} rows, {} events\n", task_.rows.name(), done,
                                   report_.failed_runs > 0 ? fmt::format(" of {}", report_.runs) : "", report_.statistics.rows,
                                   report_.statistics.events));
      return 0;
    }
    if (task_.rows.closed_pipe()) return static_cast<int>(Status::closed_pipe);
    std::string text = fmt::format("{}: {}", task_.rows.name(), task_.rows.problem());
    if (!task_.rows.partial_name().empty()) text += fmt::format("; the rows written are in {}", task_.rows.partial_name());
    return fail(messages_, Status::file_error, "E-cannot-write", text);
  }

  /// A line a run, as CSV; then the tables of .four.
  int print_measurements() {
    if (task_.first.measurements.empty()) return 0;
    tell_failed_measurements();
    std::string text;
    const auto& list = task_.first.measurements.list;
    if (std::any_of(list.begin(), list.end(), [](const auto& m) { return m.shown; })) text = measurement_table();
    for (std::size_t run = 0; run < records_.size(); ++run)
      for (const measure::FourierResult& result : records_[run].measurements.fourier)
        text += fmt::format("{}\n{}", name(run), measure::fourier_text(result));
    return print(text, messages_, task_.options.output == "-" ? Stream::error : Stream::output);
  }

  /// Of each measurement the first run that lacks it, with how many others do.
  void tell_failed_measurements() {
    for (std::size_t k = 0; k < task_.first.measurements.list.size(); ++k) {
      const auto lacks = [&](const RunRecord& record) {
        return record.done && k < record.measurements.list.size() && !record.measurements.list[k].failure.empty();
      };
      const auto first = std::find_if(records_.begin(), records_.end(), lacks);
      if (first == records_.end()) continue;
      const auto others = std::count_if(first + 1, records_.end(), lacks);
      const measure::Result& result = first->measurements.list[k];
      messages_.report({Severity::warning, "W-measurement-failed", result.span,
                        fmt::format("measurement {} failed in the run with {}: {}{}", result.name,
                                    name(static_cast<std::size_t>(first - records_.begin())), result.failure,
                                    others > 0 ? fmt::format(" (and in {} other runs)", others) : "")},
                       task_.sources);
    }
  }

  std::string measurement_table() {
    std::string text = swept_names();
    for (const circuit::Measurement& measurement : task_.first.measurements.list)
      if (measurement.shown) text += waveform::csv_field(measurement.name) + ",";
    text.back() = '\n';
    for (std::size_t run = 0; run < records_.size(); ++run) {
      const auto& results = records_[run].measurements.list;
      text += prefix(run);
      std::size_t k = 0;
      for (const circuit::Measurement& measurement : task_.first.measurements.list) {
        if (!measurement.shown) continue;
        const bool has_value = k < results.size() && results[k].failure.empty();
        text += (has_value ? waveform::shortest(results[k].value) : "failed") + ",";
        ++k;
      }
      text.back() = '\n';
    }
    return text;
  }

  const SweepTask& task_;
  Messages& messages_;
  analysis::RunReport& report_;
  const circuit::Sweeps& sweeps_;
  std::size_t threads_;
  std::vector<RunRecord> records_;
  analysis::OrderedRows rows_;
  std::atomic<std::size_t> begun_ = 0;
  std::mutex mutex_;  ///< of finished_
  std::condition_variable one_finished_;
  std::size_t finished_ = 0;
};

}  // namespace

int run_sweep(const SweepTask& task, Messages& messages, analysis::RunReport& report) { return Sweep(task, messages, report).run(); }

}  // namespace pwlsim::cli
