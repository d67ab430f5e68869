// The periodic steady state and small signals, for programs.

#include <pwlsim/circuit.hpp>

#include <fmt/format.h>

#include <utility>

#include "analysis/orbit_verdict.hpp"
#include "analysis/small_signal.hpp"
#include "analysis/steady_state.hpp"
#include "api/compilation.hpp"
#include "api/finished_run.hpp"
#include "api/messages.hpp"

namespace pwlsim {
namespace {

std::string card_of(const SteadyStateOptions& what) {
  std::string text = ".pss";
  if (what.period) text += fmt::format(" period={}", Value(*what.period).text());
  if (what.multiple) text += fmt::format(" k={}", *what.multiple);
  if (!what.begins.empty()) text += " " + what.begins;
  if (what.settling_time) text += fmt::format(" tstab={}", Value(*what.settling_time).text());
  if (what.points) text += fmt::format(" points={}", *what.points);
  if (what.use_initial_conditions) text += " uic";
  return text + "\n";
}

std::string card_of(const std::vector<double>& frequencies, const SmallSignalOptions& what) {
  std::string text = ".ac list";
  for (const double f : frequencies) text += " " + Value(f).text();
  if (!what.from.empty()) text += " from=" + what.from;
  if (!what.loop.empty()) text += " loop=" + what.loop;
  if (what.harmonic != 0) text += fmt::format(" harm={}", what.harmonic);
  if (what.sample) text += fmt::format(" sample={}", Value(*what.sample).text());
  return text + "\n";
}

/// A deck that has `.pss` keeps it where nothing else is asked for.
Compilation with_cards(const Circuit& circuit, const SteadyStateOptions& what, Options options, const std::string& more) {
  options.stop = 0.0;
  Compilation::Wanted wanted;
  wanted.replaced = {".tran"};
  wanted.cards = more;
  if (!more.empty()) wanted.replaced.emplace_back(".ac");
  if (what.is_empty() && Compilation(circuit, options, {}).compiled().analyses.steady_state) return {circuit, options, wanted};
  wanted.replaced.emplace_back(".pss");
  wanted.cards += card_of(what);
  return {circuit, options, wanted};
}

[[noreturn]] void refuse(const std::shared_ptr<Result::Data>& data, std::string id, std::string message) {
  data->messages.push_back(api::message_of({Severity::error, std::move(id), {}, std::move(message)}));
  throw RunError(Result(data));
}

[[noreturn]] void refuse_controllers() {
  throw api::error("E-controller", "a circuit with controllers has no steady state and no small signals here; try a long run");
}

struct FoundOrbit {
  std::shared_ptr<Result::Data> data;
  circuit::Compiled compiled;
  analysis::SteadyState state;
  std::vector<analysis::Idealisation> departures;
};

FoundOrbit find_orbit(Compilation& compilation, const Options& options) {
  if (compilation.has_controllers()) refuse_controllers();
  static const std::atomic<int> never = 0;
  const analysis::PreparedEngine engine = compilation.engine(options);
  FoundOrbit found{api::begin_result(compilation, engine), {}, {}, compilation.departures()};
  found.compiled = compilation.take();
  const analysis::EngineChoice choice = api::choice_of(options.engine);
  if (!analysis::has_orbit_engine(found.compiled, choice)) refuse(found.data, "E-pss-engine", analysis::orbit_needs_exact_engine);
  found.state = analysis::find_steady_state(found.compiled, choice, options.interrupt != nullptr ? *options.interrupt : never);
  for (const Diagnostic& message : found.state.messages) found.data->messages.push_back(api::message_of(message));
  if (!found.state.is_found) refuse(found.data, found.state.id, found.state.message);
  return found;
}

Response response_of(const analysis::SmallSignalResult& from, std::vector<Message> messages) {
  Response response{from.frequencies, from.signals, {}, {}, std::move(messages)};
  response.values.resize(from.signals.size());
  for (std::size_t k = 0; k < from.signals.size(); ++k)
    for (const auto& row : from.values) response.values[k].push_back(row[k]);
  if (!from.impulsive.empty()) {
    const std::string text = analysis::impulsive_text(from.impulsive);
    response.messages.push_back({Message::Kind::warning, "W-ac-impulse", text, "warning[W-ac-impulse]: " + text + '\n'});
  }
  if (!from.loop) return response;
  LoopGain& loop = response.loop.emplace();
  loop.values = from.loop->values;
  for (const auto& each : from.loop->crossovers) loop.crossovers.push_back({each.frequency, each.phase_margin});
  for (const auto& each : from.loop->gain_margins) loop.gain_margins.push_back({each.frequency, each.decibels});
  return response;
}

}  // namespace

SteadyState Circuit::steady_state(const SteadyStateOptions& what, const Options& options) const {
  Compilation compilation = with_cards(*this, what, options, "");
  FoundOrbit found = find_orbit(compilation, options);
  const steady::Orbit& orbit = found.state.orbit;
  SteadyState result{orbit.period,
                     found.state.multiple,
                     !found.state.common.sources.empty(),
                     analysis::stability_of(orbit),
                     orbit.residual,
                     orbit.iterations,
                     orbit.periods_simulated,
                     {},
                     {},
                     Result(found.data)};
  for (const steady::Multiplier& each : orbit.multipliers) result.multipliers.push_back(each.value);
  for (const analysis::NamedState& each : found.state.states) result.states.emplace_back(each.name, each.value);
  const double longest_window = analysis::most_periods_measured * orbit.period;
  const auto kept = std::make_shared<const KeptRun>(
      KeptRun{std::make_shared<const circuit::Compiled>(found.state.compiled), found.state.simulate, std::move(found.departures)});
  if (!api::run_into(*found.data, kept, options, nullptr, longest_window)) throw RunError(Result(found.data));
  return result;
}

Response Circuit::small_signals(const std::vector<double>& frequencies, const SmallSignalOptions& what, const SteadyStateOptions& around,
                                const Options& options) const {
  const std::string card = card_of(frequencies, what);
  if (!controllers_.empty()) refuse_controllers();
  if (around.is_empty()) {
    Options alone = options;
    alone.stop = 0.0;
    const Compilation linear(*this, alone, {.cards = card, .replaced = {".tran", ".ac"}});
    if (!linear.compiled().analyses.steady_state) {
      const analysis::LinearSmallSignals prepared(linear.compiled());
      if (prepared.id().empty()) return response_of(prepared.result(), linear.messages());
      if (prepared.id() != "E-ac-needs-pss") throw api::error(prepared.id(), prepared.message());
    }
  }
  Compilation compilation = with_cards(*this, around, options, card);
  FoundOrbit found = find_orbit(compilation, options);
  if (found.state.map) throw api::error("E-pss-engine", analysis::response_needs_modes);
  if (!found.state.inputs->id.empty()) throw api::error(found.state.inputs->id, found.state.inputs->message);
  if (!found.state.orbit.kink.empty()) throw api::error("E-ac-no-derivative", "the orbit has no derivative: " + found.state.orbit.kink);
  const analysis::SmallSignalResult result = analysis::small_signals(found.compiled, found.state);
  if (result.is_beyond_derivatives) throw api::error("E-ac-no-derivative", analysis::beyond_derivatives);
  return response_of(result, found.data->messages);
}

}  // namespace pwlsim
