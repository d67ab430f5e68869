#include "analysis/transient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <span>
#include <string_view>
#include <utility>

#include "analysis/quantity.hpp"
#include "analysis/rated_parts.hpp"
#include "analysis/row_grid.hpp"
#include "analysis/run_recorder.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class FileSink : public engine::RowSink {
 public:
  FileSink(waveform::RowWriter& writer, std::size_t columns, RatedCurrents& rated) : writer_(writer), columns_(columns), rated_(rated) {}

  bool write(std::span<const double> values, std::size_t count) override {
    const auto start = Clock::now();
    const std::size_t good = finite_rows(values, count);
    watch(values.first(good * columns_));
    rated_.add(values.first(good * columns_), columns_);
    rows_ += good;
    if (good != 0) last_time_ = values[(good - 1) * columns_];
    const bool written = writer_.write(values.first(good * columns_));
    seconds_ += seconds_since(start);
    return written && good == count;
  }
  bool flush() {
    const auto start = Clock::now();
    const bool written = writer_.flush();
    seconds_ += seconds_since(start);
    return written;
  }

  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  [[nodiscard]] double last_time() const { return last_time_; }
  [[nodiscard]] double seconds() const { return seconds_; }
  /// Column of the first value that was not finite; 0 where all were.
  [[nodiscard]] std::size_t bad_column() const { return bad_column_; }
  /// All rows hold the values of the first, up to the error of an operating point.
  [[nodiscard]] bool is_still() const { return is_still_ && rows_ > 1 && columns_ > 1; }

 private:
  void watch(std::span<const double> values) {
    if (!is_still_ || values.empty()) return;
    if (first_.empty()) {
      first_.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(columns_));
      for (std::size_t column = 1; column < columns_; ++column) scale_ = std::max(scale_, std::abs(first_[column]));
    }
    constexpr double still_within = 1e-9;  // of the largest value
    for (std::size_t index = 0; index < values.size() && is_still_; ++index)
      is_still_ = index % columns_ == 0 || std::abs(values[index] - first_[index % columns_]) <= still_within * scale_;
  }

  std::size_t finite_rows(std::span<const double> values, std::size_t count) {
    for (std::size_t index = 0; index < count * columns_; ++index) {
      if (std::isfinite(values[index])) continue;
      bad_column_ = index % columns_;
      return index / columns_;
    }
    return count;
  }

  waveform::RowWriter& writer_;
  std::size_t columns_;
  RatedCurrents& rated_;
  std::uint64_t rows_ = 0;
  std::size_t bad_column_ = 0;
  std::vector<double> first_;  ///< row
  double scale_ = 0.0;         ///< its largest value
  bool is_still_ = true;
  double last_time_ = 0.0;
  double seconds_ = 0.0;
};

const char* raw_type(std::string_view signal) {
  const std::string_view unit = unit_of_signal(signal);
  return unit == "V" ? "voltage" : unit == "A" ? "current" : "notype";
}

engine::NonUnique non_unique(circuit::NonUniqueChoice choice) {
  switch (choice) {
    case circuit::NonUniqueChoice::first:
      return engine::NonUnique::first;
    case circuit::NonUniqueChoice::stay:
      return engine::NonUnique::stay;
    case circuit::NonUniqueChoice::error:
      break;
  }
  return engine::NonUnique::error;
}

void judge(TransientRun& run, const FileSink& sink, const std::vector<std::string>& names) {
  run.id = run.answer.id;
  run.message = run.answer.message;
  switch (run.answer.outcome) {
    case engine::Outcome::completed:
      break;
    case engine::Outcome::interrupted:
      run.ending = Ending::interrupted;
      run.id = "E-interrupted";
      if (run.message.empty()) run.message = fmt::format("interrupted at t = {}", quantity(run.answer.time, "s"));
      break;
    case engine::Outcome::sink_stopped:
    case engine::Outcome::no_solution:
    case engine::Outcome::not_unique:
    case engine::Outcome::accumulation:
      run.ending = Ending::failed;
      break;
  }
  if (sink.bad_column() != 0) {
    run.ending = Ending::failed;
    run.id = "E-overflow";
    run.message =
        fmt::format("{} exceeds the range of numbers after t = {}; try a shorter run, or look for an element that feeds energy in",
                    names[sink.bad_column()], quantity(sink.last_time(), "s"));
  }
  if (!run.message.empty() && !run.answer.mode.empty()) run.message += "; mode: " + run.answer.mode;
}

bool has_constant_sources(const model::Network& network) {
  return std::all_of(network.sources.begin(), network.sources.end(),
                     [](const model::Source& source) { return std::holds_alternative<model::Dc>(source.function); });
}

/// An oscillator without noise does not leave an unstable equilibrium. Passive circuits have none.
void note_rest(engine::Answer& answer, const circuit::Compiled& compiled, const FileSink& sink) {
  const engine::Statistics& counted = answer.statistics;
  const bool may_switch = counted.states > 0 && counted.ports + counted.switches > 0 && counted.events + counted.jumps == 0;
  const bool may_leave = answer.certificate.has_passivity && !answer.certificate.passive;
  if (answer.outcome != engine::Outcome::completed || !may_switch || !may_leave || !sink.is_still() ||
      !has_constant_sources(compiled.network))
    return;
  answer.remarks.push_back(
      {"N-at-rest",
       "no signal moves: all sources are constant, and the run starts in an equilibrium; if an oscillation should start from there, "
       "add an initial value (.ic) or a source with a step"});
}

void complete(TransientRun& run, waveform::OutputFile& file) {
  if (run.is_written && file.commit()) return;
  run.ending = file.closed_pipe() ? Ending::closed_pipe : Ending::write_failed;
  run.id = "E-cannot-write";
  run.message = fmt::format("{}: {} at t = {}", file.name(), file.problem(), quantity(run.last_row, "s"));
  if (!file.partial_name().empty()) run.message += fmt::format("; the rows written are in {}", file.partial_name());
}

/// Pieces of the run for its measurements and for its pictures.
class PieceFork : public engine::PieceSink {
 public:
  PieceFork(engine::Probes measured, RunRecorder* recorder) : measured_(std::move(measured)), recorder_(recorder) {}

  /// The measured probes, and behind them the signals that are drawn.
  engine::Probes probes() {
    engine::Probes all = measured_;
    if (recorder_ == nullptr) return all;
    const bool is_measured = measured_.sink != nullptr;
    if (!is_measured) all.signals.clear();
    measured_count_ = all.signals.size();
    for (std::size_t k = 0; k < recorder_->solution().signals(); ++k) all.signals.push_back(static_cast<int>(k));
    all.from = is_measured ? std::min(all.from, recorder_->from()) : recorder_->from();
    all.to = is_measured ? std::max(all.to, recorder_->to()) : recorder_->to();
    count_ = std::max<std::size_t>(1, all.signals.size());
    all.sink = this;
    return all;
  }

  void before_start(std::span<const double> values) override {
    if (measured_.sink != nullptr) measured_.sink->before_start(values.first(measured_count_));
  }
  void take(const engine::Piece& piece) override {
    const std::size_t kept = measured_count_ * (piece.values.size() / count_);
    if (measured_.sink != nullptr && piece.to > measured_.from && piece.from < measured_.to) {
      engine::Piece own = piece;
      own.values = piece.values.first(kept);
      if (!piece.noise.empty()) own.noise = piece.noise.first(measured_count_);
      measured_.sink->take(own);
    }
    engine::Piece drawn = piece;
    drawn.values = piece.values.subspan(kept);
    recorder_->take_piece(drawn);
  }
  void impulse(double time, std::span<const double> values) override {
    if (measured_.sink != nullptr) measured_.sink->impulse(time, values.first(measured_count_));
  }

 private:
  engine::Probes measured_;
  RunRecorder* recorder_;
  std::size_t measured_count_ = 0, count_ = 1;  ///< probes that are measured, and all
};

/// The run with its measurements: once with rows, and again for those that need results of the first.
class MeasuredRun {
 public:
  /// `recorder` may be null.
  MeasuredRun(const circuit::Compiled& compiled, const Simulate& simulate, RunRecorder* recorder, double longest_window)
      : compiled_(compiled),
        simulate_(simulate),
        recorder_(recorder),
        measuring_(compiled.measurements, compiled.analyses.transient->start.seconds, compiled.analyses.transient->stop.seconds,
                   std::max(compiled.analyses.transient->stop.seconds, longest_window)) {}

  engine::Answer run(engine::Request request, engine::RowSink& sink) {
    request.unsaved_signals = compiled_.measured_signals;
    const bool measures = !compiled_.measurements.empty();
    if (measures) (void)measuring_.begin_pass();
    PieceFork fork(measures ? measuring_.probes() : engine::Probes{}, recorder_);
    request.probes = fork.probes();
    if (!measures) return simulate_(request, sink);
    engine::Answer answer = simulate_(request, sink);
    measuring_.end_pass(answer.probed);
    if (answer.outcome == engine::Outcome::completed) run_again(request, answer);
    return answer;
  }

  [[nodiscard]] measure::Results results() const { return measuring_.results(); }
  [[nodiscard]] measure::Record record() const { return measuring_.record(); }

 private:
  /// A signal meanwhile counts as one in the first run.
  void run_again(engine::Request request, engine::Answer& first) {
    NoRows sink;
    request.grid = {};
    request.events = request.jumps = false;
    request.watcher = nullptr;
    while (measuring_.begin_pass()) {
      request.probes = measuring_.probes();
      const engine::Answer answer = simulate_(request, sink);
      measuring_.end_pass(answer.probed);
      if (answer.outcome == engine::Outcome::completed) continue;
      if (answer.outcome == engine::Outcome::interrupted) {
        first.outcome = answer.outcome;
        first.id = answer.id;
        first.message = answer.message;
        first.mode = answer.mode;
      }
      return;
    }
  }

  const circuit::Compiled& compiled_;
  const Simulate& simulate_;
  RunRecorder* recorder_;
  measure::Measuring measuring_;
};

}  // namespace

engine::Request request_of(const circuit::Analyses& analyses, const RunControl& control) {
  engine::Request request;
  request.stop = analyses.transient->stop.seconds;
  request.grid = row_grid(*analyses.transient);
  request.events = control.events;
  request.jumps = control.jumps;
  request.use_initial_conditions = analyses.transient->use_initial_conditions;
  request.non_unique = non_unique(analyses.non_unique);
  request.progress = control.progress;
  request.interrupt = control.interrupt;
  request.sampler = control.sampler;
  request.watcher = control.recorder != nullptr ? control.recorder : control.watcher;
  return request;
}

std::vector<std::string> column_names(const circuit::Compiled& compiled) {
  std::vector<std::string> names{"time"};
  for (std::size_t k = 0; k < compiled.saved_signals(); ++k) names.push_back(compiled.network.signals[k].name);
  return names;
}

Diagnostic message_of(const engine::Remark& remark) {
  return {remark.id.starts_with("W-") ? Severity::warning : Severity::note, remark.id, {}, remark.text};
}

std::vector<waveform::RawVector> raw_vectors(const circuit::Compiled& compiled) {
  const std::vector<std::string> names = column_names(compiled);
  std::vector<waveform::RawVector> vectors{{names[0], "time"}};
  for (std::size_t k = 1; k < names.size(); ++k) vectors.push_back({names[k], raw_type(names[k])});
  return vectors;
}

std::unique_ptr<waveform::RowWriter> row_writer(RowFormat format, const circuit::Compiled& compiled, waveform::OutputFile& file) {
  if (format == RowFormat::csv) return std::make_unique<waveform::CsvWriter>(file, column_names(compiled));
  return std::make_unique<waveform::RawWriter>(file, compiled.title, raw_vectors(compiled));
}

TransientRun run_rows(const circuit::Compiled& compiled, const Simulate& simulate, waveform::RowWriter& writer, const RunControl& control) {
  const std::vector<std::string> names = column_names(compiled);
  RatedCurrents currents(compiled.rated_currents, names);
  FileSink sink(writer, names.size(), currents);
  MeasuredRun measured(compiled, simulate, control.recorder, control.longest_window);
  TransientRun run;
  const auto broken = [&](std::string id, std::string_view what) {
    run.ending = Ending::failed;
    run.id = std::move(id);
    run.message = fmt::format("{} after t = {}", what, quantity(sink.last_time(), "s"));
  };
  try {
    engine::Request request = request_of(compiled.analyses, control);
    RatedParts rated(compiled.rated_ports, request.watcher);
    if (!compiled.rated_ports.empty()) request.watcher = &rated;
    run.answer = measured.run(std::move(request), sink);
    if (auto remark = rated.remark(run.answer.time)) run.answer.remarks.push_back(std::move(*remark));
    if (auto remark = currents.remark()) run.answer.remarks.push_back(std::move(*remark));
    judge(run, sink, names);
    note_rest(run.answer, compiled, sink);
  } catch (const std::bad_alloc&) {
    broken("E-out-of-memory", "no memory is left");
  } catch (...) {  // a defect of the program: the rows up to it are still worth keeping
    broken("E-internal", "the engine met a state it should never reach");
  }
  if (control.recorder != nullptr) control.recorder->end(std::max(run.answer.time, sink.last_time()));
  run.is_written = sink.flush();
  run.measurements = measured.results();
  run.measured = measured.record();
  run.rows = sink.rows();
  run.last_row = sink.last_time();
  run.seconds_write = sink.seconds();
  return run;
}

TransientRun run_transient(const circuit::Compiled& compiled, const Simulate& simulate, waveform::OutputFile& file,
                           waveform::RowWriter& writer, const RunControl& control) {
  TransientRun run = run_rows(compiled, simulate, writer, control);
  complete(run, file);
  return run;
}

}  // namespace pwlsim::analysis
