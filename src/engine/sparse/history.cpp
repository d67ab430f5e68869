#include "engine/sparse/history.hpp"

#include <algorithm>

namespace pwlsim::engine::sparse {

void History::add(double time, const std::vector<double>& z, const std::vector<double>& w, bool kink) {
  newest_ = (newest_ + 1) % capacity;
  count_ = std::min(count_ + 1, capacity);
  Sample& sample = samples_[newest_];
  sample.time = time;
  sample.z = z;
  sample.w = w;
  sample.kink = kink;
}

History::Weights History::weights(double time) const {
  std::size_t newer = 0;
  while (newer + 2 < count_ && sample(newer + 1).time > time) ++newer;
  std::size_t older = std::min(newer + 1, count_ - 1);
  const bool kinked = older != newer && sample(newer).kink;
  bool grew = true;
  while (grew && older - newer + 1 < most_points) {
    grew = false;
    if (newer > 0 && !kinked && !sample(newer - 1).kink) {
      --newer;
      grew = true;
    }
    if (older + 1 < count_ && !sample(older).kink && older - newer + 1 < most_points) {
      ++older;
      grew = true;
    }
  }
  Weights result;
  result.first = newer;
  result.count = older - newer + 1;
  for (std::size_t i = 0; i < result.count; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < result.count; ++j)
      if (j != i) weight *= (time - sample(newer + j).time) / (sample(newer + i).time - sample(newer + j).time);
    result.weight[i] = weight;
  }
  return result;
}

double History::interpolate(const Form& form, const Weights& weights) const {
  double sum = form.constant;
  for (std::size_t i = 0; i < weights.count; ++i) {
    const auto& z = sample(weights.first + i).z;
    double value = 0.0;
    for (const auto& part : form.z) value += part.coefficient * z[static_cast<std::size_t>(part.index)];
    sum += weights.weight[i] * value;
  }
  return sum;
}

}  // namespace pwlsim::engine::sparse
