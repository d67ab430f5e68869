#include "measure/expression_gradient.hpp"

#include <algorithm>

#include "circuit/function_derivatives.hpp"

namespace pwlsim::measure {

using circuit::StepKind;

ExpressionGradient::ExpressionGradient(const circuit::MeasuredExpression& expression) : steps_(expression.steps) {
  for (const Step& step : steps_)
    if (step.kind == StepKind::signal && std::find(probes_.begin(), probes_.end(), step.index) == probes_.end())
      probes_.push_back(step.index);
}

ExpressionGradient::Node ExpressionGradient::node_of(const Step& step, std::vector<std::size_t>& stack, const std::vector<Node>& nodes,
                                                     bool& has_kink) const {
  Node node;
  const auto take = [&](std::size_t count) {
    node.operands.assign(stack.end() - static_cast<std::ptrdiff_t>(count), stack.end());
    stack.resize(stack.size() - count);
  };
  const auto operand = [&](std::size_t k) { return nodes[node.operands[k]].value; };
  switch (step.kind) {
    case StepKind::negate:
      take(1);
      node.value = -operand(0);
      node.partials = {-1.0};
      break;
    case StepKind::invert:
      take(1);
      node.value = operand(0) == 0.0 ? 1.0 : 0.0;
      node.partials = {0.0};
      break;
    case StepKind::operation: {
      take(2);
      node.value = circuit::find_binary(step.operation)(operand(0), operand(1));
      const circuit::Partials p = circuit::operation_partials(step.operation, operand(0), operand(1));
      node.partials = {p.left, p.right};
      break;
    }
    case StepKind::function: {
      take(static_cast<std::size_t>(step.index));
      std::vector<double> arguments;
      for (const std::size_t k : node.operands) arguments.push_back(nodes[k].value);
      node.value = step.function->value(arguments);
      node.partials.resize(arguments.size());
      circuit::function_partials(*step.function, arguments, node.partials, has_kink);
      break;
    }
    case StepKind::choose:
      take(3);
      node.value = operand(0) != 0.0 ? operand(1) : operand(2);
      node.partials = {0.0, operand(0) != 0.0 ? 1.0 : 0.0, operand(0) != 0.0 ? 0.0 : 1.0};
      break;
    default:
      break;
  }
  return node;
}

std::size_t ExpressionGradient::place(int probe) const {
  return static_cast<std::size_t>(std::find(probes_.begin(), probes_.end(), probe) - probes_.begin());
}

GradientValue ExpressionGradient::at(std::span<const double> signals, const std::vector<double>& results, double time) const {
  GradientValue gradient;
  gradient.signals.resize(probes_.size());
  gradient.results.resize(results.size());
  std::vector<Node> nodes;
  std::vector<std::size_t> stack;
  for (const Step& step : steps_) {
    Node node;
    if (step.kind == StepKind::number)
      node.value = step.number;
    else if (step.kind == StepKind::signal)
      node.value = signals[place(step.index)];
    else if (step.kind == StepKind::result)
      node.value = results[static_cast<std::size_t>(step.index)];
    else if (step.kind == StepKind::time)
      node.value = time;
    else
      node = node_of(step, stack, nodes, gradient.has_kink);
    stack.push_back(nodes.size());
    nodes.push_back(std::move(node));
  }
  if (nodes.empty()) return gradient;
  gradient.value = nodes.back().value;
  spread_weights(nodes, gradient);
  return gradient;
}

/// From the result back to what it is made of.
void ExpressionGradient::spread_weights(std::vector<Node>& nodes, GradientValue& gradient) const {
  nodes.back().weight = 1.0;
  for (std::size_t k = nodes.size(); k-- > 0;) {
    const Node& node = nodes[k];
    const Step& step = steps_[k];
    if (node.weight == 0.0) continue;
    if (step.kind == StepKind::signal)
      gradient.signals[place(step.index)] += node.weight;
    else if (step.kind == StepKind::result)
      gradient.results[static_cast<std::size_t>(step.index)] += node.weight;
    else if (step.kind == StepKind::time)
      gradient.time += node.weight;
    else if (step.kind == StepKind::number && !step.gradient.empty()) {
      gradient.numbers.resize(std::max(gradient.numbers.size(), step.gradient.size()));
      for (std::size_t i = 0; i < step.gradient.size(); ++i) gradient.numbers[i] += node.weight * step.gradient[i];
    }
    for (std::size_t i = 0; i < node.operands.size(); ++i)
      if (node.partials[i] != 0.0) nodes[node.operands[i]].weight += node.weight * node.partials[i];
  }
}

}  // namespace pwlsim::measure
