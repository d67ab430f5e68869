#pragma once
/// The last accepted points since the last restart, and polynomials through them.

#include <array>
#include <vector>

#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

class History {
 public:
  static constexpr std::size_t most_points = 4;  ///< of a polynomial

  void clear() { count_ = 0; }
  /// `kink`: ports changed sides between the point before and this one.
  void add(double time, const std::vector<double>& z, const std::vector<double>& w, bool kink);
  [[nodiscard]] std::size_t size() const { return count_; }

  /// value(time) = Σ weight·value at the samples.
  struct Weights {
    std::array<double, most_points> weight{};
    std::size_t first = 0;  ///< sample that weight[0] belongs to
    std::size_t count = 0;
  };
  /// The points around `time`, two on either side where there are as many and no kink lies between; a kink inside the very interval has been
  /// found to be within the tolerance, and counts as the end of the stretch before it.
  [[nodiscard]] Weights weights(double time) const;
  /// The z-terms of a form on that polynomial, and its constant.
  [[nodiscard]] double interpolate(const Form& form, const Weights& weights) const;

  struct Sample {
    double time = 0.0;
    std::vector<double> z, w;
    bool kink = false;
  };
  /// 0 is the newest.
  [[nodiscard]] const Sample& sample(std::size_t back) const { return samples_[(newest_ + capacity - back) % capacity]; }

 private:
  static constexpr std::size_t capacity = 5;
  std::array<Sample, capacity> samples_;
  std::size_t newest_ = 0, count_ = 0;
};

}  // namespace pwlsim::engine::sparse
