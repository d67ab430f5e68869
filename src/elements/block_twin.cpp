/// Blocks for ngspice: those without memory as expressions, states as voltages of 1 F that B sources drive.
#include <cmath>

#include <fmt/format.h>

#include "elements/block.hpp"

namespace pwlsim::elements {
namespace {

std::string voltage_of(const std::string& node) { return fmt::format("v({})", node); }

/// An inner node with 1 F to ground.
std::string add_state(Twin& twin, const std::string& part, double start) {
  const std::string node = twin.inner(part);
  twin.capacitor(part, {node, "0"}, 1.0);
  twin.start_voltage(node, start);
  return node;
}

/// A diode that lets the state past `bound` by its voltage drop only; sign 1: a lower bound.
void add_stop(Twin& twin, const std::string& part, const std::string& state, double bound, double sign) {
  if (std::isinf(bound)) return;
  const std::string at = twin.inner(part);
  twin.source(part, {at, "0"}, false, model::Dc{bound});
  twin.diode(part, sign > 0.0 ? TwinEnds{at, state} : TwinEnds{state, at}, {});
}

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

std::string law_text(Twin& twin, const Block& block, const std::vector<std::string>& inputs) {
  FormulaBuilder builder;
  std::vector<AffineSum> sums;
  for (std::size_t k = 0; k < inputs.size(); ++k) sums.push_back(builder.voltage(static_cast<int>(k)));
  AffineSum value = block.law(builder, twin.model().values, sums);
  return formula_text(twin, std::move(builder).finish(std::move(value)), inputs, {});
}

}  // namespace

std::string smooth_integrator(Twin& twin, const std::string& input) {
  const Values& v = twin.model().values;
  const std::string state = add_state(twin, "state", v.get("out_ic"));
  twin.behaviour("rate", {"0", state}, true, fmt::format("{}*(({})+{})", v.get("gain"), input, v.get("in_offset")));
  add_stop(twin, "least", state, v.get("out_lower_limit"), 1.0);
  add_stop(twin, "most", state, v.get("out_upper_limit"), -1.0);
  return voltage_of(state);
}

std::string smooth_derivative(Twin& twin, const std::string& input) {
  const Values& v = twin.model().values;
  const std::string node = twin.inner("input"), foot = twin.inner("foot");
  twin.behaviour("input", {node, "0"}, false, input);
  twin.capacitor("state", {node, foot}, 1.0);
  twin.short_circuit("rate", {foot, "0"});
  const std::string rate = fmt::format("{}*{}+{}", v.get("gain"), current_text(twin.device('V', "rate")), v.get("out_offset"));
  return limited(twin, rate, v.get("out_lower_limit"), v.get("out_upper_limit"));
}

/// The states of `transfer`: x_k' = rate·x_{k+1}, x_n' = rate·(u − Σ a_k x_{k+1}).
std::string smooth_transfer(Twin& twin, const std::string& input) {
  const Values& v = twin.model().values;
  const auto [rate, num, den] = canonical_form(v);
  const std::size_t order = den.size() - 1;
  std::vector<std::string> state;
  for (std::size_t k = 0; k < order; ++k) state.push_back(add_state(twin, fmt::format("state{}", k + 1), 0.0));
  std::string highest = fmt::format("{}*(({})+{})", v.get("gain") / den[order], input, v.get("in_offset"));
  for (std::size_t k = 0; k < order; ++k) highest += term_text(-den[k] / den[order], voltage_of(state[k]));
  const std::string top = twin.inner("highest");
  twin.behaviour("highest", {top, "0"}, false, highest);
  state.push_back(top);
  std::string output = fmt::format("{}", v.get("out_offset"));
  for (std::size_t k = 0; k <= order; ++k) {
    if (k < order)
      twin.behaviour(fmt::format("rate{}", k + 1), {"0", state[k]}, true,
                     fmt::format("{}*{}", rate * v.get("denormalized_freq"), voltage_of(state[k + 1])));
    output += term_text(num[k], voltage_of(state[k]));
  }
  return output;
}

void twin_of_block(Twin& twin) {
  const Block& block = *twin.model().kind->block;
  std::vector<std::string> inputs;
  for (const BlockInput& input : twin.instance().inputs) inputs.push_back(read(twin, input, inputs.size()));
  const std::string output = block.law != nullptr ? law_text(twin, block, inputs) : block.smooth_dynamics(twin, inputs[0]);
  twin.behaviour({}, twin.ends(), twin.instance().formula_is_current, output);
}

}  // namespace pwlsim::elements
