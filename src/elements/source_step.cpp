#include "elements/source_step.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

namespace pwlsim::elements {
namespace {

using model::LinearForm;
using model::Term;

/// factor·(value of the source) + constant
struct Affine {
  int source = -1;
  double factor = 0.0, constant = 0.0;
};

/// The terms of a voltage that a source to ground holds; null where none does.
const LinearForm* held_voltage(const model::Network& network, model::NodeIndex node, double& sign) {
  for (const model::Branch& branch : network.branches) {
    if ((branch.p != node || branch.n != model::ground) && (branch.n != node || branch.p != model::ground)) continue;
    if (branch.voltage.empty() || !model::is_independent(branch.voltage)) return nullptr;
    sign = branch.p == node ? 1.0 : -1.0;
    return &branch.voltage;
  }
  return nullptr;
}

bool add_term(Affine& sum, const Term& term, double factor) {
  const double coefficient = factor * term.coefficient;
  if (term.kind == Quantity::one) {
    sum.constant += coefficient;
    return true;
  }
  if (term.kind != Quantity::source || (sum.source >= 0 && sum.source != term.index)) return false;
  sum.source = term.index;
  sum.factor += coefficient;
  return true;
}

std::optional<Affine> in_one_source(const model::Network& network, const LinearForm& x) {
  Affine sum;
  for (const Term& term : x) {
    if (term.kind != Quantity::node_voltage) {
      if (!add_term(sum, term, 1.0)) return std::nullopt;
      continue;
    }
    double sign = 1.0;
    const LinearForm* held = held_voltage(network, term.index, sign);
    if (held == nullptr) return std::nullopt;
    for (const Term& part : *held)
      if (!add_term(sum, part, sign * term.coefficient)) return std::nullopt;
  }
  return sum;
}

/// The source functions whose steps are known, as a function of time again.
struct StepOf {
  const Affine& x;
  double at_zero;

  [[nodiscard]] double at(double value) const { return x.factor * value + x.constant; }
  [[nodiscard]] double side(double margin) const { return margin > 0.0 ? 1.0 : (margin < 0.0 ? 0.0 : at_zero); }

  std::optional<model::SourceFunction> operator()(const model::Dc& dc) const { return model::Dc{side(at(dc.value))}; }

  std::optional<model::SourceFunction> operator()(const model::Pulse& pulse) const {
    const double low = at(pulse.initial), high = at(pulse.pulsed);
    if (low == high || low * high > 0.0) return model::Dc{side(low)};
    const bool is_cut = pulse.rise + pulse.width + pulse.fall > pulse.period;
    if (is_cut && pulse.period < model::forever) return std::nullopt;
    const double crossing = low / (low - high);  // fraction of the rise
    model::Pulse step = pulse;
    step.initial = side(low);
    step.pulsed = side(high);
    step.delay += crossing * pulse.rise;
    step.width += (1.0 - crossing) * (pulse.rise + pulse.fall);
    step.rise = step.fall = 0.0;
    return step;
  }

  std::optional<model::SourceFunction> operator()(const model::Pwl& pwl) const {
    model::Pwl step = pwl;
    step.points.clear();
    for (std::size_t k = 0; k + 1 < pwl.points.size(); ++k) {
      const auto &from = pwl.points[k], &to = pwl.points[k + 1];
      const double a = at(from.value), b = at(to.value);
      const double first = side(a != 0.0 ? a : b), second = side(b != 0.0 ? b : a);
      if (to.time == from.time) continue;
      step.points.push_back({from.time, first});
      if (first != second) {
        const double crossing = from.time + (to.time - from.time) * (a / (a - b));
        step.points.push_back({crossing, first});
        step.points.push_back({crossing, second});
      }
      step.points.push_back({to.time, second});
    }
    step.points.push_back({pwl.points.back().time, side(at(pwl.points.back().value))});
    const double before = side(at(pwl.points.front().value));
    if (step.points.front().value != before) step.points.insert(step.points.begin(), {pwl.points.front().time, before});
    return step;
  }

  template <class Other>
  std::optional<model::SourceFunction> operator()(const Other&) const {
    return std::nullopt;
  }
};

}  // namespace

std::optional<LinearForm> step_of_source(Emission& emission, const LinearForm& x, double at_zero) {
  const model::Network& network = emission.builder().network();
  const std::optional<Affine> sum = in_one_source(network, x);
  if (!sum) return std::nullopt;
  const model::SourceFunction function = sum->source >= 0 ? network.sources[static_cast<std::size_t>(sum->source)].function : model::Dc{};
  const std::optional<model::SourceFunction> step = std::visit(StepOf{*sum, at_zero}, function);
  if (!step) return std::nullopt;
  if (const auto* constant = std::get_if<model::Dc>(&*step)) return LinearForm{model::constant(constant->value)};
  // Its edges would have to move with the source and the level; a switch that the source drives does.
  if (emission.keeps_comparisons()) return std::nullopt;
  model::Source source{emission.label(), *step};
  source.follows = network.sources[static_cast<std::size_t>(sum->source)].label.name;
  return quantity(Quantity::source, emission.builder().add(std::move(source)));
}

}  // namespace pwlsim::elements
