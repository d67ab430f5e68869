#include "cli/compare_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "analysis/json.hpp"
#include "analysis/prepared_engine.hpp"
#include "analysis/quantity.hpp"
#include "cli/compare_report.hpp"
#include "cli/deck_reader.hpp"
#include "cli/picture_file.hpp"
#include "cli/progress.hpp"
#include "cli/signals.hpp"

namespace pwlsim::cli {
namespace {

constexpr std::size_t sample_count = 200;
constexpr std::size_t most_events = 20'000;
constexpr double events_per_second = 30.0;  ///< of the budget: so many of a converter ngspice follows at all settings in about that time

/// The engine that `pwlsim circuit.net` takes.
analysis::PreparedEngine prepare(const model::Network& network, const circuit::Analyses& analyses, Diagnostics& diagnostics) {
  return analysis::prepare_engine(network, analysis::EngineChoice::automatic, analysis::relative_tolerance({}, analyses), diagnostics,
                                  caught_signal());
}

/// Equally spaced within (start, stop), moved off the events: there a signal may jump.
std::vector<double> sample_times(const circuit::TransientAnalysis& transient, const std::vector<double>& events) {
  const double start = transient.start.seconds, length = transient.stop.seconds - start, apart = length / (100.0 * sample_count);
  std::vector<double> times;
  for (std::size_t k = 1; k <= sample_count; ++k) {
    double time = start + length * (static_cast<double>(k) - 0.5) / sample_count;
    const auto next = std::lower_bound(events.begin(), events.end(), time - apart);
    if (next != events.end() && *next < time + apart) {
      const double end = next + 1 == events.end() ? transient.stop.seconds : *(next + 1);
      time = std::min(*next + apart, 0.5 * (*next + end));
    }
    if (times.empty() || time > times.back()) times.push_back(time);
  }
  return times;
}

/// The network with the currents of its diodes and switches as further signals.
struct Watched {
  model::Network network;
  std::vector<std::string> names;
};

Watched watched(const model::Network& network) {
  Watched result{network, {}};
  const auto watch = [&](const model::Label& label, model::Term::Kind kind, std::size_t index) {
    result.names.push_back(label.name);
    result.network.signals.push_back({label.name, {{kind, static_cast<int>(index), 1.0}}});
  };
  for (std::size_t k = 0; k < network.diodes.size(); ++k) watch(network.diodes[k].label, model::Term::Kind::diode_current, k);
  for (std::size_t k = 0; k < network.switches.size(); ++k) watch(network.switches[k].label, model::Term::Kind::switch_current, k);
  return result;
}

/// A part conducts in an interval where its current at the middle is not zero to rounding.
std::vector<spice::SwitchingTimes> changes_of(const std::vector<double>& events, const analysis::SampledRun& middles,
                                              const std::vector<std::string>& names, std::size_t first) {
  constexpr double rounding = 1e-9;
  std::vector<spice::SwitchingTimes> list;
  for (std::size_t part = 0; part < names.size(); ++part) {
    const std::vector<double>& current = middles.columns[first + part];
    double largest = 0.0;
    for (double i : current) largest = std::max(largest, std::abs(i));
    const auto on = [&](std::size_t k) { return std::abs(current[k]) > rounding * largest; };
    list.push_back({names[part], {}});
    for (std::size_t k = 1; k < current.size(); ++k)
      if (on(k) != on(k - 1)) list.back().times.push_back(events[k - 1]);
  }
  return list;
}

double largest_of(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Signals that are rounding beside the largest of their unit, or below ngspice's absolute tolerance, have no relative difference worth a line.
void leave_out_noise(spice::Comparison& comparison) {
  constexpr double rounding = 1e-9;
  const auto unit = [](const spice::ComparedSignal& signal) { return analysis::unit_of_signal(signal.name); };
  const auto is_noise = [&](const spice::ComparedSignal& signal) {
    double largest = 0.0;
    for (const spice::ComparedSignal& other : comparison.signals)
      if (unit(other) == unit(signal)) largest = std::max(largest, other.scale);
    const double known = unit(signal) == "A" ? spice::current_tolerance : unit(signal) == "V" ? spice::voltage_tolerance : 0.0;
    return signal.scale < std::max(rounding * largest, known);
  };
  std::vector<spice::ComparedSignal> kept;
  std::remove_copy_if(comparison.signals.begin(), comparison.signals.end(), std::back_inserter(kept), is_noise);
  comparison.signals = std::move(kept);
}

class CompareSession {
 public:
  explicit CompareSession(const CompareOptions& options) : options_(options), messages_(options.quiet) {}

  int run() {
    const DeckReading reading = read_deck(options_.deck, {.keep_circuit = true}, sources_, messages_);
    if (!reading.compiled) return static_cast<int>(reading.status);
    compiled_ = &*reading.compiled;
    analyses_ = compiled_->analyses;
    report_.deck = options_.deck;
    if (!compiled_->analyses.transient)
      return fail(Status::wrong_input, "E-no-transient",
                  "the deck has no .tran: there are no waveforms to compare; try pwlsim " + options_.deck);
    if (!options_.plot.empty())
      if (const int status = plot_.open(options_.plot, reading.files, messages_); status != 0) return status;
    const auto program = spice::find_ngspice();
    if (!program) return skip();
    int status = run_exact();
    if (status == 0) status = run_ngspice(*program);
    if (status == 0) status = write_plot();
    return status != 0 ? status : print(options_.json ? compare_json(report_) : compare_text(report_, options_.verbose), messages_);
  }

 private:
  int fail(Status status, std::string id, std::string text) { return cli::fail(messages_, status, std::move(id), std::move(text)); }

  int skip() {
    const std::string reason = "ngspice is not installed: no program of that name is in PATH; try apt install ngspice";
    messages_.report({Severity::note, "N-no-ngspice", {}, reason});
    if (!options_.json) return 0;
    return print(analysis::json_line({{"deck", analysis::json_string(report_.deck)}, {"skipped", analysis::json_string(reason)}}) + '\n',
                 messages_);
  }

  analysis::RunControl control() const { return {false, false, {}, &caught_signal()}; }

  int conclude(const engine::Answer& answer) {
    if (caught_signal() != 0) {
      fail(Status::run_failed, "E-interrupted", "interrupted before the comparison was complete");
      return status_of_signal(caught_signal());
    }
    if (answer.outcome == engine::Outcome::completed) return 0;
    return fail(Status::run_failed, answer.id, answer.message);
  }

  int run_exact() {
    Diagnostics diagnostics;
    const analysis::PreparedEngine engine = prepare(compiled_->network, compiled_->analyses, diagnostics);
    const Watched watch = watched(compiled_->network);
    Diagnostics known;
    const analysis::PreparedEngine watching = prepare(watch.network, compiled_->analyses, known);
    messages_.report(diagnostics, sources_);
    if (caught_signal() != 0) return conclude({});
    if (!engine.simulate || !watching.simulate) return static_cast<int>(Status::wrong_input);
    const std::size_t signals = compiled_->network.signals.size();
    report_.engine = engine.name;
    report_.grid = analysis::sample_grid(compiled_->analyses, signals, engine.simulate, control());
    report_.exact = report_.grid.answer;
    for (const engine::Remark& remark : report_.exact.remarks) messages_.report(analysis::message_of(remark));
    if (const int status = conclude(report_.exact); status != 0) return status;
    return sample(watching, watch, signals);
  }

  int sample(const analysis::PreparedEngine& engine, const Watched& watch, std::size_t signals) {
    const circuit::TransientAnalysis& transient = *analyses_.transient;
    const std::size_t columns = watch.network.signals.size();
    analysis::RunControl with_events = control();
    with_events.events = true;
    const std::vector<double> ends{transient.start.seconds, transient.stop.seconds};
    const auto all = analysis::sample(compiled_->analyses, columns, engine.simulate, ends, with_events);
    if (const int status = conclude(all.answer); status != 0) return status;
    std::vector<double> events = analysis::repeated_times(all);
    cut_to_budget(events);
    times_ = sample_times(transient, events);
    auto sampled = analysis::sample(analyses_, columns, engine.simulate, times_, control());
    if (const int status = conclude(sampled.answer); status != 0) return status;
    report_.seconds_window = report_.is_cut ? sampled.answer.statistics.seconds_simulate : report_.exact.statistics.seconds_simulate;
    snubber_ = snubber_for(sampled, signals, events.size());
    sampled.columns.resize(signals);
    exact_.values = std::move(sampled.columns);
    report_.events_skipped = events.size() > most_events;
    return report_.events_skipped ? 0 : watch_events(engine, watch, signals, events);
  }

  /// A run with more events than ngspice can follow in its time is compared up to the last that it can.
  void cut_to_budget(std::vector<double>& events) {
    circuit::TransientAnalysis& transient = *analyses_.transient;
    const auto most = static_cast<std::size_t>(std::max(1.0, events_per_second * options_.budget));
    report_.stop = report_.until = transient.stop.seconds;
    if (events.size() <= most) return;
    report_.is_cut = true;
    report_.until = transient.stop.seconds = 0.5 * (events[most - 1] + events[most]);
    events.resize(most);
  }

  /// As large as the circuit's voltages over its currents, and fast beside the time between its events.
  spice::Snubber snubber_for(const analysis::SampledRun& run, std::size_t signals, std::size_t events) const {
    double voltage = 0.0, current = 0.0;
    for (std::size_t k = 0; k < run.columns.size(); ++k) {
      const bool is_voltage = k < signals && analysis::unit_of_signal(compiled_->network.signals[k].name) == "V";
      if (is_voltage) voltage = std::max(voltage, largest_of(run.columns[k]));
      if (k >= signals) current = std::max(current, largest_of(run.columns[k]));
    }
    if (current <= 0.0) return {};
    const double length = analyses_.transient->stop.seconds - analyses_.transient->start.seconds;
    return {voltage > 0.0 ? voltage / current : 1.0, length / static_cast<double>(events + 1)};
  }

  int watch_events(const analysis::PreparedEngine& engine, const Watched& watch, std::size_t signals, const std::vector<double>& events) {
    const circuit::TransientAnalysis& transient = *analyses_.transient;
    std::vector<double> inner, middles;
    for (double event : events)
      if (event > transient.start.seconds && event < transient.stop.seconds) inner.push_back(event);
    for (std::size_t k = 0; k <= inner.size(); ++k)
      middles.push_back(0.5 *
                        ((k == 0 ? transient.start.seconds : inner[k - 1]) + (k == inner.size() ? transient.stop.seconds : inner[k])));
    const auto run = analysis::sample(analyses_, watch.network.signals.size(), engine.simulate, middles, control());
    if (const int status = conclude(run.answer); status != 0) return status;
    exact_.switching = changes_of(inner, run, watch.names, signals);
    return 0;
  }

  int run_ngspice(const std::string& program) {
    Diagnostics diagnostics;
    spice::StudySettings settings;
    settings.sharpness = options_.sharpness;
    settings.sample_times = times_;
    settings.interrupt = &caught_signal();
    settings.seconds = options_.budget;
    settings.snubber = snubber_;
    Progress progress(options_.progress, options_.budget);
    settings.watcher = [&](double seconds) { progress.spent(seconds); };
    circuit::FlatCircuit window = *compiled_->circuit;
    window.analyses = analyses_;
    report_.study = spice::refine(window, program, settings, diagnostics);
    messages_.report(diagnostics, sources_);
    if (diagnostics.has_errors()) return static_cast<int>(Status::wrong_input);
    if (caught_signal() != 0) return conclude({});
    report_.samples = times_.size();
    if (!report_.study.signals.empty()) report_.comparison = spice::compare(report_.study, times_, exact_);
    leave_out_noise(report_.comparison);
    return 0;
  }

  int write_plot() {
    if (!plot_.is_open()) return 0;
    std::vector<std::string> names;
    for (const model::Signal& signal : compiled_->network.signals) names.push_back(signal.name);
    return plot_.write(compare_svg(report_, names), messages_);
  }

  const CompareOptions& options_;
  Messages messages_;
  SourceStore sources_;
  const circuit::Compiled* compiled_ = nullptr;
  circuit::Analyses analyses_;  ///< up to where the comparison goes
  spice::Snubber snubber_;
  PictureFile plot_;
  std::vector<double> times_;
  spice::ExactResults exact_;
  CompareReport report_;
};

}  // namespace

int run_compare_session(const CompareOptions& options) { return CompareSession(options).run(); }

}  // namespace pwlsim::cli
