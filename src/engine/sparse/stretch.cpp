#include "engine/sparse/stretch.hpp"

#include <algorithm>

namespace pwlsim::engine::sparse {

namespace {

/// An instant lies two Euler steps before the line through the ends of the last two; in units of one, with rounding.
constexpr double farthest_back = 2.5;

}  // namespace

/// Its points are 0, first_stage and 1.
Stretch::Weights Stretch::weights_within(double x) {
  constexpr double s = first_stage;
  return {(x - s) * (x - 1.0) / s, x * (x - 1.0) / (s * (s - 1.0)), x * (x - s) / (1.0 - s)};
}

void Stretch::take(std::size_t i, const Point& point) {
  samples_[i].time = point.time;
  samples_[i].z = point.z;
}

void Stretch::set(const Point& a, const Point& b) {
  count_ = 2;
  take(0, a);
  take(1, b);
}

void Stretch::set(const Point& a, const Point& b, const Point& c) {
  count_ = 3;
  take(0, a);
  take(1, b);
  take(2, c);
}

Stretch::Weights Stretch::weights(double time) const {
  Weights result{};
  // In steps near the rounding of time itself nothing moves by more than the tolerance.
  const double first = samples_[0].time, last = samples_[count_ - 1].time;
  for (std::size_t i = 1; i < count_; ++i)
    if (!(samples_[i].time > samples_[i - 1].time)) {
      result[count_ - 1] = 1.0;
      return result;
    }
  time = std::clamp(time, first - farthest_back * (last - first), last + (last - first));
  for (std::size_t i = 0; i < count_; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < count_; ++j)
      if (j != i) weight *= (time - samples_[j].time) / (samples_[i].time - samples_[j].time);
    result[i] = weight;
  }
  return result;
}

double Stretch::value(const Form& form, const Weights& weights) const {
  double sum = form.constant;
  for (std::size_t i = 0; i < count_; ++i) sum += weights[i] * Form::sum(form.z, samples_[i].z.data());
  return sum;
}

void Stretch::interpolate(const Weights& weights, std::vector<double>& z) const {
  z.assign(samples_[0].z.size(), 0.0);
  for (std::size_t s = 0; s < count_; ++s)
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += weights[s] * samples_[s].z[i];
}

}  // namespace pwlsim::engine::sparse
