#include "engine/sparse/stretch.hpp"

namespace pwlsim::engine::sparse {

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
