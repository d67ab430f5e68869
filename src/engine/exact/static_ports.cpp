#include "engine/exact/static_ports.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/exact/tolerances.hpp"
#include "lcp/lemke.hpp"
#include "lcp/solve.hpp"
#include "linalg/factorisations.hpp"
#include "model/causality.hpp"
#include "model/valves.hpp"

namespace pwlsim::engine {

namespace {

using linalg::Matrix;
using linalg::Vector;
using linalg::Wide;
using linalg::WideMatrix;
using linalg::WideVector;

WideMatrix solved(const WideMatrix& m, const WideMatrix& right) {
  if (m.rows() == 0) return right;
  return Eigen::PartialPivLU<WideMatrix>(m).solve(right);
}

/// A basis of the complementarity problem w = M z + q; none: empty status.
lcp::Solution solution_of(const WideMatrix& m, const WideVector& q) {
  const Vector scale = lcp::diagonal_scale(m.cast<double>());
  const auto wide = scale.cast<Wide>().asDiagonal();
  const WideMatrix scaled = wide * m * wide;
  const WideVector scaled_q = wide * q;
  lcp::Solution solution = lcp::lemke_wide(scaled, scaled_q);
  if (solution.status != lcp::Status::solved) {
    // Of a problem in no class of Lemke's.
    const lcp::AssessedSolution answer = lcp::solve(scaled.cast<double>(), scaled_q.cast<double>());
    solution = {answer.status, answer.z, answer.w, answer.basis, answer.pivots};
  }
  solution.z = scale.asDiagonal() * solution.z;
  solution.w = solution.w.cwiseQuotient(scale);
  return solution;
}

}  // namespace

model::IndexSet with_switches(const model::System& s, const std::vector<char>& switch_active) {
  model::IndexSet set(s.ports);
  for (int i = s.diodes; i < s.ports; ++i) set.set(i, switch_active[static_cast<std::size_t>(i - s.diodes)] != 0);
  return set;
}

StaticPorts::StaticPorts(const model::System& s, const Vector& zeta) : system_(s) {
  const auto wide = s.unrounded_matrices();
  const Eigen::Index n = s.n, k = s.ports;
  const WideVector sources = zeta.cast<Wide>();
  const WideMatrix b = wide->b.topRows(n), c = wide->c.leftCols(n);
  const WideVector e = wide->a.topRightCorner(n, s.n_zeta) * sources, f = wide->c.rightCols(s.n_zeta) * sources;
  const WideMatrix t = solved(WideMatrix::Identity(k, k) + wide->d, WideMatrix::Identity(k, k));
  c_ = t * c;
  d_ = -t * wide->d;
  f_ = t * f;
  a_ = wide->a.topLeftCorner(n, n) - b * c_;
  b_ = -b * t;
  e_ = e - b * f_;
  double slowest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto rate = static_cast<double>(std::abs(a_(i, i)));
    if (rate > 0.0) slowest = std::min(slowest, rate);
  }
  if (std::isfinite(slowest)) slowest_rate_ = slowest;
}

StaticPorts::Waves StaticPorts::waves(double epsilon, const Vector& x0) const {
  const Eigen::Index n = system_.n, k = system_.ports;
  WideMatrix right(n, k + 1);
  right << b_, e_ + Wide{epsilon} * x0.cast<Wide>();
  const WideMatrix state = solved(Wide{epsilon} * WideMatrix::Identity(n, n) - a_, right);
  Waves result{{}, {}, state.leftCols(k), state.col(k)};
  result.s = WideMatrix::Identity(k, k) + 2 * (d_ + c_ * result.to_state);
  result.s *= 1 - tolerance::dc_wave_loss;
  result.s0 = 2 * (f_ + c_ * result.state0);
  return result;
}

StaticPorts::Proposal StaticPorts::propose(double epsilon, const Vector& x0, const std::vector<char>& switch_active) const {
  const Eigen::Index k = system_.ports, diodes = system_.diodes;
  const Waves w = waves(epsilon, x0);
  WideVector given = WideVector::Zero(k);
  for (Eigen::Index i = diodes; i < k; ++i) given[i] = switch_active[static_cast<std::size_t>(i - diodes)] != 0 ? -1 : 1;
  const std::vector<int> blocked = model::blocked_ports(system_, with_switches(system_, switch_active));
  for (const int i : blocked) given[i] = system_.port[static_cast<std::size_t>(i)].input_is_current ? 1 : -1;
  const WideVector theta = model::causality(w.s, given);
  const WideMatrix signs = theta.asDiagonal();
  WideMatrix right(k, k + 1);
  right << signs - w.s, w.s0;
  const WideMatrix of_ports = solved(w.s + signs, right);
  WideMatrix m = of_ports.topLeftCorner(diodes, diodes);
  WideVector q = of_ports.col(k).head(diodes);
  model::take_out(blocked, m, q);
  if (!m.allFinite() || !q.allFinite()) return {};
  const lcp::Solution solution = solution_of(m, q);
  if (solution.status != lcp::Status::solved) return {};

  std::vector<int> by_basis, by_value;
  std::vector<char> basic(static_cast<std::size_t>(diodes), 0);
  for (const int i : solution.basis) basic[static_cast<std::size_t>(i)] = 1;
  for (int i = 0; i < diodes; ++i) {
    const bool z_is_input = theta[i] > 0;
    if ((basic[static_cast<std::size_t>(i)] != 0) == z_is_input) by_basis.push_back(i);
    if ((solution.z[i] > solution.w[i]) == z_is_input) by_value.push_back(i);
  }
  for (int i = system_.diodes; i < system_.ports; ++i)
    if (switch_active[static_cast<std::size_t>(i - system_.diodes)] != 0) {
      by_basis.push_back(i);
      by_value.push_back(i);
    }
  WideVector z = WideVector::Zero(k);
  z.head(diodes) = solution.z.cast<Wide>();
  const WideVector wave = -(z + of_ports.leftCols(k) * z + of_ports.col(k));
  const WideVector state = w.to_state * wave + w.state0;
  Proposal result{{by_basis}, static_cast<double>((state - x0.cast<Wide>()).norm())};
  if (by_value != by_basis) result.active.push_back(by_value);
  return result;
}

}  // namespace pwlsim::engine
