#pragma once
/// The last accepted points since the last restart, and the polynomial through them.

#include <array>
#include <vector>

#include "engine/sparse/descriptor.hpp"

namespace pwlsim::engine::sparse {

class History {
 public:
  static constexpr std::size_t most = 4;

  void clear() { count_ = 0; }
  void add(double time, const std::vector<double>& z, const std::vector<double>& w);
  [[nodiscard]] std::size_t size() const { return count_; }

  /// Σ weights · values at the points, the newest first: the polynomial of degree size() − 1 at `time`.
  [[nodiscard]] std::array<double, most> weights(double time) const;
  /// The z-terms of a form on that polynomial.
  [[nodiscard]] double interpolate(const Form& form, const std::array<double, most>& weights) const;

  struct Sample {
    double time = 0.0;
    std::vector<double> z, w;
  };
  /// 0 is the newest.
  [[nodiscard]] const Sample& sample(std::size_t back) const { return samples_[(newest_ + most - back) % most]; }

 private:
  std::array<Sample, most> samples_;
  std::size_t newest_ = 0, count_ = 0;
};

}  // namespace pwlsim::engine::sparse
