#include "analysis/small_signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include "analysis/quantity.hpp"
#include "base/names.hpp"
#include "base/zero_between.hpp"
#include "engine/exact/exact.hpp"
#include "engine/exact/exact_model.hpp"
#include "engine/exact/start.hpp"
#include "steady/transfer.hpp"
#include "steady/wave.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::SmallSignal;
using Complex = std::complex<double>;
using Response = std::function<steady::ComplexVector(double frequency, const std::vector<Complex>& amplitudes)>;

double degrees(Complex value) { return std::arg(value) * 180.0 / std::numbers::pi; }

/// "X1:V1" and "X1.V1" are one.
bool is_same_element(std::string a, std::string b) {
  for (std::string* name : {&a, &b}) std::replace(name->begin(), name->end(), ':', '.');
  return same_name(a, b);
}

std::vector<int> sources_named(const model::Network& network, const std::string& name) {
  std::vector<int> numbers;
  for (std::size_t k = 0; k < network.sources.size(); ++k)
    if (is_same_element(network.sources[k].label.name, name)) numbers.push_back(static_cast<int>(k));
  return numbers;
}

void add_input_on(model::Network& network, const std::vector<int>& sources, Complex amplitude, SmallSignalInputs& inputs) {
  const std::string name = fmt::format("ac {}", network.sources[static_cast<std::size_t>(sources.front())].label.name);
  const int input = steady::add_input(network, name);
  for (const int source : sources) steady::superpose_input(network, source, input);
  inputs.names.push_back(name);
  inputs.amplitudes.push_back(amplitude);
}

void add_loop_signals(model::Network& network, const std::string& source, SmallSignalInputs& inputs) {
  for (const model::Branch& branch : network.branches) {
    if (!is_same_element(branch.label.name, source)) continue;
    const auto signal_of = [&](model::NodeIndex node) {
      model::LinearForm form;
      if (node != model::ground) form.push_back({model::Term::Kind::node_voltage, node, 1.0});
      network.signals.push_back({fmt::format("loop {}", node), form});
      return static_cast<int>(network.signals.size()) - 1;
    };
    inputs.positive = signal_of(branch.p);
    inputs.negative = signal_of(branch.n);
    return;
  }
}

/// A second input; false where `name` is no current source at a node of the voltage source `loop`.
bool add_loop_current(model::Network& network, const std::string& loop, const std::string& name, SmallSignalInputs& inputs) {
  const auto is_named = [](const std::string& wanted) {
    return [&wanted](const auto& part) { return is_same_element(part.label.name, wanted); };
  };
  const auto injection = std::find_if(network.injections.begin(), network.injections.end(), is_named(name));
  const auto branch = std::find_if(network.branches.begin(), network.branches.end(), is_named(loop));
  const std::vector<int> sources = sources_named(network, name);
  if (injection == network.injections.end() || branch == network.branches.end() || sources.empty()) return false;
  const auto injected = [&](model::NodeIndex node) { return (injection->n == node ? 1.0 : 0.0) - (injection->p == node ? 1.0 : 0.0); };
  inputs.injected_at_positive = injected(branch->p);
  inputs.injected_at_negative = injected(branch->n);
  if (inputs.injected_at_positive == 0.0 && inputs.injected_at_negative == 0.0) return false;
  add_input_on(network, sources, 0.0, inputs);
  const auto number = static_cast<int>(branch - network.branches.begin());
  network.signals.push_back({"loop current", {{model::Term::Kind::branch_current, number, 1.0}}});
  inputs.current = static_cast<int>(network.signals.size()) - 1;
  return true;
}

/// T at a frequency; `voltages`: the response there to the voltage source alone.
Complex gain_at(const SmallSignalInputs& inputs, const Response& response, double frequency, const steady::ComplexVector& voltages) {
  const Complex by_voltage = -voltages[inputs.negative] / voltages[inputs.positive];
  if (inputs.current < 0) return by_voltage;
  const Complex through = response(frequency, {0.0, 1.0})[inputs.current];
  const Complex by_current = (inputs.injected_at_negative + through) / (inputs.injected_at_positive - through);
  return (by_voltage * by_current - 1.0) / (by_voltage + by_current + 2.0);
}

/// A pulse that begins later by a unit, or that ends later by one (`ends_only`).
steady::Wave moved_pulse(const model::Pulse& pulse, bool ends_only, int input) {
  model::Pulse by{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  (ends_only ? by.width : by.delay) = 1.0;
  return {input, pulse, by, -1, ""};
}

/// Pulses that move in time, as much as `by` says of each.
steady::TimeShifts shifts_of(const steady::LinearisedOrbit& orbit, const std::vector<steady::Wave>& waves, const std::vector<Complex>& by) {
  constexpr double same_time = 1e-9;  // of the period
  steady::TimeShifts moved;
  for (const steady::LinearInstant& instant : orbit.instants()) {
    Complex& shift = moved.shifts.emplace_back(0.0);
    const bool passes_threshold = instant.island >= 0 || instant.level_switch >= 0;
    for (std::size_t k = 0; k < waves.size(); ++k) {
      auto own = steady::edge_shift(waves[k], instant.time, same_time * orbit.period(), true);
      if (!own && !passes_threshold) own = steady::corner_shift(waves[k], instant.time, same_time * orbit.period(), true);
      if (own) shift = by[k] * *own;
    }
  }
  moved.amplitude = [&waves, by](std::size_t input, double time) {
    for (std::size_t k = 0; k < waves.size(); ++k)
      if (waves[k].input == static_cast<int>(input)) return by[k] * steady::wave_state(waves[k], time, time, true)[0];
    return Complex(0.0);
  };
  return moved;
}

/// A sinusoid whose frequency is modulated. Its phase follows by 2π/(jω) per hertz, so that it adds A cos(ω₀t + φ)·2π/(jω)·e^{jωt}: two inputs, at ω ± ω₀.
struct ModulatedSine {
  std::size_t input = 0;
  double amplitude = 0.0, frequency = 0.0, phase = 0.0;  ///< from t = 0 on
  int cycles = 0;                                        ///< in the period of the orbit
};

/// Empty where the source's sinusoid decays or ends.
std::optional<ModulatedSine> modulated_sine(const model::SourceFunction& function, std::size_t input, double period) {
  const auto* sine = std::get_if<model::Sin>(&function);
  if (sine == nullptr || sine->damping != 0.0 || std::isfinite(sine->cycles)) return std::nullopt;
  const double turn = 2.0 * std::numbers::pi;
  return ModulatedSine{input, sine->amplitude, sine->frequency, sine->phase - turn * sine->frequency * sine->delay,
                       static_cast<int>(std::lround(sine->frequency * period))};
}

/// Its harmonic: c_{h−N} of the input at f + f₀, and c_{h+N} of that at f − f₀.
steady::ComplexVector response_of(const ModulatedSine& sine, steady::Transfer& transfer, double f, int harmonic, std::size_t inputs,
                                  const std::optional<double>& sample) {
  steady::ComplexVector sum;
  for (const int side : {1, -1}) {
    std::vector<Complex> amplitudes(inputs, 0.0);
    amplitudes[sine.input] = 0.5 * sine.amplitude * std::exp(Complex(0.0, side * sine.phase)) / (Complex(0.0, 1.0) * f);
    steady::ComplexVector own = transfer.at(f + side * sine.frequency, harmonic - side * sine.cycles, amplitudes, {}, sample).signals;
    if (sample) own *= std::exp(Complex(0.0, side * 2.0 * std::numbers::pi * sine.frequency * *sample));
    sum = side > 0 ? own : steady::ComplexVector(sum + own);
  }
  return sum;
}

/// A zero of a real function between two frequencies at which it has different signs.
double zero_between_frequencies(double low, double high, const std::function<double(double)>& f) {
  constexpr int most = 60;
  constexpr double rounding = 1e-14;
  return std::exp(zero_between(std::log(low), std::log(high), rounding, most, [&](double at) { return f(std::exp(at)); }));
}

/// `values`: T at the frequencies.
LoopGain loop_gain(const SmallSignal& card, const SmallSignalInputs& inputs, const Response& response, std::vector<Complex> values) {
  const std::vector<double>& frequencies = card.frequencies;
  LoopGain loop;
  loop.source = card.loop;
  const auto gain = [&](double f) { return gain_at(inputs, response, f, response(f, inputs.amplitudes)); };
  loop.values = std::move(values);
  const auto margin = [](Complex t) {
    double phase = 180.0 + degrees(t);
    while (phase > 180.0) phase -= 360.0;
    return phase;
  };
  for (std::size_t k = 1; k < frequencies.size(); ++k) {
    const Complex a = loop.values[k - 1], b = loop.values[k];
    if (frequencies[k - 1] <= 0.0) continue;
    if ((std::abs(a) > 1.0) != (std::abs(b) > 1.0)) {
      const double f = zero_between_frequencies(frequencies[k - 1], frequencies[k], [&](double at) { return std::abs(gain(at)) - 1.0; });
      loop.crossovers.push_back({f, margin(gain(f))});
    }
    if (a.real() < 0.0 && b.real() < 0.0 && (a.imag() > 0.0) != (b.imag() > 0.0)) {
      const double f = zero_between_frequencies(frequencies[k - 1], frequencies[k], [&](double at) { return gain(at).imag(); });
      loop.gain_margins.push_back({f, -20.0 * std::log10(std::abs(gain(f)))});
    }
  }
  return loop;
}

/// c₀ for a constant input of an orbit whose phase nothing holds: its limit from frequencies at which there is one, c₀(ω) = Re c₀(0) + a ω² + b ω⁴ + ….
steady::ComplexVector limit_at_rest(double period, const std::function<steady::ComplexVector(double frequency)>& at) {
  constexpr double slow = 2e-5;        // of 1/period: what the series leaves out is of the order of (2π·slow)⁴
  constexpr double same_value = 1e-3;  // of two responses: they have a limit
  constexpr double rounding = 1e-12;   // of the largest response: nothing
  const steady::ComplexVector one = at(slow / period), two = at(2.0 * slow / period);
  steady::ComplexVector limit = ((4.0 * one - two) / 3.0).real().cast<Complex>();
  const double least = rounding * (one.allFinite() ? one.cwiseAbs().maxCoeff() : 0.0);
  for (Eigen::Index k = 0; k < limit.size(); ++k)
    if (!(std::abs(one[k] - two[k]) <= same_value * std::abs(one[k]) + least)) limit[k] = std::numeric_limits<double>::quiet_NaN();
  return limit;
}

using Column = SmallSignal::Column;

double part_of(Complex value, Column::Part part) {
  switch (part) {
    case Column::Part::magnitude:
      return std::abs(value);
    case Column::Part::phase:
      return degrees(value);
    case Column::Part::real:
      return value.real();
    case Column::Part::imaginary:
      return value.imag();
    case Column::Part::decibels:
      break;
  }
  return 20.0 * std::log10(std::abs(value));
}

/// "vm(out)" of "v(out)".
std::string named(const std::string& signal, char part) {
  const std::size_t open = std::min(signal.find('('), signal.size());
  return signal.substr(0, open) + part + signal.substr(open);
}

/// Which signals are columns, and which part of them.
struct Selection {
  std::size_t signal = 0;
  Column::Part part = Column::Part::magnitude;
};

/// Those of .print ac, else magnitude and phase of all that are saved.
std::vector<Selection> select_columns(const circuit::Compiled& compiled, SmallSignalResult& result) {
  std::vector<Selection> selected;
  const SmallSignal& card = *compiled.analyses.small_signal;
  const auto add = [&](std::string name, std::size_t signal, Column::Part part) {
    result.columns.push_back({std::move(name), {}});
    selected.push_back({signal, part});
  };
  for (const Column& column : card.columns)
    add(column.name, static_cast<std::size_t>(compiled.measurements.probe_signals[static_cast<std::size_t>(column.probe)]), column.part);
  for (std::size_t k = 0; k < result.signals.size() && card.columns.empty(); ++k) {
    add(named(result.signals[k], 'm'), k, Column::Part::magnitude);
    add(named(result.signals[k], 'p'), k, Column::Part::phase);
  }
  return selected;
}

SmallSignalResult evaluate(const circuit::Compiled& compiled, const SmallSignalInputs& inputs, const Response& response) {
  const SmallSignal& card = *compiled.analyses.small_signal;
  SmallSignalResult result;
  const std::size_t saved = compiled.saved_signals();
  for (std::size_t k = 0; k < saved; ++k) result.signals.push_back(compiled.network.signals[k].name);
  const std::vector<Selection> selected = select_columns(compiled, result);
  result.frequencies = card.frequencies;
  std::vector<Complex> gains;
  for (const double f : card.frequencies) {
    const steady::ComplexVector all = response(f, inputs.amplitudes);
    if (!card.loop.empty()) gains.push_back(gain_at(inputs, response, f, all));
    result.values.emplace_back(all.data(), all.data() + saved);
    for (std::size_t k = 0; k < selected.size(); ++k)
      result.columns[k].values.push_back(part_of(all[static_cast<Eigen::Index>(selected[k].signal)], selected[k].part));
    const auto is_infinite = [&](std::size_t signal) { return !std::isfinite(std::abs(all[static_cast<Eigen::Index>(signal)])); };
    bool is_singular = std::any_of(selected.begin(), selected.end(), [&](const Selection& each) { return is_infinite(each.signal); });
    for (std::size_t k = 0; k < saved; ++k) is_singular |= is_infinite(k);
    if (is_singular) result.singular.push_back(f);
  }
  if (!card.loop.empty()) result.loop = loop_gain(card, inputs, response, std::move(gains));
  return result;
}

}  // namespace

namespace {

/// Why the timing of a source cannot be modulated; "" where it can.
std::string immovable(const model::SourceFunction& function, const SmallSignal& card) {
  if (std::holds_alternative<model::Pulse>(function)) return "";
  if (card.input == SmallSignal::Input::duty) return "is not a PULSE source: only edges of PULSE sources can be moved";
  return modulated_sine(function, 0, 1.0) ? ""
                                          : "is neither a PULSE source nor a sinusoid without damping: its frequency cannot be modulated";
}

}  // namespace

SmallSignalInputs add_small_signal_inputs(const SmallSignal& card, model::Network& network) {
  SmallSignalInputs inputs;
  const auto fail = [&](const std::string& name) {
    inputs.id = "E-ac-no-input";
    inputs.message = name.empty() ? "no source has an AC value; try AC 1 on a source, or from=V1"
                                  : fmt::format("{} is not a source of the circuit", name);
    return inputs;
  };
  if (!card.loop.empty() || card.input == SmallSignal::Input::source) {
    const std::string& name = card.loop.empty() ? card.sources.front() : card.loop;
    const std::vector<int> sources = sources_named(network, name);
    if (sources.empty()) return fail(name);
    add_input_on(network, sources, 1.0, inputs);
    if (!card.loop.empty()) add_loop_signals(network, name, inputs);
    if (!card.loop.empty() && inputs.positive < 0) return fail(name);
    if (!card.loop_current.empty() && !add_loop_current(network, card.loop, card.loop_current, inputs)) {
      inputs.id = "E-ac-no-input";
      inputs.message = fmt::format("{} is not a current source at a node of {}; try {} 0 n+ 0, n+ being that node of {}", card.loop_current,
                                   card.loop, card.loop_current, card.loop);
    }
    return inputs;
  }
  if (card.input != SmallSignal::Input::marked) {
    for (const std::string& name : card.sources) {
      const std::vector<int> sources = sources_named(network, name);
      if (const std::string why = sources.empty() ? "is not a source of the circuit"
                                                  : immovable(network.sources[static_cast<std::size_t>(sources.front())].function, card);
          !why.empty()) {
        inputs.id = "E-ac-no-input";
        inputs.message = fmt::format("{} {}", name, why);
        return inputs;
      }
      add_input_on(network, sources, 0.0, inputs);
    }
    return inputs;
  }
  const std::size_t count = network.sources.size();
  for (std::size_t k = 0; k < count; ++k)
    if (const Complex amplitude = network.sources[k].alternating; amplitude != 0.0)
      add_input_on(network, {static_cast<int>(k)}, amplitude, inputs);
  return inputs.names.empty() ? fail("") : inputs;
}

SmallSignalResult small_signals(const circuit::Compiled& compiled, const SmallSignalInputs& inputs, const model::Network& network,
                                const engine::ExactModel& model, const steady::Trace& trace, double period, bool is_driven) {
  const SmallSignal& card = *compiled.analyses.small_signal;
  steady::LinearisedOrbit linear(model, trace, period, is_driven, inputs.names);
  const std::vector<int> unknown = linear.take_impulses(trace, is_driven);
  steady::Transfer transfer(linear, network.signals.size());
  const std::optional<double> sample = card.sample ? std::optional(std::fmod(*card.sample, period)) : std::nullopt;
  const bool is_duty = card.input == SmallSignal::Input::duty, is_timing = moves_edges(card);
  std::vector<steady::Wave> waves;
  std::vector<ModulatedSine> sines;
  const std::size_t moved = is_timing ? card.sources.size() : 0;
  for (std::size_t k = 0; k < moved; ++k) {
    const auto& function = network.sources[static_cast<std::size_t>(sources_named(network, card.sources[k]).front())].function;
    if (const auto* pulse = std::get_if<model::Pulse>(&function)) waves.push_back(moved_pulse(*pulse, is_duty, static_cast<int>(k)));
    if (const auto sine = modulated_sine(function, k, period)) sines.push_back(*sine);
  }
  const auto at = [&](double f, const std::vector<Complex>& amplitudes) {
    if (!is_timing) return transfer.at(f, card.harmonic, amplitudes, {}, sample).signals;
    std::vector<Complex> by;
    for (const steady::Wave& wave : waves) {
      const double own = std::get<model::Pulse>(wave.function).period;
      by.push_back(is_duty ? Complex(own) : -own / (Complex(0.0, 2.0 * std::numbers::pi) * f));
    }
    steady::ComplexVector sum = transfer.at(f, card.harmonic, amplitudes, shifts_of(linear, waves, by), sample).signals;
    for (const ModulatedSine& sine : sines) sum += response_of(sine, transfer, f, card.harmonic, moved, sample);
    return sum;
  };
  const auto response = [&](double f, const std::vector<Complex>& amplitudes) {
    const bool is_limit = f == 0.0 && !is_driven && !is_timing && card.harmonic == 0 && !sample;
    return is_limit ? limit_at_rest(period, [&](double near) { return at(near, amplitudes); }) : at(f, amplitudes);
  };
  SmallSignalResult result = evaluate(compiled, inputs, response);
  result.unknown_impulses = unknown;
  return result;
}

namespace {

/// What belongs to a period, "" where the card asks for nothing of the kind.
std::string periodic_part(const SmallSignal& card) {
  if (card.input == SmallSignal::Input::frequency) return "freq() modulates a period";
  if (card.input == SmallSignal::Input::duty) return "duty() modulates edges of a period";
  if (card.harmonic != 0) return "harm= is a sideband of a period";
  if (card.sample) return "sample= is a time of a period";
  return "";
}

}  // namespace

LinearSmallSignals::LinearSmallSignals(const circuit::Compiled& compiled) : compiled_(&compiled), network_(compiled.network) {
  const SmallSignal& card = *compiled.analyses.small_signal;
  inputs_ = add_small_signal_inputs(card, network_);
  Diagnostics diagnostics;
  model_ = engine::prepare(network_, diagnostics);
  if (!model_) return;
  const auto& islands = model_->islands;
  const auto switching =
      std::find_if(islands.begin(), islands.end(), [](const engine::IslandModel& island) { return island.extraction.system.ports > 0; });
  const std::string part = periodic_part(card);
  if (switching != islands.end())
    fail("E-ac-needs-pss", fmt::format("{} switches: small signals are those around a periodic steady state; try .pss",
                                       switching->extraction.system.port.front().name));
  else if (inputs_.id.empty() && !part.empty())
    fail("E-ac-needs-pss", part + ", and the deck has none; try .pss");
  else
    fail(inputs_.id, inputs_.message);
}

void LinearSmallSignals::fail(std::string id, std::string message) {
  id_ = std::move(id);
  message_ = std::move(message);
}

SmallSignalResult LinearSmallSignals::result() const {
  if (!id_.empty() || !model_) return {};
  engine::March march(*model_, {});
  engine::RunState state = engine::start_from_initial_values(*model_);
  steady::TraceRecorder recorder(state.on);
  constexpr double moment = 1e-12;  // s: the one mode there is
  march.advance(state, moment, &recorder);
  const steady::LinearisedOrbit linear(*model_, recorder.take(), moment, true, inputs_.names);
  return evaluate(*compiled_, inputs_, [&](double f, const std::vector<Complex>& amplitudes) {
    return steady::linear_response(linear, network_.signals.size(), f, amplitudes);
  });
}

std::string small_signal_problem_of_orbit(const circuit::Compiled& compiled, std::string& id) {
  model::Network network = compiled.network;
  SmallSignalInputs inputs = add_small_signal_inputs(*compiled.analyses.small_signal, network);
  id = std::move(inputs.id);
  return std::move(inputs.message);
}

void leave_out_impulsive(const circuit::Compiled& compiled, const std::vector<int>& signals, SmallSignalResult& result) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  SmallSignalResult names;
  names.signals = result.signals;
  const std::vector<Selection> selected = select_columns(compiled, names);
  for (const int signal : signals) {
    const auto number = static_cast<std::size_t>(signal);
    const auto is_column = [&](const Selection& column) { return column.signal == number; };
    if (number >= result.signals.size() && std::none_of(selected.begin(), selected.end(), is_column)) continue;
    result.impulsive.push_back(compiled.network.signals[number].name);
    for (auto& row : result.values)
      if (number < row.size()) row[number] = {unknown, unknown};
    for (std::size_t k = 0; k < selected.size(); ++k)
      if (selected[k].signal == number) std::fill(result.columns[k].values.begin(), result.columns[k].values.end(), unknown);
  }
}

std::string impulsive_text(const std::vector<std::string>& signals, const std::string& where) {
  return fmt::format("no response of {}{}: the orbit has impulses there, which the input changes; try a small resistance in their path",
                     fmt::join(signals, ", "), where);
}

std::vector<std::string> small_signal_columns(const circuit::Compiled& compiled) {
  SmallSignalResult result;
  for (std::size_t k = 0; k < compiled.saved_signals(); ++k) result.signals.push_back(compiled.network.signals[k].name);
  (void)select_columns(compiled, result);
  std::vector<std::string> names{"frequency"};
  for (SmallSignalResult::Column& column : result.columns) names.push_back(std::move(column.name));
  return names;
}

std::string small_signal_csv(const SmallSignalResult& result) {
  std::string text = "frequency";
  for (const SmallSignalResult::Column& column : result.columns) text += ',' + waveform::csv_field(column.name);
  return text + '\n' + small_signal_rows(result);
}

std::string small_signal_rows(const SmallSignalResult& result, const std::string& prefix) {
  std::string text;
  for (std::size_t k = 0; k < result.frequencies.size(); ++k) {
    text += fmt::format("{}{}", prefix, result.frequencies[k]);
    for (const SmallSignalResult::Column& column : result.columns) {
      text += ',';
      if (std::isfinite(column.values[k])) text += fmt::format("{}", column.values[k]);
    }
    text += '\n';
  }
  return text;
}

std::string small_signal_summary(const SmallSignalResult& result, const std::string& file) {
  std::string text = fmt::format("ac response in {}: {} from {} to {}", file, counted(result.frequencies.size(), "point"),
                                 quantity(result.frequencies.front(), "Hz"), quantity(result.frequencies.back(), "Hz"));
  if (result.loop) {
    for (const auto& at : result.loop->crossovers)
      text += fmt::format("; crossover at {} with a phase margin of {:.4g} degrees", quantity(at.frequency, "Hz", 4), at.phase_margin);
    for (const auto& at : result.loop->gain_margins)
      text += fmt::format("; gain margin {:.4g} dB at {}", at.decibels, quantity(at.frequency, "Hz", 4));
  }
  return text + '\n';
}

void write_small_signals(JsonWriter& json, const SmallSignalResult* result) {
  if (result == nullptr) return json.member("ac", "null");
  const auto list_of = [&](const auto& numbers) {
    std::vector<std::string> list;
    for (const auto& number : numbers) list.push_back(json_number(number));
    return json_line(list);
  };
  const auto parts_of = [&](const auto& value_at, std::size_t count, double (*part)(const Complex&)) {
    std::vector<double> numbers;
    for (std::size_t k = 0; k < count; ++k) numbers.push_back(part(value_at(k)));
    return list_of(numbers);
  };
  const auto real = [](const Complex& c) { return c.real(); };
  const auto imaginary = [](const Complex& c) { return c.imag(); };
  json.key("ac");
  json.begin_object();
  json.member("frequencies", list_of(result->frequencies));
  json.key("signals");
  json.begin_array();
  for (std::size_t s = 0; s < result->signals.size(); ++s) {
    const auto at = [&](std::size_t k) { return result->values[k][s]; };
    json.value(json_line({{"name", json_string(result->signals[s])},
                          {"re", parts_of(at, result->frequencies.size(), real)},
                          {"im", parts_of(at, result->frequencies.size(), imaginary)}}));
  }
  json.end_array();
  json.key("loops");
  json.begin_array();
  if (result->loop) {
    const LoopGain& loop = *result->loop;
    const auto at = [&](std::size_t k) { return loop.values[k]; };
    std::vector<std::string> crossovers, margins;
    for (const auto& c : loop.crossovers)
      crossovers.push_back(json_line({{"frequency", json_number(c.frequency)}, {"phase_margin", json_number(c.phase_margin)}}));
    for (const auto& m : loop.gain_margins)
      margins.push_back(json_line({{"frequency", json_number(m.frequency)}, {"decibels", json_number(m.decibels)}}));
    json.value(json_line({{"source", json_string(loop.source)},
                          {"re", parts_of(at, loop.values.size(), real)},
                          {"im", parts_of(at, loop.values.size(), imaginary)},
                          {"crossovers", json_line(crossovers)},
                          {"gain_margins", json_line(margins)}}));
  }
  json.end_array();
  json.end_object();
}

}  // namespace pwlsim::analysis
