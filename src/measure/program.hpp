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

/// How many values a step takes from the stack.
[[nodiscard]] std::size_t operands_of(const circuit::MeasuredExpression::Step& step);

/// What functions may do between the points of a part, by interval arithmetic: a function whose argument varies by more than eight units of its own scale
/// (for `exp` one, for a quotient a factor of e) may have a peak there.
struct HiddenFeatures {
  double width = 0.0;       ///< bound of how far the expression may vary then; 0: nothing hidden
  std::vector<char> turns;  ///< of each quantity of turns: whether it may pass its zero between the points
};

class Program {
 public:
  Program() = default;
  explicit Program(const circuit::MeasuredExpression& expression);

  /// Probes it reads, each once.
  [[nodiscard]] const std::vector<int>& probes() const { return probes_; }
  /// Its degree as a polynomial of signals and time with constant factors; −1 if it is none, or one of more than eight factors.
  [[nodiscard]] int degree() const { return degree_; }
  /// Whether it is a sum of signals and of products of two: the points of a piece integrate it exactly.
  [[nodiscard]] bool is_polynomial() const { return degree_ >= 0 && degree_ <= 2; }
  /// Whether it is a sum of signals with factors without signals.
  [[nodiscard]] bool is_linear() const { return linear_; }
  /// Whether it is such a sum of the probes that have an impulse: their factors may be other signals.
  [[nodiscard]] bool is_affine_in(std::span<const double> impulses) const;
  /// The contribution of impulses of probes to its integral at an instant with these values of the others, if it is affine in the impulses.
  [[nodiscard]] double impulse(std::span<const double> impulses, std::span<const double> others, const std::vector<double>& results,
                               double time) const;
  /// `values`: `count` of them.
  void evaluate(const Inputs& inputs, std::size_t count, double* values) const;
  /// The number of quantities at whose zeros, or integers, it has a corner or a jump: differences of sides of a comparison, arguments of max and abs, and the
  /// like. Each depends on those before it only.
  [[nodiscard]] std::size_t turns() const { return turn_kinds_.size(); }
  /// Whether such a quantity acts at all its integers.
  [[nodiscard]] bool turns_at_integers(std::size_t turn) const { return turn_kinds_[turn].at_integers; }
  [[nodiscard]] int turn_degree(std::size_t turn) const { return turn_kinds_[turn].degree; }
  /// `values`: theirs, quantity by quantity, `count` of each; `sizes`: of each the largest magnitude of its terms.
  void find_turns(const Inputs& inputs, std::size_t count, std::vector<double>& values, std::vector<double>& sizes) const;
  /// What sixteen points of a part do not show, where no quantity of turns passes its zero or an integer.
  void find_hidden(const Inputs& inputs, HiddenFeatures& hidden) const;
  /// The value of an expression that reads only results.
  [[nodiscard]] double value(const std::vector<double>& results) const;

 private:
  using Step = circuit::MeasuredExpression::Step;
  struct TurnKind {
    bool at_integers = false;
    int degree = -1;
  };
  struct Turn {
    double value = 0.0, size = 0.0;
  };
  void find_degrees();
  [[nodiscard]] double value_of(std::size_t step, std::span<const double> operands) const;
  [[nodiscard]] double at(const Inputs& inputs, std::size_t instant, std::vector<Turn>* turns = nullptr) const;

  std::vector<Step> steps_;
  std::vector<circuit::BinaryOperator> operators_;  ///< of the steps that are operations
  std::vector<int> probes_;
  std::vector<TurnKind> turn_kinds_;
  int degree_ = 0;
  bool linear_ = true;
  mutable std::vector<double> stack_;
  mutable std::vector<Turn> turns_;
};

}  // namespace pwlsim::measure
