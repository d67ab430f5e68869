#include "analysis/steady_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "analysis/orbit_names.hpp"
#include "analysis/orbit_verdict.hpp"
#include "analysis/quantity.hpp"
#include "analysis/repeated_pieces.hpp"
#include "analysis/segment_names.hpp"
#include "analysis/sensitivity_inputs.hpp"
#include "base/names.hpp"
#include "engine/exact/exact_model.hpp"
#include "engine/exact/start.hpp"
#include "engine/left_out.hpp"
#include "engine/remarks.hpp"
#include "model/islands.hpp"
#include "steady/carried_trace.hpp"
#include "steady/segment_orbit.hpp"
#include "steady/self_timed.hpp"
#include "steady/subharmonic.hpp"
#include "steady/touches.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Compiled;
using Trigger = circuit::SteadyStateAnalysis::Trigger;
using steady::Orbit;
using steady::Verdict;

constexpr int most_steps_on_segments = 2000;  ///< of Newton's method, each of which costs some periods; those on dense modes cost far more
constexpr const char* watch_part = "when";    // no part of the circuit, and not told of
constexpr const char* watch_name = "when.level";

/// A switch that closes where the signal rises above the level, across a resistor of its own; nothing else reads it.
void add_watch(model::Network& network, const model::LinearForm& signal, double level) {
  const auto node = static_cast<model::NodeIndex>(network.nodes.size());
  network.nodes.push_back({watch_name, {}});
  network.resistors.push_back({{watch_name, {}}, node, model::ground, 1.0});
  model::Switch watch;
  watch.label.name = watch_name;
  watch.p = node;
  watch.control = signal;
  watch.on_level = watch.off_level = level;
  watch.resistance = 1.0;
  network.switches.push_back(std::move(watch));
  network.signals.push_back({watch_name, {{model::Term::Kind::node_voltage, node, 1.0}}});
}

/// The mean of one signal over all rows, weighed by 1 − cos(2πt/length): what is cut off of a period does not count.
class SignalMean : public engine::RowSink {
 public:
  SignalMean(std::size_t signal, std::size_t signals, double length) : signal_(signal), width_(signals + 1), length_(length) {}
  bool write(std::span<const double> values, std::size_t count) override {
    for (std::size_t k = 0; k < count; ++k) {
      const double weight = 1.0 - std::cos(2.0 * std::numbers::pi * values[k * width_] / length_);
      sum_ += weight * values[k * width_ + 1 + signal_];
      weights_ += weight;
    }
    return true;
  }
  [[nodiscard]] double mean() const { return weights_ > 0.0 ? sum_ / weights_ : 0.0; }

 private:
  std::size_t signal_, width_;
  double length_, sum_ = 0.0, weights_ = 0.0;
};

/// Those that something saved depends on.
std::vector<model::Source> needed_sources(const model::Network& network) {
  std::vector<model::Source> sources;
  for (const model::Island& island : model::split_islands(network, engine::must_run))
    if (island.needed) sources.insert(sources.end(), island.network.sources.begin(), island.network.sources.end());
  return sources;
}

/// Krylov segments, where they were asked for, or fit a driven circuit without other analyses around its orbit.
bool finds_orbit_by_segments(const Compiled& compiled, EngineChoice choice) {
  if (choice == EngineChoice::krylov) return true;
  if (!runs_by_segments(compiled.network, choice)) return false;
  const bool has_others = compiled.analyses.small_signal || compiled.analyses.sensitivities;
  if (has_others && has_modes(compiled.network, choice)) return false;
  return !steady::common_period(needed_sources(compiled.network)).sources.empty();
}

engine::GivenStores values_of(const engine::sparse::PeriodMap& map, const engine::sparse::PeriodMap::State& state) {
  engine::GivenStores values;
  const linalg::Vector stored = map.values(map.energies(map.unknowns(state)));
  for (std::size_t i = 0; i < map.stores().size(); ++i) {
    const auto& store = map.stores()[i];
    (store.unit == "V" ? values.voltages : values.currents)[store.element] = stored[static_cast<Eigen::Index>(i)];
  }
  return values;
}

class Finder {
 public:
  Finder(const Compiled& compiled, EngineChoice choice, const std::atomic<int>& interrupt)
      : compiled_(compiled),
        card_(*compiled.analyses.steady_state),
        interrupt_(interrupt),
        choice_(choice),
        has_segments_(finds_orbit_by_segments(compiled, choice)) {}

  SteadyState run() {
    if (!choose_period()) return std::move(state_);
    if (state_.common.seconds == 0.0 && task_.period == 0.0)
      find_self_timed();
    else
      find_driven();
    if (is_left_to_modes()) return run_with_modes();
    judge_orbit(card_, state_);
    if (state_.is_found && has_inputs_apart() && !carry_to_inputs()) return run_with_inputs();
    if (state_.is_found || state_.has_best_attempt) describe();
    return std::move(state_);
  }

  /// False: the circuit has no model.
  bool prepare(Diagnostics& diagnostics) {
    state_.common = steady::common_period(needed_sources(compiled_.network));
    for (const std::string& name : state_.common.settled)
      say(Severity::note, "N-pss-source-settled", fmt::format("{} is not periodic: the steady state uses its final value", name));
    state_.compiled = compiled_;
    state_.compiled.network = steady::with_settled_sources(compiled_.network);
    if (card_.trigger == Trigger::crosses) {
      const auto probe = static_cast<std::size_t>(compiled_.orbit_measurements.probe_signals[static_cast<std::size_t>(card_.probe)]);
      add_watch(state_.compiled.network, compiled_.network.signals[probe].form, card_.level_is_mean ? mean_of(probe) : card_.level);
      ++state_.compiled.measured_signals;
    }
    if (has_segments_) {
      const auto model = engine::sparse::prepare(state_.compiled.network, diagnostics);
      if (model) state_.map = std::make_shared<engine::sparse::PeriodMap>(model, &interrupt_);
      return model != nullptr;
    }
    if (has_inputs_apart()) {
      network_with_inputs_ = state_.compiled.network;
      (void)add_all_inputs(network_with_inputs_);
    } else {
      state_.compiled.measured_signals += add_all_inputs(state_.compiled.network);
    }
    state_.model = model_ = engine::prepare(state_.compiled.network, diagnostics);
    if (!model_) return false;
    engine::March::Options options;
    options.interrupt = &interrupt_;
    options.non_unique = request_of_choice(compiled_.analyses.non_unique);
    march_ = std::make_shared<engine::March>(*model_, options);
    return true;
  }

 private:
  /// Those of derivatives are many: the search runs without them.
  [[nodiscard]] bool has_inputs_apart() const { return compiled_.analyses.sensitivities && !searches_with_inputs_ && !has_segments_; }

  /// The number of signals that they bring along.
  std::size_t add_all_inputs(model::Network& network) {
    const std::size_t signals = network.signals.size();
    if (const auto& small = compiled_.analyses.small_signal) state_.inputs = add_small_signal_inputs(*small, network);
    if (const auto& sensitivities = compiled_.analyses.sensitivities)
      state_.parameters = add_inputs(*sensitivities, compiled_.network, network);
    return network.signals.size() - signals;
  }

  /// False where the model with the inputs differs in more than these.
  bool carry_to_inputs() {
    const auto apart = std::make_shared<OrbitWithInputs>();
    apart->network = std::move(network_with_inputs_);
    Diagnostics diagnostics;
    apart->model = engine::prepare(apart->network, diagnostics);
    if (!apart->model) return false;
    apart->selectors = std::make_shared<engine::Selectors>(*apart->model, request_of_choice(compiled_.analyses.non_unique));
    apart->trace = state_.orbit.trace;
    state_.apart = apart;
    return steady::carry(apart->trace, *model_, *apart->model, *apart->selectors, state_.orbit.period);
  }

  SteadyState run_with_inputs() {
    searches_with_inputs_ = true;
    state_ = {};
    task_ = {};
    Diagnostics diagnostics;
    if (prepare(diagnostics)) return run();
    fail("E-pss-not-converged", "the circuit with the inputs of its derivatives has no model");
    return std::move(state_);
  }

  /// Where Krylov segments find no solution on the way, and dense modes are in reach.
  [[nodiscard]] bool is_left_to_modes() const {
    return has_segments_ && state_.orbit.verdict == Verdict::run_failed && has_modes(compiled_.network, choice_);
  }

  SteadyState run_with_modes() {
    const engine::Answer failed = state_.orbit.answer;
    has_segments_ = false;
    state_ = {};
    task_ = {};
    Diagnostics diagnostics;
    if (!prepare(diagnostics)) {
      fail(failed.id, "on the way to the orbit, " + failed.message);
      return std::move(state_);
    }
    say(Severity::note, "N-other-engine",
        fmt::format("Krylov segments found no solution at t = {}; the orbit was sought with dense modes", quantity(failed.time, "s")));
    return run();
  }

  bool fail(std::string id, std::string message, bool is_wrong_input = false) {
    state_.id = std::move(id);
    state_.message = std::move(message);
    state_.is_wrong_input = is_wrong_input;
    return false;
  }
  void say(Severity severity, std::string id, std::string text) {
    state_.messages.push_back({severity, std::move(id), {}, std::move(text)});
  }

  void tell(const std::vector<engine::Remark>& remarks) {
    for (const engine::Remark& remark : remarks) state_.messages.push_back(message_of(remark));
  }

  /// Over a few periods of the guess, behind tstab.
  double mean_of(std::size_t signal) {
    constexpr double periods = 16.0;
    constexpr int points = 4096;
    if (!state_.common.sources.empty() || !card_.period) return 0.0;
    Diagnostics diagnostics;
    const model::Network& network = state_.compiled.network;
    model_ = engine::prepare(network, diagnostics);
    if (!model_) return 0.0;
    engine::March march(*model_, {request_of_choice(compiled_.analyses.non_unique), &interrupt_});
    const auto told = static_cast<std::ptrdiff_t>(state_.messages.size());
    std::optional<engine::RunState> begin = start();
    state_.messages.erase(state_.messages.begin() + told, state_.messages.end());  // they are told of the model with the watch
    if (!begin) return 0.0;
    engine::RunState& from = *begin;
    if (card_.settling_time && *card_.settling_time > 0.0) march.advance(from, *card_.settling_time, nullptr);
    const double length = periods * *card_.period;
    engine::Request request;
    request.stop = length;
    request.use_initial_conditions = true;
    request.interrupt = &interrupt_;
    request.grid = {[length](std::uint64_t k) { return length * static_cast<double>(k) / points; }, points};
    SignalMean mean(signal, network.signals.size(), length);
    (void)march.run(from, request, mean);
    return mean.mean();
  }

  static engine::NonUnique request_of_choice(circuit::NonUniqueChoice choice) {
    return choice == circuit::NonUniqueChoice::first  ? engine::NonUnique::first
           : choice == circuit::NonUniqueChoice::stay ? engine::NonUnique::stay
                                                      : engine::NonUnique::error;
  }

  /// With as many digits as tell the two apart.
  static std::string multiple_text(double asked, double period) {
    constexpr int most_digits = 17;
    int digits = 6;
    while (digits < most_digits && quantity(asked, "s", digits) == quantity(period, "s", digits)) ++digits;
    return fmt::format("period={} is not a multiple of {}, the common period of the sources; try period={}", quantity(asked, "s", digits),
                       quantity(period, "s", digits), period);
  }

  /// E-pss-no-period and what is wrong with period=.
  bool choose_period() {
    task_.multiple = state_.multiple = card_.multiple;
    task_.tolerance = card_.tolerance;
    if (has_segments_) task_.most_iterations = most_steps_on_segments;
    if (card_.most_iterations) task_.most_iterations = *card_.most_iterations;
    if (card_.most_periods) task_.most_periods = *card_.most_periods;
    const steady::CommonPeriod& common = state_.common;
    if (common.sources.empty()) return true;
    if (card_.is_free)
      return fail("E-pss-free",
                  fmt::format("free requests a self-timed orbit, but {} is periodic; try without free, or a constant source",
                              common.sources.front().name),
                  true);
    double period = common.seconds;
    if (!common.failure.empty()) {
      if (!card_.period || card_.is_hint) return fail("E-pss-no-period", common.failure);
      period = *card_.period;
      if (!fits_sources(period)) return false;
    } else if (card_.period && !card_.is_hint) {
      const std::int64_t whole = steady::whole_multiple(*card_.period, period);
      if (whole == 0) return fail("E-pss-not-a-multiple", multiple_text(*card_.period, period), true);
      task_.multiple = state_.multiple = static_cast<int>(whole) * card_.multiple;
    }
    state_.common.seconds = period;
    task_.period = period * task_.multiple;
    if (card_.periods_before) task_.periods_before = *card_.periods_before;
    if (card_.settling_time) task_.periods_before = static_cast<int>(std::min(1e6, std::ceil(*card_.settling_time / period)));
    return true;
  }

  /// A period that the card gives where the sources have none in common: each must be near its begin again.
  bool fits_sources(double period) {
    constexpr double most_cut = 0.01, none_cut = 1e-9;  // of a source's period
    for (steady::PeriodicSource& source : state_.common.sources) {
      const double cycles = period / source.period, cut = std::abs(cycles - std::nearbyint(cycles));
      const std::string held = fmt::format("period={} contains {:.9g} periods of {}", quantity(period, "s"), cycles, source.name);
      if (cut > most_cut || std::nearbyint(cycles) < 1.0)
        return fail("E-pss-not-a-multiple",
                    fmt::format("{}; try a period that contains a whole number of periods of each source, to within a hundredth", held),
                    true);
      source.cycles = static_cast<std::int64_t>(std::nearbyint(cycles));
      if (cut > none_cut * cycles)
        say(Severity::warning, "W-pss-cut-source",
            fmt::format("{}: its phase jumps by {:.3g} of its period at the end of each one", held, cut));
    }
    return true;
  }

  /// None: the orbit says why.
  std::optional<engine::RunState> start() {
    const engine::RunStart from =
        card_.use_initial_conditions ? engine::start_from_initial_values(*model_) : engine::start_from_operating_point(*model_);
    tell(from.answer.remarks);
    if (!has_begun(from.answer)) return std::nullopt;
    return from;
  }

  bool has_begun(const engine::Answer& answer) {
    if (answer.outcome == engine::Outcome::completed) return true;
    state_.orbit.verdict = Verdict::run_failed;
    state_.orbit.answer = answer;
    return false;
  }

  /// ngspice's card always names a node.
  void remark_on_trigger() {
    if (card_.trigger != circuit::SteadyStateAnalysis::Trigger::none && !card_.level_is_mean)
      say(Severity::note, "N-pss-no-effect",
          fmt::format("{} has no effect: the circuit is driven, and the orbit begins with a period of its sources", trigger_text(card_)));
  }

  void find_driven() {
    remark_on_trigger();
    if (has_segments_) return find_driven_by_segments();
    const bool begins_on_segments = runs_by_segments(compiled_.network, choice_ == EngineChoice::modes ? EngineChoice::exact : choice_);
    if (begins_on_segments)
      if (const auto remarks = find_driven_from_segments()) return tell(*remarks);
    const std::optional<engine::RunState> from = start();
    if (!from) return;
    state_.orbit = steady::find_driven_orbit(*march_, *from, task_);
    if (state_.orbit.verdict == Verdict::not_converged && !begins_on_segments) (void)find_driven_from_segments();
  }

  /// Segments find the orbit of a large circuit far sooner, and of a ladder of many diodes more often; dense modes take a step or two from there. Remarks on the start; none: no orbit is found that way.
  std::optional<std::vector<engine::Remark>> find_driven_from_segments() {
    Diagnostics diagnostics;
    const auto model = engine::sparse::prepare(steady::with_settled_sources(compiled_.network), diagnostics);
    if (!model) return std::nullopt;
    engine::sparse::PeriodMap map(model, &interrupt_);
    engine::sparse::Starts from = map.start(card_.use_initial_conditions);
    if (from.answer.outcome != engine::Outcome::completed || !from.missing.empty()) return std::nullopt;
    steady::OrbitTask task = task_;
    if (!card_.most_iterations) task.most_iterations = most_steps_on_segments;
    const Orbit near = steady::find_segment_orbit(map, from.parts, task);
    if (near.verdict == Verdict::interrupted) {
      state_.orbit = near;
      return from.answer.remarks;
    }
    if (near.verdict != Verdict::found) return std::nullopt;
    task = task_;
    task.periods_before = 1;  // in which switches with hysteresis find their sides
    Orbit orbit = steady::find_driven_orbit(*march_, engine::start_from(*model_, values_of(map, from.parts)), task);
    if (orbit.verdict != Verdict::found && orbit.verdict != Verdict::interrupted) return std::nullopt;
    orbit.iterations += state_.orbit.iterations + near.iterations;
    orbit.periods_simulated += state_.orbit.periods_simulated + near.periods_simulated;
    state_.orbit = std::move(orbit);
    return from.answer.remarks;
  }

  void find_driven_by_segments() {
    const engine::sparse::Starts from = state_.map->start(card_.use_initial_conditions);
    tell(from.answer.remarks);
    if (!has_begun(from.answer)) return;
    if (!from.missing.empty()) state_.messages.push_back(message_of(engine::starts_without_operating_point(from.missing.text())));
    state_.begin = from.parts;
    state_.orbit = steady::find_segment_orbit(*state_.map, state_.begin, task_);
  }

  void find_self_timed() {
    if (has_segments_) {
      fail("E-pss-engine", "without a periodic source the steady state needs dense modes; try --engine modes");
      return;
    }
    steady::SelfTimedTask task;
    task.orbit = task_;
    task.hint = card_.period.value_or(card_.longest_period.value_or(0.0));
    if (compiled_.analyses.transient) task.horizon = compiled_.analyses.transient->stop.seconds;
    if (card_.settling_time) task.settling_time = *card_.settling_time;
    if (card_.trigger != Trigger::none) {
      std::optional<steady::Section> section = section_of_card();
      if (!section) return;
      task.section = std::move(*section);
    }
    std::optional<engine::RunState> from = start();
    if (!from) return;
    state_.orbit = steady::find_self_timed_orbit(*march_, *from, task);
    if (card_.trigger == Trigger::crosses)
      state_.orbit.section = fmt::format("{} {} through {}", card_.element, card_.is_falling ? "falls" : "rises",
                                         card_.level_is_mean ? std::string("its mean") : fmt::format("{}", card_.level));
    if (!card_.level_is_mean || state_.orbit.verdict != Verdict::no_event) return;
    task.section.reset();  // what oscillates does not pass its mean
    from = start();
    if (from) state_.orbit = steady::find_self_timed_orbit(*march_, *from, task);
  }

  std::optional<steady::Section> section_of_card() {
    const bool crosses = card_.trigger == Trigger::crosses;
    const bool closes = crosses ? !card_.is_falling : card_.trigger == Trigger::closes;
    const std::string name = crosses ? watch_name : card_.element;
    if (auto section = steady::section_of(*model_, name, closes)) return section;
    fail("E-pss-no-trigger", fmt::format("{} is not a switch or diode whose state is known; try {}=S1, or when v(node)=level",
                                         card_.element, closes ? "on" : "off"));
    return std::nullopt;
  }

  void describe() {
    const Orbit& orbit = state_.orbit;
    circuit::HiddenParts hidden = compiled_.hidden;
    if (card_.trigger == Trigger::crosses) hidden.names.insert(watch_part);
    if (has_segments_) {
      state_.modes = orbit_modes(*state_.map, hidden);
      state_.states = states_after_start(*state_.map);
    } else {
      state_.modes = orbit_modes(*model_, hidden, orbit.trace, orbit.period);
      state_.states = states_after_start(*model_, orbit.trace);
    }
    Compiled& own = state_.compiled;
    own.measurements = compiled_.orbit_measurements;
    circuit::TransientAnalysis& run = own.analyses.transient.emplace();
    run.stop = {orbit.period, ""};
    constexpr int points_when_omitted = 1000;
    if (card_.points != points_when_omitted) run.step = {orbit.period / card_.points, ""};
    run.use_initial_conditions = true;
    run.span = card_.span;
    std::function<engine::Answer(const engine::Request&, engine::RowSink&)> from_begin;
    if (has_segments_) {
      from_begin = [map = state_.map, begin = state_.begin](const auto& request, auto& sink) { return map->run(begin, request, sink); };
    } else {
      state_.orbit.begin.signals = steady::signals_at_end(*model_, orbit.trace, orbit.period);
      from_begin = [march = march_, model = model_, begin = orbit.begin](const auto& request, auto& sink) {
        return march->run(begin, request, sink);
      };
    }
    const bool is_driven = !state_.common.sources.empty();
    state_.simulate = [from_begin, period = orbit.period, is_driven](engine::Request request, engine::RowSink& sink) {
      RepeatedPieces repeated(request.probes, period, is_driven);
      request.probes = repeated.probes();
      if (!is_driven && request.probes.sink != nullptr && request.stop >= period) request.stop = RepeatedPieces::self_timed_end(period);
      engine::Answer answer = from_begin(request, sink);
      if (answer.outcome == engine::Outcome::completed) answer.probed = repeated.repeat(answer.probed);
      return answer;
    };
  }

  const Compiled& compiled_;
  const circuit::SteadyStateAnalysis& card_;
  const std::atomic<int>& interrupt_;
  EngineChoice choice_;
  bool has_segments_;
  bool searches_with_inputs_ = false;
  model::Network network_with_inputs_;  ///< where it does not
  SteadyState state_;
  steady::OrbitTask task_;
  std::shared_ptr<const engine::ExactModel> model_;
  std::shared_ptr<engine::March> march_;
};

}  // namespace

bool has_orbit_engine(const Compiled& compiled, EngineChoice choice) {
  return has_modes(compiled.network, choice) || finds_orbit_by_segments(compiled, choice);
}

OrbitSearch prepare_orbit(const Compiled& compiled, EngineChoice choice, const std::atomic<int>& interrupt, Diagnostics& diagnostics) {
  const auto finder = std::make_shared<Finder>(compiled, choice, interrupt);
  if (!finder->prepare(diagnostics)) return {};
  return [finder] { return finder->run(); };
}

SteadyState find_steady_state(const Compiled& compiled, EngineChoice choice, const std::atomic<int>& interrupt) {
  Diagnostics diagnostics;
  if (const OrbitSearch search = prepare_orbit(compiled, choice, interrupt, diagnostics)) return search();
  SteadyState state;
  const auto errors = diagnostics.all();
  const auto error = std::find_if(errors.begin(), errors.end(), [](const Diagnostic& each) { return each.severity == Severity::error; });
  if (error != errors.end()) {
    state.id = error->id;
    state.message = error->text;
  }
  return state;
}

}  // namespace pwlsim::analysis
