#include "engine/exact/static_mode.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/exact/tolerances.hpp"
#include "linalg/elimination.hpp"

namespace pwlsim::engine {

namespace {

using linalg::Vector;
using linalg::Wide;
using linalg::WideElimination;
using linalg::WideMatrix;
using linalg::WideVector;

constexpr double first_epsilon = 1e-3, last_epsilon = 1e-17, epsilon_step = 1e-3;  ///< in units of `rate`
constexpr double doubt_epsilon = 1e-9;  ///< likewise: what holds states so little hides no rounding
constexpr double input_share = 1e-8;    ///< δ/ε
constexpr int most_corrections = 20, most_static_rounds = 8;
constexpr Wide rounding = linalg::wide_clean_tolerance;  ///< of an entry of A, B, C: of the largest of what it is a sum of
constexpr Wide stagnation = 0.5L;                        ///< of two steps, one behind the other

/// K and r in units of time in which `rate` is one, each equation divided by its largest coefficient.
class ModeEquations {
 public:
  ModeEquations(const model::System& s, const Vector& zeta, const std::vector<int>& active, double rate)
      : n_(s.n), size_(n_ + static_cast<Eigen::Index>(active.size())), slow_unit_(std::sqrt(Wide{rate})), unit_(slow_unit_) {
    const auto wide = s.unrounded_matrices();
    const WideVector sources = zeta.cast<Wide>();
    const std::vector<int>& j = active;
    if (size_ > n_ && n_ > 0) unit_ = std::max(unit_, wide->b.cwiseAbs().maxCoeff());
    k_ = WideMatrix::Zero(size_, size_);
    right_ = WideVector::Zero(size_);
    k_.topLeftCorner(n_, n_) = wide->a.topLeftCorner(n_, n_) / Wide{rate};
    fastest_ = n_ > 0 ? k_.topLeftCorner(n_, n_).cwiseAbs().maxCoeff() : 0;
    k_.topRightCorner(n_, size_ - n_) = wide->b(Eigen::seqN(0, n_), j) * (unit_ / Wide{rate});
    k_.bottomLeftCorner(size_ - n_, n_) = -wide->c(j, Eigen::seqN(0, n_)) * (unit_ / Wide{rate});
    k_.bottomRightCorner(size_ - n_, size_ - n_) = -wide->d(j, j) * (unit_ * unit_ / Wide{rate});
    right_.head(n_) = -wide->a.topRightCorner(n_, s.n_zeta) * sources / Wide{rate};
    right_.tail(size_ - n_) = WideMatrix(wide->c.rightCols(s.n_zeta))(j, Eigen::all) * sources * (unit_ / Wide{rate});
    of_inputs_ = wide->d(Eigen::seqN(0, s.diodes), j);
    of_states_ = wide->c.topLeftCorner(s.diodes, n_) / unit_;
    offset_ = wide->c.topRightCorner(s.diodes, s.n_zeta) * sources / unit_;
    metric_ = WideMatrix::Identity(size_ - n_, size_ - n_) + of_inputs_.transpose() * of_inputs_;
    scale_ = WideVector::Ones(size_);
    for (Eigen::Index i = 0; i < size_; ++i) {
      const Wide largest = k_.row(i).cwiseAbs().maxCoeff();
      if (largest > 0) scale_[i] = 1 / largest;
    }
    k_ = scale_.asDiagonal() * k_;
    right_ = scale_.cwiseProduct(right_);
  }

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] Wide unit_of_inputs() const { return unit_; }
  [[nodiscard]] WideVector residual(const WideVector& v) const { return right_ - k_ * v; }
  [[nodiscard]] WideVector homogeneous_residual(const WideVector& v) const { return -(k_ * v); }

  /// A residual that rounding of K and of its terms may leave, without any regularity. States are mixed by rotations: of ξ' it is the same in all.
  [[nodiscard]] WideVector rounding_of(const WideVector& v) const {
    WideVector terms = rounding * (k_.cwiseAbs() * v.cwiseAbs() + right_.cwiseAbs());
    terms.head(n_) += rounding * fastest_ * largest_state(v) * scale_.head(n_);
    const Wide of_d = unit_ * unit_ / (slow_unit_ * slow_unit_);
    terms.tail(size_ - n_) += tolerance::dc_port_rounding * of_d * largest_input(v) * scale_.tail(size_ - n_);
    for (Eigen::Index i = 0; i < size_; ++i) terms[i] *= std::sin(static_cast<Wide>(7 * i + 1));
    return terms;
  }

  [[nodiscard]] WideElimination held(double epsilon) const {
    WideMatrix m = k_;
    for (Eigen::Index i = 0; i < n_; ++i) m(i, i) -= scale_[i] * Wide{epsilon};
    m.bottomRightCorner(size_ - n_, size_ - n_) -= Wide{epsilon * input_share} * scale_.tail(size_ - n_).asDiagonal() * metric_;
    return {std::move(m), 0};
  }

  /// u with the least |u|² + |y|² at these states, y of the diodes, without regard to the equations.
  [[nodiscard]] WideVector least_inputs(const WideVector& xi) const {
    const WideVector right = -of_inputs_.transpose() * (of_states_ * xi + offset_);
    return WideElimination(metric_, 0).solve(right);
  }

  [[nodiscard]] Wide largest_state(const WideVector& v) const { return n_ > 0 ? v.head(n_).cwiseAbs().maxCoeff() : 0; }
  /// What ξ might be: a capacitor takes the voltage of its port.
  [[nodiscard]] Wide scale_of_states(const WideVector& v) const {
    return std::max(largest_state(v), largest_input(v) * unit_ / slow_unit_);
  }
  [[nodiscard]] Wide largest_input(const WideVector& v) const { return size_ > n_ ? v.tail(size_ - n_).cwiseAbs().maxCoeff() : 0; }

  [[nodiscard]] Wide error(const WideVector& v) const {
    const Wide largest = v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0;
    const WideVector rest = residual(v);
    Wide worst = 0;
    for (Eigen::Index i = 0; i < size_; ++i) {
      const Wide terms = k_.row(i).cwiseAbs().sum() * largest + std::abs(right_[i]);
      if (!(std::abs(rest[i]) <= worst * terms)) worst = std::abs(rest[i]) / terms;
    }
    return worst;
  }

 private:
  Eigen::Index n_, size_;
  Wide slow_unit_, unit_;  ///< of u beside the slowest states, and beside the fastest: the one in use
  Wide fastest_ = 0;       ///< entry of A
  WideMatrix k_, of_inputs_, of_states_, metric_;
  WideVector offset_;
  WideVector right_, scale_;
};

bool converges(const ModeEquations& equations, const WideElimination& held, WideVector& v) {
  if (v.size() == 0) return true;
  Wide xi_before = 0, u_before = 0;
  for (int i = 0; i < most_corrections; ++i) {
    const WideVector step = held.solve(equations.residual(v));
    if (!step.allFinite()) return false;
    v += step;
    const Wide of_xi = equations.largest_state(step), of_u = equations.largest_input(step), largest = v.cwiseAbs().maxCoeff();
    const bool xi_rests = of_xi <= std::max(tolerance::same_value * equations.largest_state(v), tolerance::dc_small_change * largest);
    const bool u_rests = of_u <= std::max(tolerance::same_value * equations.largest_input(v), tolerance::dc_small_change * largest);
    const bool decreases = (!xi_rests && of_xi <= stagnation * xi_before) || (!u_rests && of_u <= stagnation * u_before);
    xi_before = of_xi;
    u_before = of_u;
    if (i == 0 || decreases || equations.error(v) > tolerance::dc_residual) continue;
    if (xi_rests && u_rests) return true;
    if (of_xi > tolerance::dc_largest_noise * equations.scale_of_states(v) || of_u > tolerance::dc_largest_noise * largest) continue;
    const WideVector noise = held.solve(equations.rounding_of(v));
    if (of_xi <= equations.largest_state(noise) && of_u <= equations.largest_input(noise)) return true;
  }
  return false;
}

/// What u weighs is taken from ξ's share: so u starts anew where it came to, until ξ is the nearest; after one round, with the least u that this ξ
/// allows. Where −K is not monotone, what ξ is short of on its way ends in the kernel: there the last round starts at its end.
bool settles(const ModeEquations& equations, const WideElimination& held, const WideVector& x0, bool is_monotone, WideVector& v) {
  WideVector xi = x0;
  WideVector u = equations.least_inputs(x0);
  bool rests = false;
  for (int round = 0; round < most_static_rounds && !rests; ++round) {
    v << x0, u;
    if (!converges(equations, held, v)) return false;
    rests = round > 1 && (v.head(xi.size()) - xi).norm() <= tolerance::same_value * xi.norm();
    xi = v.head(xi.size());
    u = round == 0 ? equations.least_inputs(xi) : WideVector(v.tail(u.size()));
  }
  if (is_monotone) return true;
  v << xi, equations.least_inputs(xi);
  return converges(equations, held, v);
}

/// Whether a vector without any regularity has a part that only E holds.
bool leaves_states_open(const ModeEquations& equations, const WideElimination& held) {
  WideVector v(equations.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = std::sin(Wide{1} + Wide{37} * static_cast<Wide>(i * i + 1));
  const Wide before = equations.largest_state(v);
  for (int i = 0; i < most_corrections; ++i) v += held.solve(equations.homogeneous_residual(v));
  return equations.largest_state(v) > tolerance::dc_free_share * before;
}

}  // namespace

StaticModeSolution solve_static_mode(const model::System& system, const Vector& zeta, const std::vector<int>& active, const Vector& x0,
                                     double rate) {
  StaticModeSolution result;
  result.u = WideVector::Zero(system.ports);
  const ModeEquations equations(system, zeta, active, rate);
  WideVector v = WideVector::Zero(equations.size());
  v.head(system.n) = x0.cast<Wide>();
  for (double epsilon = first_epsilon; epsilon >= last_epsilon && !result.exists; epsilon *= epsilon_step) {
    const WideElimination held = equations.held(epsilon);
    result.exists = settles(equations, held, x0.cast<Wide>(), system.passive, v);
    if (!v.allFinite()) return result;
    if (result.exists) result.unique = system.n == 0 || !leaves_states_open(equations, held);
  }
  result.xi = v.head(system.n);
  for (std::size_t i = 0; i < active.size(); ++i)
    result.u[active[i]] = v[system.n + static_cast<Eigen::Index>(i)] * equations.unit_of_inputs();
  return result;
}

double rounding_share(const model::System& system, const Vector& zeta, const std::vector<int>& active, double rate, const WideVector& xi,
                      const WideVector& u) {
  const ModeEquations equations(system, zeta, active, rate);
  WideVector v(equations.size());
  v << xi, u(active) / equations.unit_of_inputs();
  if (!(equations.largest_state(v) > 0)) return 0.0;
  const WideVector noise = equations.held(doubt_epsilon).solve(equations.rounding_of(v));
  return static_cast<double>(equations.largest_state(noise) / equations.largest_state(v));
}

}  // namespace pwlsim::engine
