#include "measure/program.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::measure {
namespace {

using Kind = circuit::MeasuredExpression::Step::Kind;

bool keeps_polynomials(const circuit::MeasuredExpression::Step& step) {
  switch (step.kind) {
    case Kind::number:
    case Kind::signal:
    case Kind::result:
    case Kind::time:
    case Kind::negate:
      return true;
    case Kind::operation:
      return step.operation == "+" || step.operation == "-" || step.operation == "*";
    default:
      return false;
  }
}

}  // namespace

Program::Program(const circuit::MeasuredExpression& expression) : steps_(expression.steps) {
  for (const Step& step : steps_) {
    operators_.push_back(step.kind == Kind::operation ? circuit::find_binary(step.operation) : nullptr);
    polynomial_ = polynomial_ && keeps_polynomials(step);
    if (step.kind == Kind::signal && std::find(probes_.begin(), probes_.end(), step.index) == probes_.end()) probes_.push_back(step.index);
  }
}

void Program::evaluate(const Inputs& inputs, std::size_t count, double* values) const {
  for (std::size_t i = 0; i < count; ++i) values[i] = at(inputs, i);
}

double Program::value(const std::vector<double>& results) const {
  Inputs inputs;
  inputs.results = &results;
  return at(inputs, 0);
}

double Program::at(const Inputs& inputs, std::size_t instant) const {
  stack_.clear();
  const auto pop = [&] {
    const double value = stack_.back();
    stack_.pop_back();
    return value;
  };
  const circuit::BinaryOperator* binary = operators_.data();
  for (const Step& step : steps_) {
    const circuit::BinaryOperator operation = *binary++;
    switch (step.kind) {
      case Kind::number:
        stack_.push_back(step.number);
        break;
      case Kind::signal:
        stack_.push_back(inputs.signals[static_cast<std::size_t>(step.index)][instant]);
        break;
      case Kind::result:
        stack_.push_back((*inputs.results)[static_cast<std::size_t>(step.index)]);
        break;
      case Kind::time:
        stack_.push_back(inputs.times[instant]);
        break;
      case Kind::negate:
        stack_.back() = -stack_.back();
        break;
      case Kind::invert:
        stack_.back() = stack_.back() == 0.0 ? 1.0 : 0.0;
        break;
      case Kind::operation: {
        const double right = pop();
        stack_.back() = operation(stack_.back(), right);
        break;
      }
      case Kind::function: {
        const auto count = static_cast<std::size_t>(step.index);
        const double value = step.function->value({stack_.data() + stack_.size() - count, count});
        stack_.resize(stack_.size() - count);
        stack_.push_back(value);
        break;
      }
      case Kind::choose: {
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
