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
  emission.builder().add(model::Step{lambda, x, at_zero});
  return step;
}

/// below + v(chosen): an inner node that one contact ties to the difference of the two values, the other to ground.
LinearForm add_choice(model::Builder& builder, const model::Label& label, const Choice& choice, const LinearForm& above,
                      const LinearForm& below) {
  const auto inner_node = [&](const char* part) { return builder.inner_node({label.name + " (" + part + ")", label.span}); };
  const model::NodeIndex difference = inner_node("difference");
  const model::NodeIndex chosen = inner_node("choice");
  LinearForm voltage = above;
  model::accumulate(voltage, below, -1.0);
  builder.add(model::Branch{label, difference, model::ground, std::move(voltage)});
  model::Switch contact;
  contact.label = label;
  contact.p = chosen;
  contact.n = difference;
  contact.control = choice.control;
  contact.on_level = choice.on_level;
  contact.off_level = choice.off_level;
  builder.add(contact);
  contact.n = model::ground;
  contact.inverted = true;
  builder.add(contact);
  LinearForm value = below;
  model::accumulate(value, model::voltage_between(chosen, model::ground));
  return value;
}

}  // namespace pwlsim::elements
