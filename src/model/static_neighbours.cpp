#include "model/static_neighbours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "linalg/factorisations.hpp"
#include "model/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::model {
namespace {}  // namespace

StaticNeighbours::StaticNeighbours(const System& system, const IndexSet& active, const double* x, double largest)
    : role_(static_cast<std::size_t>(system.ports), Role::restricted),
      tableau_(system.d, system.c * Eigen::Map<const Vector>(x, system.size())),
      size_(system.d.cwiseAbs()) {
  const auto state = Eigen::Map<const Vector>(x, system.size());
  tolerance_ = tolerance::neighbour_value * (system.c.cwiseAbs() * state.cwiseAbs()) +
               tolerance::neighbour_state * largest * system.c.rowwise().norm();
  for (int i = system.diodes; i < system.ports; ++i) role_[static_cast<std::size_t>(i)] = Role::stays;
  for (const int port : blocked_ports(system, active)) role_[static_cast<std::size_t>(port)] = Role::stays;
  pivot_on_active(system, active);
}

bool StaticNeighbours::is_zero(int row, int column) const {
  return std::abs(m()(row, column)) <= tolerance::neighbour_pivot * size_(row, column);
}

/// One by one where the diagonal allows it, by twos where it does not, and those last that nothing allows: they are open, and whom they reach.
void StaticNeighbours::pivot_on_active(const System& system, const IndexSet& active) {
  std::vector<int> left;
  for (int i = 0; i < system.ports; ++i)
    if (active.contains(i)) left.push_back(i);
  const auto take = [&](const std::vector<int>& list) {
    pivot(list);
    for (const int port : list) std::erase(left, port);
  };
  while (!left.empty()) {
    const auto share = [&](int i) { return is_zero(i, i) ? 0.0 : std::abs(m()(i, i)) / m().row(i).cwiseAbs().maxCoeff(); };
    const int best = *std::max_element(left.begin(), left.end(), [&](int i, int j) { return share(i) < share(j); });
    if (share(best) > 0.0) {
      take({best});
      continue;
    }
    std::vector<int> pair;
    for (const int i : left)
      for (const int j : left)
        if (i < j && pair.empty() && !is_zero(i, j) && !is_zero(j, i)) pair = {i, j};
    if (pair.empty()) break;
    take(pair);
  }
  for (const int i : left) role_[static_cast<std::size_t>(i)] = Role::settled_later;
  for (int k = 0; k < system.ports; ++k)
    for (const int i : left) {
      if (is_zero(k, i) && is_zero(i, k)) continue;
      role_[static_cast<std::size_t>(k)] = role_[static_cast<std::size_t>(i)] = Role::reached;
    }
}

/// The sizes go through the same sums as the tableau's entries, all of one sign.
void StaticNeighbours::pivot(const std::vector<int>& ports) {
  const Matrix inverse = Matrix(m()(ports, ports)).inverse().cwiseAbs();
  const Vector value = inverse * tolerance_(ports);
  const Matrix rows = inverse * size_(ports, Eigen::all), columns = size_(Eigen::all, ports);
  tolerance_ += m()(Eigen::all, ports).cwiseAbs() * value;
  tolerance_(ports) = value;
  size_ += columns * rows;
  size_(Eigen::all, ports) = columns * inverse;
  size_(ports, Eigen::all) = rows;
  size_(ports, ports) = inverse;
  tableau_.exchange(ports);
}

/// Whether the other ports keep their signs with z at those that are flipped.
bool StaticNeighbours::rest_allows(std::span<const int> flipped, const double* z, const double* z_tolerance) const {
  for (int k = 0; k < q().size(); ++k) {
    if (role(k) != Role::restricted || std::find(flipped.begin(), flipped.end(), k) != flipped.end()) continue;
    double value = q()[k], size = tolerance_[k];
    for (std::size_t i = 0; i < flipped.size(); ++i) {
      const double term = m()(k, flipped[i]) * z[i];
      value += term;
      size += tolerance::neighbour_value * size_(k, flipped[i]) * std::abs(z[i]) + size_(k, flipped[i]) * z_tolerance[i];
    }
    if (value < -size) return false;
  }
  return true;
}

bool StaticNeighbours::may_flip(int port) const {
  if (role(port) != Role::restricted || std::abs(q()[port]) <= tolerance_[port]) return true;
  if (is_zero(port, port)) return false;
  const double z = -q()[port] / m()(port, port), z_tolerance = tolerance_[port] / std::abs(m()(port, port));
  return z >= 0.0 && rest_allows(std::array{port}, &z, &z_tolerance);
}

bool StaticNeighbours::may_flip(int first, int second) const {
  if (role(first) == Role::settled_later) return may_flip(second);
  if (role(second) == Role::settled_later) return may_flip(first);
  if (role(first) != Role::restricted || role(second) != Role::restricted) return true;
  const auto is_stuck = [&](int i) { return is_zero(i, first) && is_zero(i, second) && std::abs(q()[i]) > tolerance_[i]; };
  if (is_stuck(first) || is_stuck(second)) return false;
  const double a = m()(first, first), b = m()(first, second), c = m()(second, first), d = m()(second, second);
  const double determinant = a * d - b * c;
  const double terms = size_(first, first) * size_(second, second) + size_(first, second) * size_(second, first);
  if (std::abs(determinant) <= tolerance::neighbour_pivot * terms) return true;
  const double q1 = q()[first], q2 = q()[second];
  const double z[] = {(b * q2 - d * q1) / determinant, (c * q1 - a * q2) / determinant};
  const double size[] = {(std::abs(b) * tolerance_[second] + std::abs(d) * tolerance_[first]) / std::abs(determinant),
                         (std::abs(c) * tolerance_[first] + std::abs(a) * tolerance_[second]) / std::abs(determinant)};
  return z[0] >= -size[0] && z[1] >= -size[1] && rest_allows(std::array{first, second}, z, size);
}

}  // namespace pwlsim::model
