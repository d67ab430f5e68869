#pragma once
/// The exact gradient of a measured expression to each quantity that it reads.

#include <span>
#include <vector>

#include "circuit/measurement.hpp"

namespace pwlsim::measure {

struct GradientValue {
  double value = 0.0;
  std::vector<double> signals;  ///< of each probe of ExpressionGradient::probes
  std::vector<double> results;  ///< of each measurement of the list
  std::vector<double> numbers;  ///< of each parameter that numbers of the expression depend on
  double time = 0.0;
  bool has_kink = false;  ///< the value is at a corner of a function; the gradient is that of one side
};

class ExpressionGradient {
 public:
  ExpressionGradient() = default;
  explicit ExpressionGradient(const circuit::MeasuredExpression& expression);

  /// Numbers of probes that it reads, each once.
  [[nodiscard]] const std::vector<int>& probes() const { return probes_; }
  /// `signals`: the values of probes(), in order.
  [[nodiscard]] GradientValue at(std::span<const double> signals, const std::vector<double>& results, double time) const;

 private:
  using Step = circuit::MeasuredExpression::Step;
  struct Node {
    double value = 0.0, weight = 0.0;
    std::vector<std::size_t> operands;
    std::vector<double> partials;
  };
  [[nodiscard]] Node node_of(const Step& step, std::vector<std::size_t>& stack, const std::vector<Node>& nodes, bool& has_kink) const;
  [[nodiscard]] std::size_t place(int probe) const;
  void spread_weights(std::vector<Node>& nodes, GradientValue& gradient) const;

  std::vector<Step> steps_;
  std::vector<int> probes_;
};

}  // namespace pwlsim::measure
