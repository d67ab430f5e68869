#include <pwlsim/pwlsim.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "analysis/fitted_diodes.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/run_recorder.hpp"
#include "api/messages.hpp"
#include "api/result_data.hpp"
#include "base/names.hpp"
#include "circuit/compile.hpp"
#include "netlist/load.hpp"

namespace pwlsim {

/// A circuit on its way to an engine. Throws Error as soon as one of the steps reports an error.
class Compilation {
 public:
  Compilation(const Circuit& circuit, const Options& options, bool analysis_required) {
    read(circuit, options);
    compiled_ =
        circuit::compile(deck_, sources_, diagnostics_, {.analysis_required = analysis_required, .measure = true, .run = options.run});
    check();
  }

  [[nodiscard]] const circuit::Compiled& compiled() const { return *compiled_; }
  [[nodiscard]] std::vector<Message> messages() const { return api::messages_of(diagnostics_, sources_); }

  [[nodiscard]] analysis::PreparedEngine engine(const Options& options) {
    const auto choice = options.engine == Engine::exact    ? analysis::EngineChoice::exact
                        : options.engine == Engine::sparse ? analysis::EngineChoice::sparse
                                                           : analysis::EngineChoice::automatic;
    const double reltol = analysis::relative_tolerance(options.reltol, compiled_->analyses);
    if (const auto note = analysis::fit_diodes(*compiled_, choice, reltol, nullptr)) diagnostics_.note(note->id, note->span, note->text);
    analysis::PreparedEngine engine = analysis::prepare_engine(compiled_->network, choice, reltol, diagnostics_);
    check();
    return engine;
  }

 private:
  void check() const {
    if (diagnostics_.has_errors()) throw Error(messages());
  }

  void read(const Circuit& circuit, const Options& options) {
    if (circuit.base_ == Circuit::Base::file) load(circuit.base_text_);
    if (circuit.base_ == Circuit::Base::text) deck_ = netlist::parse("deck", circuit.base_text_, sources_, diagnostics_);
    const bool has_cards = circuit.text_.find('\n') + 1 < circuit.text_.size();
    if (has_cards || circuit.base_ == Circuit::Base::none) append(netlist::parse("code", circuit.text_, sources_, diagnostics_));
    if (options.stop != 0.0) set_transient(options);
  }

  void load(const std::string& path) {
    netlist::Loaded loaded = netlist::load(path, sources_, diagnostics_);
    if (!loaded.readable) check();
    deck_ = std::move(loaded.deck);
  }

  void append(netlist::Deck deck) {
    std::move(deck.cards.begin(), deck.cards.end(), std::back_inserter(deck_.cards));
    if (deck_.title.empty()) deck_.title = std::move(deck.title);
  }

  void set_transient(const Options& options) {
    std::erase_if(deck_.cards, [](const netlist::Card& card) { return same_name(card.name, ".tran"); });
    append(netlist::parse("options",
                          fmt::format("\n.tran {} {} {}{}\n", Value(options.step).text(), Value(options.stop).text(),
                                      Value(options.start).text(), options.use_initial_conditions ? " uic" : ""),
                          sources_, diagnostics_));
  }

  SourceStore sources_;
  Diagnostics diagnostics_;
  netlist::Deck deck_;
  std::optional<circuit::Compiled> compiled_;
};

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
    if (!each.left_out.empty()) data.messages.push_back(api::message_of(measure::left_out_warning(each)));
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
  data.statistics = {data.statistics.engine, s.states, s.ports, s.switches, s.modes_visited, s.events, s.jumps, s.seconds_simulate};
  data.end = answer.time;
  for (const engine::Remark& remark : answer.remarks) data.messages.push_back(api::message_of(analysis::message_of(remark)));
}

void take_sweep(const circuit::Sweeps& sweeps, std::size_t run, Result::Data& data) {
  const std::vector<double> point = sweeps.point(run);
  for (std::size_t k = 0; k < point.size(); ++k) data.stepped.emplace_back(sweeps.list[k].name, point[k]);
}

void check_run(std::size_t run, const circuit::Sweeps& sweeps) {
  const std::size_t runs = std::max<std::size_t>(sweeps.runs(), 1);
  if (run >= runs) throw api::error("E-range", fmt::format("there is no run number {}; try 0 to {}", run, runs - 1));
}

std::shared_ptr<Result::Data> prepare(Compilation& compilation, const analysis::PreparedEngine& engine) {
  auto data = std::make_shared<Result::Data>();
  const std::vector<std::string> names = analysis::column_names(compilation.compiled());
  data->signals.assign(names.begin() + 1, names.end());
  data->messages = compilation.messages();
  if (engine.warning) data->messages.push_back(api::message_of(*engine.warning));
  data->statistics.engine = engine.name;
  return data;
}

}  // namespace

const char* version() { return PWLSIM_VERSION; }

Result Circuit::run(const Options& options) const {
  Compilation compilation(*this, options, true);
  const circuit::Compiled& compiled = compilation.compiled();
  if (!compiled.analyses.transient)
    throw api::error("E-no-transient", "the circuit has no .tran; try Options::stop, or Circuit::operating_point");
  check_run(options.run, compiled.analyses.sweeps);
  const analysis::PreparedEngine engine = compilation.engine(options);
  const auto data = prepare(compilation, engine);
  take_sweep(compiled.analyses.sweeps, options.run, *data);
  Columns columns(*data, options);
  EventList events(*data);
  const analysis::TransientRun run =
      analysis::run_rows(compiled, engine.simulate, columns,
                         {options.rows_at_events, false, options.progress, options.interrupt, nullptr, options.events ? &events : nullptr});
  take_answer(run.answer, *data);
  take_measurements(run.measurements, *data);
  data->completed = run.ending == analysis::Ending::completed;
  if (!data->completed) data->messages.push_back(api::message_of({Severity::error, run.id, {}, run.message}));
  if (run.ending == analysis::Ending::failed) throw RunError(Result(data));
  return Result(data);
}

std::vector<std::pair<std::string, double>> Circuit::operating_point(const Options& options) const {
  Compilation compilation(*this, options, false);
  const analysis::PreparedEngine engine = compilation.engine(options);
  const auto data = prepare(compilation, engine);
  const engine::OperatingPoint point = engine.operating_point();
  take_answer(point.answer, *data);
  if (point.answer.outcome != engine::Outcome::completed) {
    data->messages.push_back(api::message_of({Severity::error, point.answer.id, {}, point.answer.message}));
    throw RunError(Result(data));
  }
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t k = 0; k < data->signals.size(); ++k) values.emplace_back(data->signals[k], point.values[k]);
  return values;
}

std::size_t Circuit::runs() const {
  const Compilation compilation(*this, {}, false);
  return std::max<std::size_t>(compilation.compiled().analyses.sweeps.runs(), 1);
}

}  // namespace pwlsim
