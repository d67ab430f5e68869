// Derivatives of measurements, for programs.

#include <pwlsim/circuit.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <utility>

#include "analysis/sensitivity.hpp"
#include "api/compilation.hpp"
#include "api/messages.hpp"

namespace pwlsim {
namespace {

std::string sens_card(const std::vector<std::string>& measurements, const std::vector<std::string>& parameters) {
  std::string text = fmt::format(".sens param={}", fmt::join(parameters, ","));
  if (!measurements.empty()) text += fmt::format(" meas={}", fmt::join(measurements, ","));
  return text + "\n";
}

Derivative derivative_of(const analysis::Derivative& from) {
  if (from.failure.empty()) return {from.parameter, from.value, from.normalised, from.left, from.right, from.kink, ""};
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return {from.parameter, none, none, none, none, "", from.failure};
}

/// Measurement by measurement, as the table is ordered.
std::vector<Gradient> gradients_of(const analysis::DerivativeTable& table, const std::vector<Message>& messages) {
  std::vector<Gradient> list;
  for (const analysis::Derivative& each : table) {
    if (list.empty() || list.back().measurement != each.measurement) list.push_back({each.measurement, each.measured, {}, messages});
    list.back().derivatives.push_back(derivative_of(each));
  }
  return list;
}

}  // namespace

std::vector<Gradient> Circuit::gradients(const std::vector<std::string>& measurements, const std::vector<std::string>& parameters,
                                         const Options& options) const {
  static const std::atomic<int> never = 0;
  const std::atomic<int>& interrupt = options.interrupt != nullptr ? *options.interrupt : never;
  Compilation compilation(*this, options,
                          {.analysis_required = true, .cards = sens_card(measurements, parameters), .replaced = {".sens", ".ac"}});
  if (compilation.has_controllers())
    throw api::error("E-controller", "a circuit with controllers has no derivatives; try differences of runs");
  const analysis::PreparedEngine engine = compilation.engine(options);
  if (!engine.has_modes) throw api::error("E-pss-engine", "only the exact engine has derivatives; try Engine::exact");
  std::vector<Message> messages = compilation.messages();
  const circuit::Compiled compiled = compilation.take();
  analysis::SteadyState state;
  const bool has_orbit = compiled.analyses.steady_state.has_value();
  if (has_orbit) {
    state = analysis::find_steady_state(compiled, analysis::EngineChoice::modes, interrupt);
    for (const Diagnostic& message : state.messages) messages.push_back(api::message_of(message));
    if (!state.is_found) {
      messages.push_back(api::message_of({Severity::error, state.id, {}, state.message}));
      throw Error(messages);
    }
  }
  return gradients_of(analysis::deck_derivatives(compiled, has_orbit ? &state : nullptr, true, interrupt), messages);
}

Gradient Circuit::gradient(std::string_view measurement, const std::vector<std::string>& parameters, const Options& options) const {
  std::vector<Gradient> list = gradients({std::string(measurement)}, parameters, options);
  if (list.empty()) throw api::error("E-sens-no-measurement", fmt::format("no .meas is called '{}'", measurement));
  return std::move(list.front());
}

}  // namespace pwlsim
