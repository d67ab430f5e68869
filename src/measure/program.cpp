#include "measure/program.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pwlsim::measure {
namespace {

using circuit::StepKind;

/// Of a polynomial: more factors than a part's sixteen points show at a glance.
constexpr int highest_degree = 8;

/// A part of an expression as a polynomial of signals and time.
struct Shape {
  int degree = 0;           ///< −1: none
  bool is_written = false;  ///< a number of the deck
  double number = 0.0;
};

Shape raised(const Shape& base, const Shape& exponent) {
  if (base.degree == 0 && exponent.degree == 0) return {};
  const double n = exponent.number;
  const bool is_whole = exponent.is_written && n >= 1.0 && n <= highest_degree && n == std::floor(n);
  if (!is_whole || base.degree < 0 || base.degree * static_cast<int>(n) > highest_degree) return {-1};
  return {base.degree * static_cast<int>(n)};
}

Shape combined(const std::string& operation, const Shape& left, const Shape& right) {
  if (operation == "^" || operation == "**") return raised(left, right);
  if (left.degree < 0 || right.degree < 0) return {-1};
  if (left.degree == 0 && right.degree == 0) return {};
  if (operation == "+" || operation == "-") return {std::max(left.degree, right.degree)};
  if (operation == "*" && left.degree + right.degree <= highest_degree) return {left.degree + right.degree};
  if (operation == "/" && right.degree == 0) return left;
  return {-1};
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
        const std::size_t count = operands_of(step);
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

/// What a step has corners or jumps by, to `take`: a quantity, the size of its terms, and whether it acts at all integers.
template <typename Take>
void each_turn(const circuit::MeasuredExpression::Step& step, const double* arguments, const Take& take) {
  const auto take_difference = [&](double a, double b) { take(a - b, std::max(std::abs(a), std::abs(b)), false); };
  if (step.kind == StepKind::operation && circuit::compares(step.operation)) take_difference(arguments[0], arguments[1]);
  if (step.kind != StepKind::function) return;
  constexpr double half = 0.5;
  switch (step.function->corners) {
    case circuit::Corners::none:
      break;
    case circuit::Corners::at_zero:
      take_difference(arguments[0], 0.0);
      break;
    case circuit::Corners::at_half:
      take_difference(arguments[0], half);
      break;
    case circuit::Corners::at_integers:
      take(arguments[0], std::abs(arguments[0]), true);
      break;
    case circuit::Corners::at_halves:
      take(arguments[0] + half, std::abs(arguments[0]), true);
      break;
    case circuit::Corners::of_quotient:
      take(arguments[0] / arguments[1], std::abs(arguments[0] / arguments[1]), true);
      break;
    case circuit::Corners::of_differences:
      for (int i = 1; i < step.index; ++i)
        for (int k = 0; k < i; ++k) take_difference(arguments[i], arguments[k]);
      break;
  }
}

}  // namespace

std::size_t operands_of(const circuit::MeasuredExpression::Step& step) {
  switch (step.kind) {
    case StepKind::negate:
    case StepKind::invert:
      return 1;
    case StepKind::operation:
      return 2;
    case StepKind::choose:
      return 3;
    case StepKind::function:
      return static_cast<std::size_t>(step.index);
    default:
      return 0;
  }
}

Program::Program(const circuit::MeasuredExpression& expression) : steps_(expression.steps) {
  for (const Step& step : steps_) {
    operators_.push_back(step.kind == StepKind::operation ? circuit::find_binary(step.operation) : nullptr);
    if (step.kind == StepKind::signal && std::find(probes_.begin(), probes_.end(), step.index) == probes_.end())
      probes_.push_back(step.index);
  }
  find_degrees();
  linear_ = is_affine(steps_, [](std::size_t) { return true; });
}

void Program::find_degrees() {
  std::vector<Shape> stack;
  for (const Step& step : steps_) {
    const std::size_t operands = operands_of(step);
    const std::vector<Shape> own(stack.end() - static_cast<std::ptrdiff_t>(operands), stack.end());
    stack.resize(stack.size() - operands);
    const bool is_constant = std::all_of(own.begin(), own.end(), [](const Shape& shape) { return shape.degree == 0; });
    const int highest = std::accumulate(own.begin(), own.end(), 0, [](int degree, const Shape& shape) {
      return degree < 0 || shape.degree < 0 ? -1 : std::max(degree, shape.degree);
    });
    const std::vector<double> unknown(std::max(operands, std::size_t{2}), 1.0);
    each_turn(step, unknown.data(), [&](double, double, bool at_integers) {
      const bool is_quotient = at_integers && operands == 2 && own[1].degree != 0;
      turn_kinds_.push_back({at_integers, is_quotient ? -1 : highest});
    });
    switch (step.kind) {
      case StepKind::number:
        stack.push_back({0, true, step.number});
        break;
      case StepKind::result:
        stack.push_back({});
        break;
      case StepKind::signal:
      case StepKind::time:
        stack.push_back({1});
        break;
      case StepKind::negate:
        stack.push_back({own[0].degree, own[0].is_written, -own[0].number});
        break;
      case StepKind::operation:
        stack.push_back(combined(step.operation, own[0], own[1]));
        break;
      case StepKind::function:
        stack.push_back(step.function->name == "pow" ? raised(own[0], own[1]) : Shape{is_constant ? 0 : -1});
        break;
      default:
        stack.push_back({is_constant ? 0 : -1});
        break;
    }
  }
  degree_ = stack.empty() ? 0 : stack.back().degree;
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

void Program::find_turns(const Inputs& inputs, std::size_t count, std::vector<double>& values, std::vector<double>& sizes) const {
  values.resize(turns() * count);
  sizes.assign(turns(), 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    turns_.clear();
    (void)at(inputs, i, &turns_);
    for (std::size_t turn = 0; turn < turns(); ++turn) {
      values[turn * count + i] = turns_[turn].value;
      sizes[turn] = std::max(sizes[turn], turns_[turn].size);
    }
  }
}

/// Of a step that takes operands.
double Program::value_of(std::size_t step, std::span<const double> operands) const {
  switch (steps_[step].kind) {
    case StepKind::negate:
      return -operands[0];
    case StepKind::invert:
      return operands[0] == 0.0 ? 1.0 : 0.0;
    case StepKind::operation:
      return operators_[step](operands[0], operands[1]);
    case StepKind::function:
      return steps_[step].function->value(operands);
    default:
      return operands[0] != 0.0 ? operands[1] : operands[2];
  }
}

double Program::value(const std::vector<double>& results) const {
  Inputs inputs;
  inputs.results = &results;
  return at(inputs, 0);
}

/// With `turns`, what it has corners by is added there.
double Program::at(const Inputs& inputs, std::size_t instant, std::vector<Turn>* turns) const {
  stack_.clear();
  const auto pop = [&] {
    const double value = stack_.back();
    stack_.pop_back();
    return value;
  };
  const auto note = [&](const Step& step, std::size_t count) {
    if (turns)
      each_turn(step, stack_.data() + stack_.size() - count, [&](double value, double size, bool) { turns->push_back({value, size}); });
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
