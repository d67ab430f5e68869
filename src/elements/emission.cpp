#include "elements/emission.hpp"

namespace pwlsim::elements {

SourceSpan Emission::span_of(std::string_view parameter) const {
  const SourceSpan span = instance().values.span(parameter);
  return span.known() ? span : instance().span;
}

model::Label Emission::label(std::string_view part) const {
  std::string name = instance().name;
  if (!part.empty()) name.append(" (").append(part).append(")");
  return {std::move(name), instance().span};
}

void Emission::mark_followed() {
  for (const Instance& instance : instances_)
    for (const Reference& reference : instance.references) followed_[static_cast<std::size_t>(reference.index)] = 1;
}

model::LinearForm voltage_control(const Instance& instance) {
  model::LinearForm form;
  if (instance.coefficients[0] != 0.0) form.push_back(model::constant(instance.coefficients[0]));
  for (std::size_t k = 0; k < instance.control_nodes.size(); ++k) {
    const NodePair& pair = instance.control_nodes[k];
    model::accumulate(form, model::voltage_between(pair.p, pair.n, instance.coefficients[k + 1]));
  }
  return form;
}

model::LinearForm current_control(const Emission& emission) {
  const Instance& instance = emission.instance();
  model::LinearForm form;
  if (instance.coefficients[0] != 0.0) form.push_back(model::constant(instance.coefficients[0]));
  for (std::size_t k = 0; k < instance.references.size(); ++k) {
    model::accumulate(form, emission.referenced_result(k).current, instance.coefficients[k + 1]);
  }
  return form;
}

model::LinearForm add_source(Emission& emission) {
  const model::SourceFunction function = emission.instance().waveform.value_or(model::Dc{});
  const int source = emission.builder().add(model::Source{emission.label(), function, false, emission.instance().alternating});
  return quantity(Quantity::source, source);
}

}  // namespace pwlsim::elements
