#include "elements/dynamics.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pwlsim::elements {
namespace {

using model::LinearForm;
using Moved = model::NetworkMove::Item;

/// F, a power of two near a microfarad: with 1 F the energy of a state at hundreds of volts is so far above that of a converter's stores
/// that segments take these for rounding, and what a stop pushes so far above its currents.
constexpr double capacitance_of_state = 0x1p-20;

std::string name_of(std::string_view part, std::string_view role) { return fmt::format("{}{}{}", part, part.empty() ? "" : " ", role); }

/// An inner node with a capacitor to ground: its voltage is a state, whose derivative is what is injected, in units of the capacitance.
model::NodeIndex add_state(Emission& emission, std::string_view name) {
  const model::NodeIndex node = emission.inner_node(name);
  emission.builder().add(model::Capacitor{emission.label(), node, model::ground, capacitance_of_state, false, 0.0});
  return node;
}

void inject(Emission& emission, model::NodeIndex node, const MovingForm& current) {
  const int index = emission.builder().add(model::Injection{emission.label(), model::ground, node, current.form});
  add_moves(emission.builder(), Moved::injection_form, index, current.moved);
}

/// A stop for the state: an input u ≥ 0 in amperes pushes while sign·(state − bound) is 0.
void add_stop(Emission& emission, LinearForm& current, model::NodeIndex state, double bound, double sign) {
  if (std::isinf(bound)) return;
  LinearForm slack = model::voltage_between(state, model::ground, sign);
  slack.push_back(model::constant(-sign * bound));
  const int index = emission.builder().add(model::Complementarity{emission.label(), std::move(slack)});
  current.push_back({Quantity::slack_input, index, sign});
}

/// A switch that holds the state at a value.
void add_hold(Emission& emission, model::NodeIndex state, const Varied& value, const Hold& hold) {
  model::Switch item;
  item.label = emission.label();
  item.p = state;
  item.drop = value.value;
  item.control = hold.control.form;
  item.on_level = item.off_level = hold.level;
  const int index = emission.builder().add(std::move(item));
  add_moves(emission.builder(), Moved::switch_drop, index, value);
  add_moves(emission.builder(), Moved::control_form, index, hold.control.moved);
}

/// A switch at each end, closed for an instant, leads to the other. The lower one lies a little outside, so that rounding of an end is not beyond it.
void add_range(Emission& emission, model::NodeIndex state, double from, double to) {
  constexpr double margin = 1e-9;
  const double width = to - from, middle = from + 0.5 * width;
  const auto add_end = [&](double sign, double on, double value) {
    model::Switch item;
    item.label = emission.label();
    item.p = state;
    item.drop = value;
    item.control = model::voltage_between(state, model::ground, sign);
    item.on_level = on;
    item.off_level = sign * middle;
    emission.builder().add(std::move(item));
  };
  add_end(1.0, to, from);
  add_end(-1.0, -from + margin * width, to - margin * width);
}

/// Ascending powers of s, in units of `rate`.
std::vector<Varied> ascending(std::vector<Varied> list, double rate) {
  std::reverse(list.begin(), list.end());
  double power = 1.0;
  for (Varied& coefficient : list) {
    coefficient = power * coefficient;
    power *= rate;
  }
  return list;
}

/// The rate that makes the largest coefficient of the monic denominator one.
double rate_of(const std::vector<Varied>& descending) {
  double rate = 0.0;
  for (std::size_t k = 1; k < descending.size(); ++k)
    rate = std::max(rate, std::pow(std::abs(descending[k].value / descending[0].value), 1.0 / static_cast<double>(k)));
  return rate > 0.0 ? rate : 1.0;
}

}  // namespace

LinearForm add_integral(Emission& emission, std::string_view part, const MovingForm& input, const Integral& integral,
                        const Resets& resets) {
  const model::NodeIndex state = add_state(emission, name_of(part, "output"));
  auto& capacitors = emission.builder().network().capacitors;
  capacitors.back().has_initial = true;
  capacitors.back().initial_voltage = integral.start.value;
  const int condition = emission.builder().add(model::NodeCondition{emission.label(), state, integral.start.value});
  add_moves(emission.builder(), Moved::initial_voltage, static_cast<int>(capacitors.size()) - 1, integral.start);
  add_moves(emission.builder(), Moved::node_condition, condition, integral.start);
  MovingForm current = scaled(input, capacitance_of_state);
  add_stop(emission, current.form, state, integral.least, 1.0);
  add_stop(emission, current.form, state, integral.most, -1.0);
  if (resets.hold) add_hold(emission, state, integral.start, *resets.hold);
  if (resets.from != resets.to) add_range(emission, state, resets.from, resets.to);
  inject(emission, state, current);
  return model::voltage_between(state, model::ground);
}

LinearForm add_derivative(Emission& emission, std::string_view part, const MovingForm& input) {
  const model::NodeIndex node = emission.inner_node(name_of(part, "input"));
  const int branch = emission.builder().add(model::Branch{emission.label(), node, model::ground, input.form});
  add_moves(emission.builder(), Moved::branch_form, branch, input.moved);
  const int capacitor = emission.builder().add(model::Capacitor{emission.label(), node, model::ground, capacitance_of_state, false, 0.0});
  return {{Quantity::capacitor_current, capacitor, 1.0 / capacitance_of_state}};
}

CanonicalForm canonical_form(const RationalFunction& fraction) {
  const double rate = rate_of(fraction.den);
  CanonicalForm form{rate, ascending(fraction.num, rate), ascending(fraction.den, rate)};
  form.num.resize(form.den.size(), 0.0);
  // The states are of the size of the input then, whatever numbers the fraction is written with.
  const double lead = form.den.back().value;
  for (auto* list : {&form.num, &form.den})
    for (Varied& coefficient : *list) coefficient = coefficient / lead;
  return form;
}

/// Controllable canonical form in p = s/rate:  x_k' = rate·x_{k+1},  x_n' = rate·(u − Σ a_k x_{k+1}),  y = Σ b_k x_{k+1} + b_n·(…).
MovingForm add_transfer(Emission& emission, std::string_view part, const RationalFunction& fraction, double unit, const MovingForm& input) {
  const auto [rate, num, den] = canonical_form(fraction);
  const std::size_t order = den.size() - 1;
  MovingForm highest = scaled(input, 1.0 / den[order]);
  std::vector<MovingForm> state;
  std::vector<model::NodeIndex> node;
  for (std::size_t k = 0; k < order; ++k) {
    node.push_back(add_state(emission, name_of(part, fmt::format("state {}", k + 1))));
    state.emplace_back(model::voltage_between(node[k], model::ground));
    if (!den[k].is_nothing()) accumulate(highest, state[k], -den[k] / den[order]);
  }
  state.push_back(highest);
  MovingForm output;
  for (std::size_t k = 0; k <= order; ++k) {
    if (k < order) inject(emission, node[k], scaled(state[k + 1], capacitance_of_state * rate * unit));
    if (!num[k].is_nothing()) accumulate(output, state[k], num[k]);
  }
  return output;
}

}  // namespace pwlsim::elements
