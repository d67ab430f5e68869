#pragma once
/// The last stretch of a run: the polynomial through two or three solutions of a step.
///
/// Through the stages of TR-BDF2 it errs by a third of what the step may: |x (x − c)(x − 1)|/6 ≤ 0.013 times h³ z''', beside 0.040.

#include <array>
#include <vector>

#include "engine/sparse/stepper.hpp"

namespace pwlsim::engine::sparse {

class Stretch {
 public:
  /// A line.
  void set(const Point& a, const Point& b);
  /// A parabola.
  void set(const Point& a, const Point& b, const Point& c);

  using Weights = std::array<double, 3>;
  /// value(time) = Σ weight·value at the points.
  [[nodiscard]] Weights weights(double time) const;
  /// The same at a part of a step of TR-BDF2 through all of its stages.
  [[nodiscard]] static Weights weights_within(double fraction);
  /// Its terms in z, and its constant.
  [[nodiscard]] double value(const Form& form, const Weights& weights) const;
  void interpolate(const Weights& weights, std::vector<double>& z) const;

 private:
  struct Sample {
    double time = 0.0;
    std::vector<double> z;
  };
  void take(std::size_t i, const Point& point);

  std::array<Sample, 3> samples_;
  std::size_t count_ = 0;
};

}  // namespace pwlsim::engine::sparse
