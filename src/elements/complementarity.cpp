#include "elements/complementarity.hpp"

#include "elements/source_step.hpp"

namespace pwlsim::elements {

using model::LinearForm;

LinearForm add_positive_part(Emission& emission, const LinearForm& x) {
  const auto index = static_cast<int>(emission.builder().network().complementarities.size());
  const LinearForm input = quantity(Quantity::slack_input, index);
  LinearForm slack = input;
  model::accumulate(slack, x, -1.0);
  emission.builder().add(model::Complementarity{emission.label(), std::move(slack)});
  return input;
}

LinearForm add_step(Emission& emission, const LinearForm& x, double at_zero) {
  if (const std::optional<LinearForm> step = step_of_source(emission, x, at_zero)) return *step;
  const auto lambda = static_cast<int>(emission.builder().network().complementarities.size());
  LinearForm slack = x;
  slack.push_back({Quantity::slack_input, lambda + 1, 1.0});
  emission.builder().add(model::Complementarity{emission.label(), std::move(slack)});
  LinearForm step{model::constant(1.0), {Quantity::slack_input, lambda, -1.0}};
  emission.builder().add(model::Complementarity{emission.label(), step});
  return step;
}

/// below + v(chosen): an inner node that one contact ties to the difference of the two values, the other to ground.
LinearForm add_choice(Emission& emission, const LinearForm& control, const Levels& levels, const LinearForm& above,
                      const LinearForm& below) {
  model::Builder& builder = emission.builder();
  const model::NodeIndex difference = emission.inner_node("difference");
  const model::NodeIndex chosen = emission.inner_node("choice");
  LinearForm voltage = above;
  model::accumulate(voltage, below, -1.0);
  builder.add(model::Branch{emission.label(), difference, model::ground, std::move(voltage)});
  model::Switch contact;
  contact.label = emission.label();
  contact.p = chosen;
  contact.n = difference;
  contact.control = control;
  contact.on_level = levels.on;
  contact.off_level = levels.off;
  builder.add(contact);
  contact.n = model::ground;
  contact.inverted = true;
  builder.add(contact);
  LinearForm value = below;
  model::accumulate(value, model::voltage_between(chosen, model::ground));
  return value;
}

}  // namespace pwlsim::elements
