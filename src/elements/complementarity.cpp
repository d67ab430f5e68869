#include "elements/complementarity.hpp"

#include "elements/source_step.hpp"

namespace pwlsim::elements {

using model::LinearForm;

using model::NetworkMove;

LinearForm add_positive_part(Emission& emission, const MovingForm& x) {
  const auto index = static_cast<int>(emission.builder().network().complementarities.size());
  const LinearForm input = quantity(Quantity::slack_input, index);
  MovingForm slack(input);
  accumulate(slack, x, -1.0);
  emission.builder().add(model::Complementarity{emission.label(), std::move(slack.form)});
  add_moves(emission.builder(), NetworkMove::Item::slack_form, index, slack.moved);
  return input;
}

LinearForm add_step(Emission& emission, const MovingForm& x, double at_zero) {
  if (x.moved.empty())
    if (const std::optional<LinearForm> step = step_of_source(emission, x.form, at_zero)) return *step;
  const auto lambda = static_cast<int>(emission.builder().network().complementarities.size());
  LinearForm slack = x.form;
  slack.push_back({Quantity::slack_input, lambda + 1, 1.0});
  emission.builder().add(model::Complementarity{emission.label(), std::move(slack)});
  add_moves(emission.builder(), NetworkMove::Item::slack_form, lambda, x.moved);
  LinearForm step{model::constant(1.0), {Quantity::slack_input, lambda, -1.0}};
  emission.builder().add(model::Complementarity{emission.label(), step});
  emission.builder().add(model::Step{lambda, x.form, at_zero});
  return step;
}

/// below + v(chosen): an inner node that one contact ties to the difference of the two values, the other to ground.
MovingForm add_choice(model::NetworkBuilder& builder, const model::Label& label, const ChoiceCondition& choice, const MovingForm& above,
                      const MovingForm& below) {
  const auto inner_node = [&](const char* part) { return builder.inner_node({label.name + " (" + part + ")", label.span}); };
  const model::NodeIndex difference = inner_node("difference");
  const model::NodeIndex chosen = inner_node("choice");
  MovingForm voltage = above;
  accumulate(voltage, below, -1.0);
  const int branch = builder.add(model::Branch{label, difference, model::ground, std::move(voltage.form)});
  add_moves(builder, NetworkMove::Item::branch_form, branch, voltage.moved);
  model::Switch contact;
  contact.label = label;
  contact.p = chosen;
  contact.n = difference;
  contact.control = choice.control.form;
  contact.on_level = choice.on_level.value;
  contact.off_level = choice.off_level.value;
  const auto add = [&] {
    const int index = builder.add(contact);
    add_moves(builder, NetworkMove::Item::control_form, index, choice.control.moved);
    add_moves(builder, NetworkMove::Item::on_level, index, choice.on_level);
    add_moves(builder, NetworkMove::Item::off_level, index, choice.off_level);
  };
  add();
  contact.n = model::ground;
  contact.inverted = true;
  add();
  MovingForm value = below;
  accumulate(value, model::voltage_between(chosen, model::ground));
  return value;
}

}  // namespace pwlsim::elements
