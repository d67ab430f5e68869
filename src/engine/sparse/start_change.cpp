#include "engine/sparse/start_change.hpp"

#include <cmath>

#include "engine/sparse/tolerances.hpp"
#include "linalg/factorisations.hpp"

namespace pwlsim::engine::sparse {

linalg::Vector after_step(const model::Exosystem& exosystem, double step, const linalg::Vector& zeta) {
  linalg::Vector result = zeta;
  for (const auto& block : exosystem.blocks()) {
    const int i = block.first, n = block.size();
    if (block.kind == model::Exosystem::Block::Kind::small_input) continue;  // zero
    if (n == 1) {
      result[i] = zeta[i] / (1.0 - step * exosystem.a()(i, i));
      continue;
    }
    const Eigen::Matrix2d m = Eigen::Matrix2d::Identity() - step * exosystem.a().block<2, 2>(i, i);
    result.segment<2>(i) = m.inverse() * zeta.segment<2>(i);
  }
  return result;
}

void StartChange::take(const std::vector<double>& z, const std::vector<double>& more, const linalg::Vector& zeta, double shift) {
  z_ = z.data();
  w_ = exosystem_.values(zeta);
  change_ = exosystem_.values(after_step(exosystem_, 1.0 / shift, exosystem_.rates(zeta) / shift));
  right_.resize(z.size());
  sizes_.resize(z.size());
  one_ = zeta[exosystem_.constant()];
  if (one_ == 0.0) {
    descriptor_.conduct(z_, right_.data());
    descriptor_.conduct_sizes(z_, sizes_.data());
  } else {
    descriptor_.rates(z_, w_.data(), right_.data());
    descriptor_.rate_sizes(z_, w_.data(), sizes_.data());
  }
  for (std::size_t i = 0; i < right_.size(); ++i)
    if (std::abs(right_[i]) <= tolerance::sum_rounding * sizes_[i]) right_[i] = 0.0;
  descriptor_.add_sources(change_.data(), right_.data());
  for (std::size_t i = 0; i < more.size(); ++i) right_[i] += shift * more[i];
}

double StartChange::closing(const DescriptorPort& port, double of_slack, double of_input, bool is_at_zero) const {
  if (is_at_zero) return -of_slack * Form::sum(port.slack.w, change_.data());
  if (of_slack == 0.0) return -of_input * z_[port.row];
  const bool has_sources = one_ != 0.0;
  double slack = has_sources ? port.slack.value(z_, w_.data()) : Form::sum(port.slack.z, z_);
  const double size = has_sources ? port.slack_size(z_, w_.data()) : Form::size_of(port.slack.z, z_);
  if (std::abs(slack) <= tolerance::guard_sign * size) slack = 0.0;
  slack += Form::sum(port.slack.w, change_.data());
  return -of_slack * slack - of_input * z_[port.row];
}

}  // namespace pwlsim::engine::sparse
