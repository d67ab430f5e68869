#include "model/rcp.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/lemke.hpp"
#include "linalg/factorisations.hpp"
#include "model/certificate.hpp"
#include "model/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::model {

namespace {

constexpr double share_of_norm = 0.1;
/// In units of the rate, s at which G(s) shows what it is from there on, and far enough for what is small in D to show, too.
constexpr double large_s_factors[] = {1e4, 1e10, 1e16};
constexpr std::size_t most_own_ports = 10;

/// With the valves that block: they stand where switches and no signs have them.
std::vector<int> active_switches(const System& system, const IndexSet& wanted) {
  std::vector<int> active;
  for (const int port : blocked_ports(system, wanted))
    if (wanted.contains(port)) active.push_back(port);
  for (int i = system.diodes; i < system.ports; ++i)
    if (wanted.contains(i)) active.push_back(i);
  return active;
}

/// Of G(s) above what u does to x': without ports that neither move anything nor are moved, and the first of every group of ports whose rows and
/// columns are equal up to one sign.
std::vector<int> ports_of_their_own(const Matrix& effects) {
  const Eigen::Index k = effects.cols(), n = effects.rows() - k;
  const Matrix m = effects.topRows(k), on_state = effects.bottomRows(n);
  const auto differ = [](const Vector& a, const Vector& b) { return !((a - b).norm() <= tolerance::twin * a.norm()); };
  const auto is_twin = [&](int i, int j) {
    const double sign = m(i, j) < 0.0 ? -1.0 : 1.0;
    return !differ(m.col(i), sign * m.col(j)) && !differ(m.row(i), sign * m.row(j)) && !differ(on_state.col(i), sign * on_state.col(j));
  };
  std::vector<int> ports;
  for (int i = 0; i < k && ports.size() <= most_own_ports; ++i) {
    if (effects.col(i).isZero(0.0) && m.row(i).isZero(0.0)) continue;
    if (std::none_of(ports.begin(), ports.end(), [&](int j) { return is_twin(j, i); })) ports.push_back(i);
  }
  return ports;
}

/// A principal pivot on `ports` (their own block is invertible), of a matrix with more rows than ports: what cancels is zero.
void exchange(Matrix& m, const std::vector<Eigen::Index>& ports) {
  const Matrix inverse = Matrix(m(ports, ports)).inverse();
  const Matrix rows = -inverse * m(ports, Eigen::all), row_sizes = inverse.cwiseAbs() * m(ports, Eigen::all).cwiseAbs();
  const Matrix columns = m(Eigen::all, ports);
  m = linalg::cleaned(m + columns * rows, m.cwiseAbs() + columns.cwiseAbs() * row_sizes);
  m(Eigen::all, ports) = columns * inverse;
  m(ports, Eigen::all) = rows;
  m(ports, ports) = inverse;
}

}  // namespace

RationalProblem::RationalProblem(const System& system) : system_(system), rate_(linalg::rate_of(system.a)) {}

/// M(s) = D + Σ C A^{j−1} B s^{−j}, every term that is rounding set to zero: uncleaned noise is amplified by a power of s, and s could then be
/// neither large nor small enough.
Matrix RationalProblem::port_matrix(double s) {
  const int n = system_.n;
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
        if (std::abs(term.data()[i]) <= tolerance::series_noise * term_bound.data()[i]) term.data()[i] = 0.0;
      markov_.push_back(std::move(term));
      w = system_.a * w / rate_;
      bound = size_a * bound / rate_;
    }
  }
  Matrix m = system_.d;
  double power = 1.0 / s;
  for (const Matrix& term : markov_) {
    m += term * power;
    power *= rate_ / s;
  }
  return m;
}

/// q(s) = Σ C A^j x s^{−j}, cleaned like M(s).
PortProblem RationalProblem::at(const double* x, double s) {
  PortProblem problem;
  const int n = system_.n;
  const int size = system_.size();
  const int k = system_.ports;
  problem.m = port_matrix(s);
  Vector z = Eigen::Map<const Vector>(x, size);
  Vector bound = z.cwiseAbs();
  bound.head(n).array() += share_of_norm * z.head(n).norm();
  const Matrix size_a = system_.a.cwiseAbs();
  const Matrix size_c = system_.c.cwiseAbs();
  const Vector row_norm = system_.c.rowwise().norm();
  problem.q = Vector::Zero(k);
  double power = 1.0;
  for (int j = 0; j <= size; ++j) {
    const Vector value = system_.c * z;
    const Vector level = tolerance::series_noise * (size_c * bound + share_of_norm * z.norm() * row_norm);
    for (int i = 0; i < k; ++i)
      if (std::abs(value[i]) > level[i]) problem.q[i] += value[i] * power;
    z = system_.a * z / rate_;
    bound = size_a * bound / rate_;
    power *= rate_ / s;
  }
  return problem;
}

/// G(s), and below it B: what u does to y and to x', once the switch ports `active` are solved out. Where that takes diodes, u and y of
/// these have changed places. Empty where nothing does it.
Matrix RationalProblem::effects(double s, std::vector<int> active) {
  const Eigen::Index d = system_.diodes, k = system_.ports, n = system_.n;
  Matrix m(k + n, k);
  m << port_matrix(s), system_.b.topRows(n);
  while (!active.empty()) {
    const int port = active.back();
    active.pop_back();
    if (m(port, port) != 0.0) {
      exchange(m, {port});
      continue;
    }
    Eigen::Index partner = port;
    double most = 0.0;
    for (Eigen::Index i = 0; i < k; ++i) {
      const double weight = std::abs(m(port, i) * m(i, port));
      const bool is_free = i < d || std::find(active.begin(), active.end(), i) != active.end();
      if (!is_free || weight <= most) continue;
      most = weight;
      partner = i;
    }
    if (partner == port) return {};
    std::erase(active, static_cast<int>(partner));
    exchange(m, {partner, port});
  }
  Matrix effects(d + n, d);
  effects << m.topLeftCorner(d, d), m.bottomLeftCorner(n, d);
  return effects;
}

bool RationalProblem::is_uniquely_solvable(const IndexSet& wanted) {
  std::vector<int> first_ports;
  for (const double factor : large_s_factors) {
    Matrix m = effects(rate_ * factor, active_switches(system_, wanted));
    for (const int port : blocked_ports(system_, wanted)) {
      if (m.size() == 0) break;
      m.row(port).setZero();
      m.col(port).setZero();
    }
    if (m.size() == 0 || !m.allFinite()) return false;
    const std::vector<int> ports = ports_of_their_own(m);
    if (ports.size() > most_own_ports || (factor != large_s_factors[0] && ports != first_ports)) return false;
    if (!has_positive_principal_minors(m(ports, ports))) return false;
    first_ports = ports;
  }
  return true;
}

std::vector<IndexSet> RationalProblem::candidates(const double* x, double s, const IndexSet& wanted) {
  PortProblem problem = at(x, s);
  problem = without_switches(problem, system_.diodes, active_switches(system_, wanted));
  take_out(blocked_ports(system_, wanted), problem.m, problem.q);
  if (!problem.m.allFinite() || !problem.q.allFinite()) return {};
  const auto k = problem.q.size();
  const Vector scale = lcp::diagonal_scale(problem.m);
  const Vector q = scale.asDiagonal() * problem.q;
  const Matrix scaled = scale.asDiagonal() * problem.m * scale.asDiagonal();
  lcp::Solution solution = lcp::lemke(scaled, q);
  pivots_ += static_cast<std::uint64_t>(solution.pivots);
  if (solution.status != lcp::Status::solved) {
    // Rounding of a singular problem (series and parallel diodes) can leave it without a solution; a small multiple of 1 restores one.
    solution = lcp::lemke(scaled + tolerance::regularisation * Matrix::Identity(k, k), q);
    pivots_ += static_cast<std::uint64_t>(solution.pivots);
  }
  if (solution.status != lcp::Status::solved) return {};
  const double tie = tolerance::port_tie * (k > 0 ? q.cwiseAbs().maxCoeff() : 0.0);
  IndexSet by_value = wanted;
  IndexSet by_basis = wanted;
  for (int i = 0; i < system_.diodes; ++i) {
    const bool tied = solution.z[i] <= tie && solution.w[i] <= tie;
    if (!tied) by_value.set(i, solution.z[i] > solution.w[i]);
    by_basis.set(i, false);
  }
  for (const int i : solution.basis)
    if (i < system_.diodes) by_basis.set(i, true);
  hold_blocked(system_, by_value);
  hold_blocked(system_, by_basis);
  if (by_value == by_basis) return {by_value};
  return {by_value, by_basis};
}

}  // namespace pwlsim::model
