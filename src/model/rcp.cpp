#include "model/rcp.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/lemke.hpp"

namespace pwlsim::model {

namespace {

constexpr double series_noise = 3e-14;
constexpr double share_of_norm = 0.1;
constexpr double tie_tolerance = 1e-12;
constexpr double regularisation = 1e-8;  ///< of a problem whose diagonal is about 1

std::vector<int> active_switches(const System& system, const IndexSet& wanted) {
  std::vector<int> active;
  for (int i = system.diodes; i < system.ports; ++i)
    if (wanted.contains(i)) active.push_back(i);
  return active;
}

}  // namespace

RationalProblem::RationalProblem(const System& system) : system_(system), rate_(linalg::rate_of(system.a)) {}

/// M(s) = D + Σ C A^{j−1} B s^{−j} and q(s) = Σ C A^j x s^{−j}, every term that is rounding set to zero: uncleaned noise is
/// amplified by a power of s, and s could then be neither large nor small enough.
PortProblem RationalProblem::at(const double* x, double s) {
  PortProblem problem;
  const int n = system_.n;
  const int size = system_.size();
  const int k = system_.ports;
  if (markov_.empty() && k > 0) {
    Matrix w = system_.b;
    Matrix bound = w.cwiseAbs();
    const Matrix size_a = system_.a.cwiseAbs();
    const Matrix size_c = system_.c.cwiseAbs();
    for (int j = 0; j <= n; ++j) {
      Matrix term = system_.c * w;
      const Matrix term_bound = size_c * bound;
      for (Eigen::Index i = 0; i < term.size(); ++i)
        if (std::abs(term.data()[i]) <= series_noise * term_bound.data()[i]) term.data()[i] = 0.0;
      markov_.push_back(std::move(term));
      w = system_.a * w / rate_;
      bound = size_a * bound / rate_;
    }
  }
  problem.m = system_.d;
  double power = 1.0 / s;
  for (const Matrix& term : markov_) {
    problem.m += term * power;
    power *= rate_ / s;
  }
  Vector z = Eigen::Map<const Vector>(x, size);
  Vector bound = z.cwiseAbs();
  bound.head(n).array() += share_of_norm * z.head(n).norm();
  const Matrix size_a = system_.a.cwiseAbs();
  const Matrix size_c = system_.c.cwiseAbs();
  const Vector row_norm = system_.c.rowwise().norm();
  problem.q = Vector::Zero(k);
  power = 1.0;
  for (int j = 0; j <= size; ++j) {
    const Vector value = system_.c * z;
    const Vector level = series_noise * (size_c * bound + share_of_norm * z.norm() * row_norm);
    for (int i = 0; i < k; ++i)
      if (std::abs(value[i]) > level[i]) problem.q[i] += value[i] * power;
    z = system_.a * z / rate_;
    bound = size_a * bound / rate_;
    power *= rate_ / s;
  }
  return problem;
}

std::vector<IndexSet> RationalProblem::candidates(const double* x, double s, const IndexSet& wanted) {
  PortProblem problem = at(x, s);
  problem = without_switches(problem, system_.diodes, active_switches(system_, wanted));
  if (!problem.m.allFinite() || !problem.q.allFinite()) return {};
  const auto k = problem.q.size();
  const Vector scale = lcp::diagonal_scale(problem.m);
  const Vector q = scale.asDiagonal() * problem.q;
  const Matrix scaled = scale.asDiagonal() * problem.m * scale.asDiagonal();
  lcp::Solution solution = lcp::lemke(scaled, q);
  pivots_ += static_cast<std::uint64_t>(solution.pivots);
  if (solution.status != lcp::Status::solved) {
    // Rounding of a singular problem (series and parallel diodes) can leave it without a solution; a small multiple of 1 restores one.
    solution = lcp::lemke(scaled + regularisation * Matrix::Identity(k, k), q);
    pivots_ += static_cast<std::uint64_t>(solution.pivots);
  }
  if (solution.status != lcp::Status::solved) return {};
  const double tie = tie_tolerance * (k > 0 ? q.cwiseAbs().maxCoeff() : 0.0);
  IndexSet by_value = wanted;
  IndexSet by_basis = wanted;
  for (int i = 0; i < system_.diodes; ++i) {
    const bool tied = solution.z[i] <= tie && solution.w[i] <= tie;
    if (!tied) by_value.set(i, solution.z[i] > solution.w[i]);
    by_basis.set(i, false);
  }
  for (const int i : solution.basis)
    if (i < system_.diodes) by_basis.set(i, true);
  if (by_value == by_basis) return {by_value};
  return {by_value, by_basis};
}

}  // namespace pwlsim::model
