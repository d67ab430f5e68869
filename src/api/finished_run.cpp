#include "api/finished_run.hpp"

#include <algorithm>
#include <utility>

#include "analysis/run_recorder.hpp"
#include "analysis/steady_state.hpp"
#include "api/messages.hpp"

namespace pwlsim::api {
namespace {

/// Rows into columns, or to the caller.
class Columns : public waveform::RowWriter {
 public:
  Columns(Result::Data& data, const Options& options) : data_(data), options_(options) { data_.columns.resize(data_.signals.size()); }

  bool write(std::span<const double> values) override {
    const std::size_t width = data_.columns.size() + 1;
    for (std::size_t at = 0; at < values.size(); at += width) take(values.subspan(at, width));
    return true;
  }
  bool flush() override { return true; }

 private:
  void take(std::span<const double> row) {
    if (options_.row) {
      row_.assign(row.begin() + 1, row.end());
      options_.row(row[0], row_);
      return;
    }
    data_.time.push_back(row[0]);
    for (std::size_t k = 0; k < data_.columns.size(); ++k) data_.columns[k].push_back(row[k + 1]);
  }

  Result::Data& data_;
  const Options& options_;
  std::vector<double> row_;
};

class EventList : public engine::EventWatcher {
 public:
  explicit EventList(Result::Data& data) : data_(data) {}

  void begin(std::span<const std::string> elements, std::span<const char> on) override {
    names_ = analysis::port_names(elements);
    on_.assign(on.begin(), on.end());
    for (std::size_t k = 0; k < on.size(); ++k)
      if (on[k] != 0) data_.on_at_start.push_back(names_[k]);
  }

  void happened(const engine::Event& event, std::span<const char> on) override {
    Event& told = data_.events.emplace_back(Event{event.time, event.source_edge, event.mode_change, event.jump, {}, {}});
    for (std::size_t k = 0; k < on.size(); ++k) {
      if ((on[k] != 0) == (on_[k] != 0)) continue;
      (on[k] != 0 ? told.turned_on : told.turned_off).push_back(names_[k]);
      on_[k] = on[k];
    }
  }

 private:
  Result::Data& data_;
  std::vector<std::string> names_;
  std::vector<char> on_;
};

void take_measurements(const measure::Results& results, Result::Data& data) {
  for (const measure::Result& each : results.list) {
    data.measurements.push_back({each.name, each.value, each.unit, each.failure, each.left_out});
    if (!each.left_out.empty()) data.messages.push_back(message_of(measure::left_out_warning(each)));
  }
  for (const measure::FourierResult& each : results.fourier) {
    Fourier fourier{each.column, each.failure, {}, each.total_distortion};
    for (const measure::Harmonic& h : each.harmonics) fourier.harmonics.push_back({h.frequency, h.magnitude, h.phase});
    data.fourier.push_back(std::move(fourier));
  }
}

void take_answer(const engine::Answer& answer, Result::Data& data) {
  const engine::Certificate& c = answer.certificate;
  data.certificate = {c.complementarity, c.kcl_kvl, c.energy, c.has_passivity ? std::optional(c.passive) : std::nullopt};
  const engine::Statistics& s = answer.statistics;
  data.statistics = {answer.engine.empty() ? data.statistics.engine : answer.engine,
                     s.states,
                     s.ports,
                     s.switches,
                     s.modes_visited,
                     s.events,
                     s.jumps,
                     s.seconds_simulate};
  data.end = answer.time;
  for (const engine::Remark& remark : answer.remarks) data.messages.push_back(message_of(analysis::message_of(remark)));
}

}  // namespace

std::shared_ptr<Result::Data> begin_result(const circuit::Compiled& compiled, std::vector<Message> messages, std::string engine) {
  auto data = std::make_shared<Result::Data>();
  const std::vector<std::string> names = analysis::column_names(compiled);
  data->signals.assign(names.begin() + 1, names.end());
  data->messages = std::move(messages);
  data->statistics.engine = std::move(engine);
  return data;
}

std::shared_ptr<Result::Data> begin_result(Compilation& compilation, const analysis::PreparedEngine& engine) {
  auto data = begin_result(compilation.compiled(), compilation.messages(), engine.name);
  if (engine.warning) data->messages.push_back(message_of(*engine.warning));
  return data;
}

void start_on_orbit(const circuit::Compiled& compiled, analysis::PreparedEngine& engine, const Options& options,
                    const std::shared_ptr<Result::Data>& data) {
  if (!compiled.analyses.steady_state) return;
  const auto refuse = [&](std::string id, std::string message) {
    data->messages.push_back(message_of({Severity::error, std::move(id), {}, std::move(message)}));
    throw RunError(Result(data));
  };
  static const std::atomic<int> never = 0;
  const analysis::EngineChoice choice = choice_of(options.engine);
  if (!analysis::has_orbit_engine(compiled, choice)) refuse("E-pss-engine", analysis::orbit_needs_exact_engine);
  const analysis::SteadyState state =
      analysis::find_steady_state(compiled, choice, options.interrupt != nullptr ? *options.interrupt : never);
  for (const Diagnostic& message : state.messages) data->messages.push_back(message_of(message));
  if (!state.is_found) refuse(state.id, state.message);
  Diagnostics diagnostics;
  engine.simulate = analysis::from_orbit(compiled, state, diagnostics);
  if (engine.simulate) return;
  for (const Diagnostic& message : diagnostics.all()) data->messages.push_back(message_of(message));
  throw RunError(Result(data));
}

bool run_into(Result::Data& data, std::shared_ptr<const KeptRun> kept, const Options& options, engine::Sampler* sampler,
              double longest_window) {
  Columns columns(data, options);
  EventList events(data);
  analysis::RunControl control{options.rows_at_events, false,   options.progress,
                               options.interrupt,      nullptr, options.events ? &events : nullptr};
  control.sampler = sampler;
  control.longest_window = longest_window;
  const analysis::TransientRun run = analysis::run_rows(*kept->compiled, kept->simulate, columns, control);
  take_answer(run.answer, data);
  take_measurements(run.measurements, data);
  data.completed = run.ending == analysis::Ending::completed;
  if (!data.completed) data.messages.push_back(message_of({Severity::error, run.id, {}, run.message}));
  if (options.evaluable) data.kept = std::move(kept);
  return run.ending != analysis::Ending::failed;
}

void take_answer_of(const engine::Answer& answer, Result::Data& data) { take_answer(answer, data); }

}  // namespace pwlsim::api
