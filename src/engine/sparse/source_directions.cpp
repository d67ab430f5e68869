#include "engine/sparse/source_directions.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

using linalg::Matrix;
using linalg::Vector;

SourceDirections::SourceDirections(const model::Exosystem& exosystem, const Vector& zeta) {
  collect(exosystem, zeta);
  along_.resize(zeta.size(), 0);
  dual_.resize(0, zeta.size());
  const auto most = static_cast<Eigen::Index>(2 * groups_.size());
  rates_ = Matrix::Zero(most, most);
  for (Group& group : groups_) {
    group.first = along_.cols();
    if (group.turns)
      add_turning(group, exosystem);
    else
      add_levels(group, exosystem);
    group.size = along_.cols() - group.first;
  }
  rates_.conservativeResize(along_.cols(), along_.cols());
}

/// States of one rate move together.
void SourceDirections::collect(const model::Exosystem& exosystem, const Vector& zeta) {
  for (const auto& block : exosystem.blocks()) {
    const auto own = zeta.segment(block.first, block.size());
    if (own.isZero(0.0)) continue;
    const bool turns = block.kind == model::Exosystem::Block::Kind::oscillation && block.omega != 0.0;
    const double omega = turns ? block.omega : 0.0, damping = block.is_curved() ? block.damping : 0.0;
    auto group =
        std::find_if(groups_.begin(), groups_.end(), [&](const Group& other) { return other.omega == omega && other.damping == damping; });
    if (group == groups_.end()) group = groups_.insert(group, {turns, omega, damping, Vector::Zero(zeta.size())});
    group->zeta.segment(block.first, block.size()) = own;
  }
}

/// A direction beside the others; those of other groups share no state with it.
void SourceDirections::add(const Vector& direction) {
  const Eigen::Index k = along_.cols();
  along_.conservativeResize(Eigen::NoChange, k + 1);
  along_.col(k) = direction;
  dual_.conservativeResize(k + 1, Eigen::NoChange);
  dual_.row(k) = direction.transpose() / direction.squaredNorm();
}

/// ζ, and what ramps make of it in a second: the part of it across ζ measures it.
void SourceDirections::add_levels(Group& group, const model::Exosystem& exosystem) {
  const Eigen::Index k = group.first;
  add(group.zeta);
  rates_(k, k) = -group.damping;
  const Vector slope = exosystem.rates(group.zeta) + group.damping * group.zeta;
  const double along = group.zeta.dot(slope) / group.zeta.squaredNorm();
  const Vector across = slope - along * group.zeta;
  if (group.damping != 0.0 || across.isZero(0.0)) return;
  add(slope);
  dual_.row(k + 1) = across.transpose() / across.squaredNorm();
  dual_.row(k) -= along * dual_.row(k + 1);
  rates_(k + 1, k) = 1.0;
}

/// ζ, and ζ a quarter of a period on.
void SourceDirections::add_turning(Group& group, const model::Exosystem& exosystem) {
  const Eigen::Index k = group.first;
  add(group.zeta);
  add((exosystem.rates(group.zeta) + group.damping * group.zeta) / group.omega);
  rates_(k, k) = rates_(k + 1, k + 1) = -group.damping;
  rates_(k + 1, k) = group.omega;
  rates_(k, k + 1) = -group.omega;
}

Vector SourceDirections::own() const {
  Vector result = Vector::Zero(size());
  for (const Group& group : groups_) result[group.first] = 1.0;
  return result;
}

Vector SourceDirections::reach(const Vector& sizes, double tau) const {
  Vector result(sizes.size());
  for (const Group& group : groups_) {
    const Eigen::Index k = group.first;
    const double growth = std::exp(std::max(0.0, -group.damping * tau));
    result[k] = growth * sizes[k];
    if (group.size < 2) continue;
    result[k + 1] = sizes[k + 1] + tau * sizes[k];
    if (group.turns) result[k] = result[k + 1] = growth * std::hypot(sizes[k], sizes[k + 1]);
  }
  return result;
}

}  // namespace pwlsim::engine::sparse
