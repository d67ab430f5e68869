#include "elements/block.hpp"
#include "elements/formula_emission.hpp"
#include "elements/twin.hpp"

namespace pwlsim::elements::kinds::block {
namespace {

constexpr const ModelKind* models[] = {&gain_model,     &summer_model,   &limit_model,      &hyst_model,     &pwl_model,       &relay_model,
                                       &deadzone_model, &friction_model, &integrator_model, &transfer_model, &derivative_model};

void emit(Emission& emission) { add_formula_source(emission, emission.instance().formula_is_current); }

model::LinearForm read(Emission& emission, const BlockInput& input) {
  if (!input.is_current) return model::voltage_between(input.nodes.p, input.nodes.n);
  if (input.reference >= 0) return emission.referenced_result(static_cast<std::size_t>(input.reference)).current;
  const int meter = emission.builder().add(model::Branch{emission.label("input"), input.nodes.p, input.nodes.n, {}});
  return quantity(Quantity::branch_current, meter);
}

MovingForm output_of(Emission& emission) {
  const BlockKind& block = *emission.model().kind->block;
  std::vector<model::LinearForm> inputs;
  for (const BlockInput& input : emission.instance().inputs) inputs.push_back(read(emission, input));
  if (block.dynamics != nullptr) return block.dynamics(emission, inputs[0]);
  FormulaBuilder builder;
  std::vector<AffineSum> sums;
  for (std::size_t k = 0; k < inputs.size(); ++k) sums.push_back(builder.voltage(static_cast<int>(k)));
  AffineSum value = block.law(builder, VariedValues(emission.model()), sums);
  const Formula formula = std::move(builder).finish(std::move(value));
  return emit_formula(emission, formula, [&](const FormulaPart& part) { return inputs[static_cast<std::size_t>(part.index)]; });
}

void connect(Emission& emission) {
  const bool is_current = emission.instance().formula_is_current;
  set_source_value(emission, output_of(emission), is_current);
}

}  // namespace

Kind kind() {
  Kind kind;
  kind.name = "block";
  kind.letter = 'A';
  kind.usage =
      "A<name> input | [inputs] output model, each port node | %v node | %vd(p,n) | %i node | %id(p,n), an input also %vnam element";
  kind.text = "A block of XSPICE, or a relay, a dead zone, friction: depending on the type of its model.";
  kind.tail = Tail::block;
  kind.models = models;
  kind.joins_terminals = is_voltage_formula;
  kind.emit = emit;
  kind.connect = connect;
  kind.smooth_twin = twin_of_block;
  return kind;
}

}  // namespace pwlsim::elements::kinds::block
