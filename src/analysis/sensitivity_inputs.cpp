#include "analysis/sensitivity_inputs.hpp"

#include <fmt/format.h>

#include <optional>

#include "steady/wave.hpp"

namespace pwlsim::analysis {

steady::SensitivityInputs add_inputs(const circuit::SensitivityAnalysis& card, const model::Network& original, model::Network& network) {
  std::vector<model::NetworkMoves> moves;
  for (const circuit::SensitivityAnalysis::Parameter& parameter : card.parameters)
    moves.push_back(parameter.failure.empty() ? parameter.moves : model::NetworkMoves());
  steady::SensitivityInputs inputs = steady::add_parameter_inputs(network, moves);
  for (std::size_t p = 0; p < card.parameters.size(); ++p) {
    steady::ParameterInputs& own = inputs.parameters[p];
    own.value = card.parameters[p].value;
    if (!card.parameters[p].failure.empty()) own.failure = card.parameters[p].failure;
    // Of a source that has always been periodic the function is that of the deck all the same.
    for (steady::Wave& wave : own.waves) {
      if (wave.source < 0) continue;
      const model::Source& source = original.sources[static_cast<std::size_t>(wave.source)];
      const bool is_settled = source.function.index() != wave.function.index();
      wave.function = source.function;
      if (!is_settled) continue;
      const std::optional<double> last = steady::last_value_derivative(wave);
      if (!last && own.failure.empty()) own.failure = fmt::format("{} is not periodic", source.label.name);
      wave.function = model::Dc{};
      wave.derivative = model::Dc{last.value_or(0.0)};
    }
  }
  return inputs;
}

}  // namespace pwlsim::analysis
