#pragma once
/// Values of measured expressions at many instants at once.

#include <cstddef>
#include <span>
#include <vector>

#include "circuit/functions.hpp"
#include "circuit/measurement.hpp"

namespace pwlsim::measure {

/// The inputs of an expression: `count` instants each.
struct Inputs {
  const double* times = nullptr;  ///< s
  /// The values of a probe; null for one that the expression does not read.
  std::vector<const double*> signals;
  const std::vector<double>* results = nullptr;
};

class Program {
 public:
  Program() = default;
  explicit Program(const circuit::MeasuredExpression& expression);

  /// Probes it reads, each once.
  [[nodiscard]] const std::vector<int>& probes() const { return probes_; }
  /// Whether it is a sum or product of signals, which the points of a piece resolve as well as the signals.
  [[nodiscard]] bool is_polynomial() const { return polynomial_; }
  /// Whether it is a sum of signals with factors without signals.
  [[nodiscard]] bool is_linear() const { return linear_; }
  /// Whether it is such a sum of the probes that have an impulse: their factors may be other signals.
  [[nodiscard]] bool is_affine_in(std::span<const double> impulses) const;
  /// The contribution of impulses of probes to its integral at an instant with these values of the others, if it is affine in the impulses.
  [[nodiscard]] double impulse(std::span<const double> impulses, std::span<const double> others, const std::vector<double>& results,
                               double time) const;
  /// `values`: `count` of them.
  void evaluate(const Inputs& inputs, std::size_t count, double* values) const;
  /// The number of quantities at whose zeros, or levels, it has a corner or a jump: sides of a comparison, arguments of max and abs, and the like.
  [[nodiscard]] std::size_t turns() const { return turns_at_zero_.size(); }
  /// Whether such a quantity acts at its zeros alone.
  [[nodiscard]] bool turns_at_zero(std::size_t turn) const { return turns_at_zero_[turn]; }
  /// Their values, quantity by quantity: `count` of each.
  void find_turns(const Inputs& inputs, std::size_t count, std::vector<double>& values) const;
  /// The value of an expression that reads only results.
  [[nodiscard]] double value(const std::vector<double>& results) const;

 private:
  using Step = circuit::MeasuredExpression::Step;
  void note_turns(const Step& step);
  [[nodiscard]] double at(const Inputs& inputs, std::size_t instant, std::vector<double>* turns = nullptr) const;

  std::vector<Step> steps_;
  std::vector<circuit::BinaryOperator> operators_;  ///< of the steps that are operations
  std::vector<int> probes_;
  std::vector<bool> turns_at_zero_;  ///< one of each quantity
  bool polynomial_ = true, linear_ = true;
  mutable std::vector<double> stack_, turns_;
};

}  // namespace pwlsim::measure
