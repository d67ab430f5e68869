/// Whether the mode that was found is the only one: other continuations, and what they leave open.

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "model/build_mode.hpp"
#include "model/selection.hpp"
#include "model/static_neighbours.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

/// Modes tried for further continuations where there are more, so that an event does not take seconds.
constexpr std::size_t most_neighbours = 100;

}  // namespace

/// Two verified modes are one solution if x departs alike and Δu_i·Δy_i = 0 at every port: then only what no power tells apart
/// differs (the split between parallel diodes, the potential of a floating part).
bool Selector::continues_alike(const Mode& a, const Mode& b, const double* x) const {
  Vector za(system_.size()), zb(system_.size()), moved(system_.size());
  Vector ua(system_.ports), ub(system_.ports), ya(system_.ports), dy(system_.ports);
  // In the coordinates of each mode, so that rounding does not leave its subspace, where it could grow.
  Vector ca(a.ny), cb(b.ny);
  to_mode(system_, a, x, ca.data());
  to_mode(system_, b, x, cb.data());
  double size = linalg::norm(x, system_.size());
  double rounding = tolerance::derivative_rounding * size;
  const double largest_row = std::sqrt(std::max(
      {a.k.rowwise().squaredNorm().maxCoeff(), b.k.rowwise().squaredNorm().maxCoeff(), system_.c.rowwise().squaredNorm().maxCoeff()}));
  const double growth = std::max({1.0, a.norm_a / rational_.rate(), b.norm_a / rational_.rate()});
  for (int j = 0; j <= system_.size(); ++j, rounding *= growth) {
    from_mode(system_, a, ca.data(), za.data());
    from_mode(system_, b, cb.data(), zb.data());
    size = std::max({size * tolerance::vanishing_derivative, za.norm(), zb.norm()});
    if ((za - zb).norm() > tolerance::same_derivative * size + rounding) return false;
    linalg::multiply(a.k, za.data(), ua.data());
    linalg::multiply(b.k, zb.data(), ub.data());
    linalg::multiply(system_.c, za.data(), ya.data());
    const double port_size = std::max({ua.cwiseAbs().maxCoeff(), ub.cwiseAbs().maxCoeff(), ya.cwiseAbs().maxCoeff()});
    moved = za - zb;
    linalg::multiply(system_.c, moved.data(), dy.data());
    const Vector du = ua - ub;
    linalg::multiply(system_.d, du.data(), ya.data());
    dy += ya;
    for (int i = 0; i < system_.ports; ++i)
      if (std::min(std::abs(du[i]), std::abs(dy[i])) > tolerance::same_derivative * port_size + rounding * largest_row) return false;
    ca = a.flow.a() * ca / rational_.rate();
    cb = b.flow.a() * cb / rational_.rate();
  }
  return true;
}

/// Whether a guard is below zero at x already, far beyond rounding: what `accepts` would find with its derivatives, for less.
bool Selector::is_violated(const Mode& mode, const double* x) {
  coordinates_of_ = &mode;
  to_mode(system_, mode, x, y_.data());
  const double tolerance = std::max(tolerance::clearly_violated, tolerance::clearly_above_noise * mode.noise * verifier_.relaxation());
  const double norm = linalg::norm(y_.data(), mode.ny);
  for (int i = 0; i < system_.diodes; ++i)
    if (linalg::row_times(mode.guards, i, y_.data()) < -tolerance * mode.guard_norm[i] * norm) return true;
  return false;
}

/// Where no certificate promises uniqueness: the verified modes that continue differently, one of each kind, `chosen` among them. All
/// modes are tried where there are few, else those that have one or two ports otherwise than the chosen one.
std::vector<const Mode*> Selector::continuations(const double* x, const Mode& chosen) {
  const std::vector<double> copy(x, x + system_.size());
  std::vector<const Mode*> found{&chosen};
  const auto keep_if_new = [&](const IndexSet& set) {
    const Mode* slow = modes_.slow_mode(set);
    const Mode& m = slow && strictly_consistent(*slow, copy.data(), projected_.data()) ? *slow : modes_.mode(set);
    if (&m == &chosen || !m.regular || !strictly_consistent(m, copy.data(), projected_.data()) || is_violated(m, projected_.data()) ||
        !accepts(m, projected_.data()))
      return false;
    if (std::none_of(found.begin(), found.end(), [&](const Mode* other) { return continues_alike(*other, m, copy.data()); }))
      found.push_back(&m);
    return false;
  };
  if (system_.diodes <= few_ports) {
    any_set(chosen.active, system_.diodes, keep_if_new);
    return found;
  }
  const StaticNeighbours neighbours(system_, chosen.active, x, largest_);
  std::vector<std::pair<int, int>> flips;  // equal: one port
  for (int i = 0; i < system_.diodes; ++i)
    for (int j = i; j < system_.diodes; ++j)
      if (i == j ? neighbours.may_flip(i) : neighbours.may_flip(i, j)) flips.emplace_back(i, j);
  if (flips.size() > most_neighbours) {
    std::stable_partition(flips.begin(), flips.end(), [](const auto& flip) { return flip.first == flip.second; });
    flips.resize(most_neighbours);
  }
  for (const auto& [i, j] : flips) {
    IndexSet set = chosen.active;
    set.flip(i);
    if (j != i) set.flip(j);
    keep_if_new(set);
  }
  return found;
}

/// Of several: the first has u = 0 in the earliest port in which they differ.
const Mode* Selector::first_of(const std::vector<const Mode*>& modes) const {
  return *std::min_element(modes.begin(), modes.end(), [&](const Mode* a, const Mode* b) {
    for (int i = 0; i < system_.diodes; ++i)
      if (a->active.contains(i) != b->active.contains(i)) return b->active.contains(i);
    return false;
  });
}

}  // namespace pwlsim::model
