#include "model/source_departure.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::model {

SourceDeparture::SourceDeparture(const Exosystem& exosystem) : exosystem_(exosystem) {
  // States that move others are no larger than 1: slopes in units of the steepest, sinusoids, decays. Those that grow are.
  if (exosystem.size() > 0) steepest_ = exosystem.a().cwiseAbs().rowwise().sum().maxCoeff();
  const auto& blocks = exosystem.blocks();
  if (std::any_of(blocks.begin(), blocks.end(), [](const auto& block) { return block.damping < 0.0; })) steepest_ = forever;
}

bool SourceDeparture::take(const Exosystem::Phase& phase, double time, const double* zeta) {
  if (known_ > 0 && time == time_ && std::equal(zeta, zeta + exosystem_.size(), derivatives_.begin())) return false;
  time_ = time;
  if (known_ == 0) {
    absolute_ = exosystem_.a().cwiseAbs();
    derivatives_.resize(static_cast<std::size_t>(exosystem_.size()));
    sizes_.resize(derivatives_.size());
  }
  others_vanish_ = false;
  std::copy_n(zeta, exosystem_.size(), derivatives_.begin());
  exosystem_.sizes(phase, time, zeta, sizes_.data());
  known_ = 1;
  return true;
}

/// One derivative more; false where it vanishes.
bool SourceDeparture::extend() {
  if (others_vanish_) return false;
  const auto states = static_cast<std::size_t>(exosystem_.size());
  if (derivatives_.size() == known_ * states) {
    derivatives_.resize((known_ + 1) * states);
    sizes_.resize(derivatives_.size());
  }
  const std::size_t from = (known_ - 1) * states, to = known_ * states;
  linalg::multiply(exosystem_.a(), &derivatives_[from], &derivatives_[to]);
  linalg::multiply(absolute_, &sizes_[from], &sizes_[to]);
  ++known_;
  others_vanish_ = std::all_of(&sizes_[to], &sizes_[to] + states, [](double s) { return s == 0.0; });
  return !others_vanish_;
}

/// Whether a value that is this far from its level passes it within the tolerance, by its slope.
bool SourceDeparture::is_on_level(const double* row, double distance) {
  double gains = 0.0;
  for (Eigen::Index i = 0; i < absolute_.rows(); ++i) gains += std::abs(row[i]);
  if (!(distance <= tolerance_ * gains * steepest_) || (known_ == 1 && !extend())) return false;
  double slope = 0.0;
  for (std::size_t i = 0, states = static_cast<std::size_t>(exosystem_.size()); i < states; ++i) slope += row[i] * derivatives_[states + i];
  return distance <= tolerance_ * std::abs(slope);
}

double SourceDeparture::of(const double* row, double level) {
  const auto states = static_cast<std::size_t>(exosystem_.size());
  double value = -level;
  double size = std::abs(level);
  for (std::size_t order = 0; order <= states; ++order) {
    if (order == known_ && !extend()) return 0.0;
    for (std::size_t i = 0; i < states; ++i) {
      value += row[i] * derivatives_[order * states + i];
      size += std::abs(row[i]) * sizes_[order * states + i];
    }
    if (std::abs(value) > threshold_noise * size && (order > 0 || !is_on_level(row, std::abs(value)))) return value;
    value = size = 0.0;
  }
  return 0.0;
}

}  // namespace pwlsim::model
