/// Blocks for ngspice: as expressions of their inputs and of states.
#include <cmath>

#include <fmt/format.h>

#include "elements/block.hpp"

namespace pwlsim::elements {
namespace {

std::string limited(Twin& twin, std::string text, double least, double most) {
  if (!std::isinf(least)) text = fmt::format("{}+{}", least, twin.positive("least", fmt::format("({})-({})", text, least)));
  if (!std::isinf(most)) text = fmt::format("{}-{}", most, twin.positive("most", fmt::format("{}-({})", most, text)));
  return text;
}

std::string read(Twin& twin, const BlockInput& input, std::size_t k) {
  const TwinEnds ends{twin.node(input.nodes.p), twin.node(input.nodes.n)};
  if (!input.is_current) return voltage_text(ends);
  if (input.reference >= 0) return current_text(twin.meter_of(twin.instance().references[static_cast<std::size_t>(input.reference)]));
  const std::string part = fmt::format("input{}", k + 1);
  twin.short_circuit(part, ends);
  return current_text(twin.device('V', part));
}

std::string law_text(Twin& twin, const BlockKind& block, const std::vector<std::string>& inputs) {
  FormulaBuilder builder;
  std::vector<AffineSum> sums;
  for (std::size_t k = 0; k < inputs.size(); ++k) sums.push_back(builder.voltage(static_cast<int>(k)));
  AffineSum value = block.law(builder, VariedValues(twin.model()), sums);
  return formula_text(twin, std::move(builder).finish(std::move(value)), inputs, {});
}

}  // namespace

std::string smooth_integrator(Twin& twin, const std::string& input) {
  const Values& v = twin.model().values;
  return twin_integral(twin, {}, fmt::format("{}*(({})+{})", v.get("gain"), input, v.get("in_offset")), integral_of(v));
}

std::string smooth_derivative(Twin& twin, const std::string& input) {
  const Values& v = twin.model().values;
  const std::string rate = fmt::format("{}*{}+{}", v.get("gain"), twin_derivative(twin, {}, input), v.get("out_offset"));
  return limited(twin, rate, v.get("out_lower_limit"), v.get("out_upper_limit"));
}

std::string smooth_transfer(Twin& twin, const std::string& input) {
  const Values& v = twin.model().values;
  const std::string driven = fmt::format("{}*(({})+{})", v.get("gain"), input, v.get("in_offset"));
  return fmt::format("{}+{}", v.get("out_offset"), twin_transfer(twin, {}, rational_function_of(v), v.get("denormalized_freq"), driven));
}

void twin_of_block(Twin& twin) {
  const BlockKind& block = *twin.model().kind->block;
  std::vector<std::string> inputs;
  for (const BlockInput& input : twin.instance().inputs) inputs.push_back(read(twin, input, inputs.size()));
  const std::string output = block.law != nullptr ? law_text(twin, block, inputs) : block.smooth_dynamics(twin, inputs[0]);
  twin.behaviour({}, twin.ends(), twin.instance().formula_is_current, output);
}

}  // namespace pwlsim::elements
