#include "measure/program.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::measure {
namespace {

using circuit::StepKind;

bool keeps_polynomials(const circuit::MeasuredExpression::Step& step) {
  switch (step.kind) {
    case StepKind::number:
    case StepKind::signal:
    case StepKind::result:
    case StepKind::time:
    case StepKind::negate:
      return true;
    case StepKind::operation:
      return step.operation == "+" || step.operation == "-" || step.operation == "*";
    default:
      return false;
  }
}

/// Whether the expression is a sum of the signals that `counts` tells, with factors and summands that read none of these.
template <typename Counts>
bool is_affine(const std::vector<circuit::MeasuredExpression::Step>& steps, const Counts& counts) {
  std::vector<bool> reads;  // such a signal, of what is on the stack
  for (const auto& step : steps) {
    const bool right = !reads.empty() && reads.back();
    switch (step.kind) {
      case StepKind::operation: {
        reads.pop_back();
        const bool left = reads.back();
        const bool is_sum = step.operation == "+" || step.operation == "-";
        const bool is_scaled = (step.operation == "*" && !(left && right)) || (step.operation == "/" && !right);
        if ((left || right) && !is_sum && !is_scaled) return false;
        reads.back() = left || right;
        break;
      }
      case StepKind::negate:
        break;
      case StepKind::invert:
        if (right) return false;
        break;
      case StepKind::function:
      case StepKind::choose: {
        const std::size_t count = step.kind == StepKind::choose ? 3 : static_cast<std::size_t>(step.index);
        if (std::find(reads.end() - static_cast<std::ptrdiff_t>(count), reads.end(), true) != reads.end()) return false;
        reads.resize(reads.size() - count);
        reads.push_back(false);
        break;
      }
      default:
        reads.push_back(step.kind == StepKind::signal && counts(static_cast<std::size_t>(step.index)));
        break;
    }
  }
  return true;
}

/// Of a difference, against its sides: below it they are equal.
constexpr double equal_sides = 1e-13;

/// What a step has corners or jumps by, to `take`: a quantity, and whether it acts at its zeros alone.
template <typename Take>
void each_turn(const circuit::MeasuredExpression::Step& step, const double* arguments, const Take& take) {
  const auto take_difference = [&](double a, double b) {
    const double difference = a - b;
    take(std::abs(difference) > equal_sides * std::max(std::abs(a), std::abs(b)) ? difference : 0.0, true);
  };
  if (step.kind == StepKind::operation && circuit::compares(step.operation)) take_difference(arguments[0], arguments[1]);
  if (step.kind != StepKind::function) return;
  switch (step.function->corners) {
    case circuit::Corners::none:
      break;
    case circuit::Corners::at_zero:
    case circuit::Corners::at_levels:
      take(arguments[0], step.function->corners == circuit::Corners::at_zero);
      break;
    case circuit::Corners::of_differences:
      for (int i = 1; i < step.index; ++i)
        for (int k = 0; k < i; ++k) take_difference(arguments[i], arguments[k]);
      break;
  }
}

}  // namespace

Program::Program(const circuit::MeasuredExpression& expression) : steps_(expression.steps) {
  for (const Step& step : steps_) {
    operators_.push_back(step.kind == StepKind::operation ? circuit::find_binary(step.operation) : nullptr);
    polynomial_ = polynomial_ && keeps_polynomials(step);
    note_turns(step);
    if (step.kind == StepKind::signal && std::find(probes_.begin(), probes_.end(), step.index) == probes_.end())
      probes_.push_back(step.index);
  }
  linear_ = is_affine(steps_, [](std::size_t) { return true; });
}

void Program::note_turns(const Step& step) {
  const std::vector<double> arguments(static_cast<std::size_t>(std::max(step.index, 2)));
  each_turn(step, arguments.data(), [&](double, bool at_zero) { turns_at_zero_.push_back(at_zero); });
}

bool Program::is_affine_in(std::span<const double> impulses) const {
  return is_affine(steps_, [&](std::size_t probe) { return impulses[probe] != 0.0; });
}

double Program::impulse(std::span<const double> impulses, std::span<const double> others, const std::vector<double>& results,
                        double time) const {
  constexpr double none = 0.0;
  Inputs with, without;
  with.times = without.times = &time;
  with.results = without.results = &results;
  for (std::size_t probe = 0; probe < impulses.size(); ++probe) {
    const bool acts = impulses[probe] != 0.0;
    with.signals.push_back(acts ? &impulses[probe] : &others[probe]);
    without.signals.push_back(acts ? &none : &others[probe]);
  }
  return at(with, 0) - at(without, 0);
}

void Program::evaluate(const Inputs& inputs, std::size_t count, double* values) const {
  for (std::size_t i = 0; i < count; ++i) values[i] = at(inputs, i);
}

void Program::find_turns(const Inputs& inputs, std::size_t count, std::vector<double>& values) const {
  values.resize(turns() * count);
  for (std::size_t i = 0; i < count; ++i) {
    turns_.clear();
    (void)at(inputs, i, &turns_);
    for (std::size_t turn = 0; turn < turns(); ++turn) values[turn * count + i] = turns_[turn];
  }
}

double Program::value(const std::vector<double>& results) const {
  Inputs inputs;
  inputs.results = &results;
  return at(inputs, 0);
}

/// With `turns`, what it has corners by is added there.
double Program::at(const Inputs& inputs, std::size_t instant, std::vector<double>* turns) const {
  stack_.clear();
  const auto pop = [&] {
    const double value = stack_.back();
    stack_.pop_back();
    return value;
  };
  const auto note = [&](const Step& step, std::size_t count) {
    if (turns) each_turn(step, stack_.data() + stack_.size() - count, [&](double value, bool) { turns->push_back(value); });
  };
  const circuit::BinaryOperator* binary = operators_.data();
  for (const Step& step : steps_) {
    const circuit::BinaryOperator operation = *binary++;
    switch (step.kind) {
      case StepKind::number:
        stack_.push_back(step.number);
        break;
      case StepKind::signal:
        stack_.push_back(inputs.signals[static_cast<std::size_t>(step.index)][instant]);
        break;
      case StepKind::result:
        stack_.push_back((*inputs.results)[static_cast<std::size_t>(step.index)]);
        break;
      case StepKind::time:
        stack_.push_back(inputs.times[instant]);
        break;
      case StepKind::negate:
        stack_.back() = -stack_.back();
        break;
      case StepKind::invert:
        stack_.back() = stack_.back() == 0.0 ? 1.0 : 0.0;
        break;
      case StepKind::operation: {
        note(step, 2);
        const double right = pop();
        stack_.back() = operation(stack_.back(), right);
        break;
      }
      case StepKind::function: {
        const auto count = static_cast<std::size_t>(step.index);
        note(step, count);
        const double value = step.function->value({stack_.data() + stack_.size() - count, count});
        stack_.resize(stack_.size() - count);
        stack_.push_back(value);
        break;
      }
      case StepKind::choose: {
        const double otherwise = pop();
        const double chosen = pop();
        stack_.back() = stack_.back() != 0.0 ? chosen : otherwise;
        break;
      }
    }
  }
  return stack_.back();
}

}  // namespace pwlsim::measure
