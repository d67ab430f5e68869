#include "model/moved_network.hpp"

#include <cmath>

namespace pwlsim::model {
namespace {

using Item = NetworkMove::Item;

/// Numbers that are infinite stay so.
void add(double& sum, double other, double factor) {
  if (std::isfinite(sum) && std::isfinite(other)) sum += factor * other;
}

double* number_of(Network& network, const NetworkMove& move) {
  const auto at = static_cast<std::size_t>(move.index);
  switch (move.item) {
    case Item::resistance:
      return &network.resistors[at].resistance;
    case Item::capacitance:
      return &network.capacitors[at].capacitance;
    case Item::inductance:
      return &network.inductors[at].inductance;
    case Item::coupling:
      return &network.couplings[at].coefficient;
    case Item::diode_drop:
      return &network.diodes[at].drop;
    case Item::diode_resistance:
      return &network.diodes[at].resistance;
    case Item::switch_drop:
      return &network.switches[at].drop;
    case Item::switch_resistance:
      return &network.switches[at].resistance;
    case Item::on_level:
      return &network.switches[at].on_level;
    case Item::off_level:
      return &network.switches[at].off_level;
    case Item::initial_voltage:
      return &network.capacitors[at].initial_voltage;
    case Item::initial_current:
      return &network.inductors[at].initial_current;
    case Item::node_condition:
      return &network.node_conditions[at].voltage;
    case Item::current_condition:
      return &network.current_conditions[at].current;
    default:
      break;
  }
  return nullptr;
}

LinearForm* form_of(Network& network, const NetworkMove& move) {
  const auto at = static_cast<std::size_t>(move.index);
  switch (move.item) {
    case Item::branch_form:
      return &network.branches[at].voltage;
    case Item::injection_form:
      return &network.injections[at].current;
    case Item::slack_form:
      return &network.complementarities[at].slack;
    case Item::control_form:
      return &network.switches[at].control;
    case Item::signal_form:
      return at < network.signals.size() ? &network.signals[at].form : nullptr;
    default:
      break;
  }
  return nullptr;
}

}  // namespace

void add(SourceFunction& sum, const SourceFunction& other, double factor) {
  if (auto* dc = std::get_if<Dc>(&sum)) add(dc->value, std::get<Dc>(other).value, factor);
  if (auto* f = std::get_if<Pulse>(&sum))
    for (const auto member : {&Pulse::initial, &Pulse::pulsed, &Pulse::delay, &Pulse::rise, &Pulse::fall, &Pulse::width, &Pulse::period})
      add(f->*member, std::get<Pulse>(other).*member, factor);
  if (auto* f = std::get_if<Sin>(&sum))
    for (const auto member : {&Sin::offset, &Sin::amplitude, &Sin::frequency, &Sin::delay, &Sin::damping, &Sin::phase})
      add(f->*member, std::get<Sin>(other).*member, factor);
  if (auto* f = std::get_if<Pwl>(&sum)) {
    const auto& o = std::get<Pwl>(other);
    for (std::size_t k = 0; k < f->points.size(); ++k) {
      add(f->points[k].time, o.points[k].time, factor);
      add(f->points[k].value, o.points[k].value, factor);
    }
    add(f->repeat_from, o.repeat_from, factor);
  }
}

void move(Network& network, const NetworkMoves& moves, double by) {
  for (const NetworkMove& each : moves) {
    if (each.item == Item::source)
      add(network.sources[static_cast<std::size_t>(each.index)].function, *each.function, by);
    else if (LinearForm* form = form_of(network, each))
      for (Term term : each.form) {
        term.coefficient *= by;
        form->push_back(term);
      }
    else
      add(*number_of(network, each), each.derivative, by);
    if (each.item != Item::current_condition) continue;
    const CurrentCondition& condition = network.current_conditions[static_cast<std::size_t>(each.index)];
    network.inductors[static_cast<std::size_t>(condition.inductor)].initial_current = condition.current;
  }
}

}  // namespace pwlsim::model
