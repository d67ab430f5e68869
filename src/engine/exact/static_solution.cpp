#include "engine/exact/static_solution.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "lcp/lemke.hpp"
#include "model/port_problem.hpp"

namespace pwlsim::engine {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double rank_tolerance = 1e-11;
constexpr double residual_tolerance = 1e-9;  ///< of an equation against its largest term
constexpr double sign_tolerance = 1e-9;      ///< of u, y against the largest
/// Weight of u against ξ in the least-norm choice: energy decides first.
constexpr double input_weight = 1e-4;

struct Rest {
  Matrix a, b, c, e, f;
};

bool least_norm_solution(const model::System& s, const Rest& r, const std::vector<int>& active, const Vector& zeta, StaticSolution& out) {
  const auto n = static_cast<Eigen::Index>(s.n);
  const auto k = static_cast<Eigen::Index>(active.size());
  Matrix left = Matrix::Zero(n + k, n + k);
  Vector right(n + k);
  left.topLeftCorner(n, n) = r.a;
  right.head(n) = -r.e * zeta;
  for (Eigen::Index i = 0; i < k; ++i) {
    const int p = active[static_cast<std::size_t>(i)];
    left.block(0, n + i, n, 1) = r.b.col(p) / input_weight;
    left.block(n + i, 0, 1, n) = r.c.row(p);
    right[n + i] = -r.f.row(p).dot(zeta);
    for (Eigen::Index j = 0; j < k; ++j) left(n + i, n + j) = s.d(p, active[static_cast<std::size_t>(j)]) / input_weight;
  }
  for (Eigen::Index i = 0; i < n + k; ++i) {
    const double scale = left.row(i).cwiseAbs().maxCoeff();
    if (scale == 0.0) continue;
    left.row(i) /= scale;
    right[i] /= scale;
  }
  out.x = Vector::Zero(s.size());
  out.x.tail(s.n_zeta) = zeta;
  out.u = Vector::Zero(s.ports);
  if (n + k == 0) return true;
  Eigen::CompleteOrthogonalDecomposition<Matrix> cod;
  cod.setThreshold(rank_tolerance);
  cod.compute(left);
  Vector solution = cod.solve(right);
  solution += cod.solve(right - left * solution);
  const Vector rest = left * solution - right;
  const double size = right.cwiseAbs().maxCoeff();
  if (rest.cwiseAbs().maxCoeff() > residual_tolerance * std::max(size, 1e-300)) return false;
  out.unique = true;
  if (cod.rank() < n + k) {
    const Matrix kernel = linalg::null_space(left, rank_tolerance);
    out.unique = kernel.cols() == 0 || n == 0 || kernel.topRows(n).cwiseAbs().maxCoeff() < 1e-6;
  }
  out.x.head(n) = solution.head(n);
  for (Eigen::Index i = 0; i < k; ++i) out.u[active[static_cast<std::size_t>(i)]] = solution[n + i] / input_weight;
  return true;
}

bool signs_hold(const model::System& s, const StaticSolution& solution) {
  const Vector y = s.c * solution.x + s.d * solution.u;
  if (s.diodes == 0) return true;
  const double scale = std::max({solution.u.cwiseAbs().maxCoeff(), y.cwiseAbs().maxCoeff(), 1e-300});
  return solution.u.head(s.diodes).minCoeff() >= -sign_tolerance * scale && y.head(s.diodes).minCoeff() >= -sign_tolerance * scale;
}

/// Diode sets that Lemke proposes at one small s, switches solved out.
std::vector<std::vector<int>> proposals(const model::System& s, const Rest& r, const Vector& zeta, const std::vector<int>& switches,
                                        double small) {
  const int d = s.diodes;
  const Matrix resolvent = (small * Matrix::Identity(s.n, s.n) - r.a).inverse();
  Matrix m = s.d;
  Vector q = r.f * zeta;
  if (s.n > 0) {
    m += r.c * resolvent * r.b;
    q += r.c * (resolvent * (r.e * zeta));
  }
  const model::PortProblem reduced = model::without_switches({std::move(m), std::move(q)}, d, switches);
  if (!reduced.m.allFinite() || !reduced.q.allFinite()) return {};
  const Vector scale = lcp::diagonal_scale(reduced.m);
  const Vector scaled = scale.asDiagonal() * reduced.q;
  const lcp::Solution solution = lcp::lemke(scale.asDiagonal() * reduced.m * scale.asDiagonal(), scaled);
  if (solution.status != lcp::Status::solved) return {};
  std::vector<int> by_value = switches;
  std::vector<int> by_basis = switches;
  for (int i = 0; i < d; ++i)
    if (solution.z[i] > solution.w[i]) by_value.push_back(i);
  std::copy_if(solution.basis.begin(), solution.basis.end(), std::back_inserter(by_basis), [d](int i) { return i < d; });
  return {by_value, by_basis};
}

}  // namespace

StaticSolution solve_static(const model::System& s, const Vector& zeta, const std::vector<char>& switch_active) {
  const int n = s.n;
  const Rest r{s.a.topLeftCorner(n, n), s.b.topRows(n), s.c.leftCols(n), s.a.topRightCorner(n, s.n_zeta), s.c.rightCols(s.n_zeta)};
  std::vector<int> switches;
  for (int i = s.diodes; i < s.ports; ++i)
    if (switch_active[static_cast<std::size_t>(i - s.diodes)] != 0) switches.push_back(i);
  const double rate = linalg::rate_of(r.a);
  StaticSolution solution;
  for (const double small : {1e-9, 1e-6, 1e-12, 1e-4}) {
    for (auto& active : proposals(s, r, zeta, switches, small * rate))
      if (least_norm_solution(s, r, active, zeta, solution) && signs_hold(s, solution)) return solution;
  }
  solution.status = StaticSolution::Status::none;
  return solution;
}

}  // namespace pwlsim::engine
