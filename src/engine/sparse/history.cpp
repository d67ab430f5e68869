#include "engine/sparse/history.hpp"

#include <algorithm>

namespace pwlsim::engine::sparse {

void History::add(double time, const std::vector<double>& z, const std::vector<double>& w) {
  newest_ = (newest_ + 1) % most;
  count_ = std::min(count_ + 1, most);
  Sample& sample = samples_[newest_];
  sample.time = time;
  sample.z = z;
  sample.w = w;
}

std::array<double, History::most> History::weights(double time) const {
  std::array<double, most> result{};
  for (std::size_t i = 0; i < count_; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < count_; ++j)
      if (j != i) weight *= (time - sample(j).time) / (sample(i).time - sample(j).time);
    result[i] = weight;
  }
  return result;
}

double History::interpolate(const Form& form, const std::array<double, most>& weights) const {
  double sum = form.constant;
  for (std::size_t i = 0; i < count_; ++i) {
    const auto& z = sample(i).z;
    double value = 0.0;
    for (const auto& part : form.z) value += part.coefficient * z[static_cast<std::size_t>(part.index)];
    sum += weights[i] * value;
  }
  return sum;
}

}  // namespace pwlsim::engine::sparse
