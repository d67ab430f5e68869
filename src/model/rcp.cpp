#include "model/rcp.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lcp/lemke.hpp"

namespace pwlsim::model {

namespace {

constexpr double series_noise = 3e-14;
constexpr double share_of_norm = 0.1;
constexpr double tie_tolerance = 1e-12;
constexpr double regularisation = 1e-8;  ///< of a problem whose diagonal is about 1
constexpr double switch_rank_tolerance = 1e-11;

}  // namespace

RationalProblem::RationalProblem(const System& system) : system_(system), rate_(linalg::rate_of(system.a)) {}

/// M(s) = D + Σ C A^{j−1} B s^{−j} and q(s) = Σ C A^j x s^{−j}, every term that is rounding set to zero: uncleaned noise is
/// amplified by a power of s, and s could then be neither large nor small enough.
RationalProblem::Problem RationalProblem::at(const double* x, double s) {
  Problem problem;
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

/// Active switch ports have y = 0 and a free u. They are solved out of the problem where their own block allows it; else u = u⁺ − u⁻ with
/// ±y ≥ 0 keeps the problem complementary (and monotone when it was).
void RationalProblem::without_switches(const IndexSet& wanted, Problem& problem) const {
  std::vector<int> active;
  for (int i = system_.diodes; i < system_.ports; ++i)
    if (wanted.contains(i)) active.push_back(i);
  const auto d = static_cast<Eigen::Index>(system_.diodes);
  const auto a = static_cast<Eigen::Index>(active.size());
  Problem diodes{problem.m.topLeftCorner(d, d), problem.q.head(d)};
  if (a == 0) {
    problem = std::move(diodes);
    return;
  }
  Matrix ss(a, a), sd(a, d), ds(d, a);
  Vector qs(a);
  for (Eigen::Index i = 0; i < a; ++i) {
    const int port = active[static_cast<std::size_t>(i)];
    qs[i] = problem.q[port];
    sd.row(i) = problem.m.row(port).head(d);
    ds.col(i) = problem.m.col(port).head(d);
    for (Eigen::Index j = 0; j < a; ++j) ss(i, j) = problem.m(port, active[static_cast<std::size_t>(j)]);
  }
  const Vector scale = lcp::diagonal_scale(ss);
  const Matrix scaled = scale.asDiagonal() * ss * scale.asDiagonal();
  Eigen::FullPivLU<Matrix> lu(scaled);
  lu.setThreshold(switch_rank_tolerance);
  if (!lu.isInvertible()) {
    problem.m.resize(d + 2 * a, d + 2 * a);
    problem.m << diodes.m, ds, -ds, sd, ss, -ss, -sd, -ss, ss;
    problem.q.resize(d + 2 * a);
    problem.q << diodes.q, qs, -qs;
    return;
  }
  // A Schur complement cancels: what is left of equal terms is rounding, and must not decide.
  const Matrix to = ds * scale.asDiagonal();
  const Matrix inverse = lu.inverse();
  const Matrix left = to * inverse;
  const Matrix left_bound = to.cwiseAbs() * inverse.cwiseAbs();
  const Matrix right = scale.asDiagonal() * sd;
  const Vector right_q = scale.asDiagonal() * qs;
  problem.m = linalg::cleaned(diodes.m - left * right, diodes.m.cwiseAbs() + left_bound * right.cwiseAbs());
  problem.q = linalg::cleaned(diodes.q - left * right_q, diodes.q.cwiseAbs() + left_bound * right_q.cwiseAbs());
}

std::vector<IndexSet> RationalProblem::candidates(const double* x, double s, const IndexSet& wanted) {
  Problem problem = at(x, s);
  without_switches(wanted, problem);
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
