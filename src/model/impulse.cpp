#include "model/impulse.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/lemke.hpp"
#include "linalg/factorisations.hpp"
#include "model/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::model {

namespace {

/// Orders 1 … L tried in turn. Time in units of 1/‖A‖ and u, y in units of √‖A‖, in which B, C and D are of one size.
class Impulses {
 public:
  Impulses(const System& system, double rate, const IndexSet& active, double noise)
      : s_(system), noise_(noise), root_(std::sqrt(rate)), blocked_(blocked_ports(system, active)) {
    a_ = system.a / rate;
    c_ = system.c / root_;
    for (int i = 0; i < system.ports; ++i)
      if (active.contains(i)) active_.push_back(i);
    effect_.push_back(system.b / root_);
    markov_.push_back(system.d);
  }

  [[nodiscard]] bool is_blocked(int port) const { return std::find(blocked_.begin(), blocked_.end(), port) != blocked_.end(); }

  bool solve(int order, const Vector& jump) {
    while (static_cast<int>(effect_.size()) < order) {
      markov_.push_back(linalg::clean_product(c_, effect_.back()));
      effect_.push_back(linalg::clean_product(a_, effect_.back()));
    }
    const auto size = jump.size();
    const auto q = static_cast<Eigen::Index>(active_.size());
    Matrix equations = Matrix::Zero(size + order * q, order * q);
    for (int j = 1; j <= order; ++j) {
      const auto column = (j - 1) * q;  // of u^{−j}
      equations.block(0, column, size, q) = effect_[at(j - 1)](Eigen::all, active_);
      for (int m = 1; m <= j; ++m) equations.block(size + (m - 1) * q, column, q, q) = markov_[at(j - m)](active_, active_);
    }
    Vector scale = equations.colwise().norm().transpose();
    for (double& norm : scale) norm = norm > 0.0 ? 1.0 / norm : 1.0;
    equations = equations * scale.asDiagonal();
    Vector right = Vector::Zero(equations.rows());
    right.head(size) = jump;
    Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
    decomposition.setThreshold(tolerance::rank);  // before compute(), which leaves undone what its rank does not call for
    decomposition.compute(equations);
    const Vector weights = decomposition.solve(right);
    if (!((equations * weights - right).norm() <= tolerance::impulse * jump.norm() + noise_)) return false;
    // Of each weight, what an error of the jump makes of it: where ports can nearly replace one another, far more than its share.
    error_ = noise_ * decomposition.pseudoInverse().rowwise().norm();
    take(order, scale, weights);
    if (order == 1 && decomposition.rank() < q) prefer_allowed(equations, scale, weights);
    return true;
  }

  /// u^{−1} in the units of the system.
  [[nodiscard]] Vector weight() const { return u_.front() / root_; }

  [[nodiscard]] int sign_of_input(int port) const {
    for (std::size_t j = u_.size(); j-- > 0;)
      if (std::abs(u_[j][port]) > size_[j][port]) return u_[j][port] > 0.0 ? 1 : -1;
    return 0;
  }

  [[nodiscard]] int sign_of_output(int port) const {
    const auto order = static_cast<int>(u_.size());
    for (int m = order; m >= 1; --m) {
      double sum = 0.0, size = 0.0;
      for (int j = m; j <= order; ++j) {
        const auto row = markov_[at(j - m)].row(port);
        sum += row.dot(u_[at(j - 1)]);
        size += row.cwiseAbs().dot(size_[at(j - 1)]);
      }
      if (std::abs(sum) > size) return sum > 0.0 ? 1 : -1;
    }
    return 0;
  }

 private:
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

  void take(int order, const Vector& scale, const Vector& weights) {
    const auto q = static_cast<Eigen::Index>(active_.size());
    u_.assign(at(order), Vector::Zero(s_.ports));
    size_.assign(at(order), Vector::Zero(s_.ports));
    for (int j = 1; j <= order; ++j)
      for (Eigen::Index i = 0; i < q; ++i) {
        const auto from = (j - 1) * q + i;
        u_[at(j - 1)][active_[at(i)]] = scale[from] * weights[from];
        size_[at(j - 1)][active_[at(i)]] = scale[from] * (tolerance::impulse * weights.norm() + error_[from]);
      }
  }

  /// Where ports can share an impulse in several ways, one that every diode allows: with w = G·weights the impulses of the diodes and Y what
  /// is open, least |t| with w + G Y t ≥ 0, that is t = (G Y)ᵀ λ with 0 ≤ λ ⊥ G Y (G Y)ᵀ λ + w ≥ 0.
  void prefer_allowed(const Matrix& equations, const Vector& scale, const Vector& weights) {
    Vector impulse(s_.diodes);
    Matrix reads = Matrix::Zero(s_.diodes, weights.size());
    for (int i = 0; i < s_.diodes; ++i) {
      if (is_blocked(i)) {
        impulse[i] = 0.0;
        continue;
      }
      const auto own = std::find(active_.begin(), active_.end(), i);
      const int sign = own != active_.end() ? sign_of_input(i) : sign_of_output(i);
      if (own != active_.end())
        reads(i, own - active_.begin()) = 1.0;
      else
        reads.row(i) = Matrix(s_.d(i, active_) * scale.asDiagonal()).row(0).normalized();  // as it is where it is zero
      impulse[i] = sign == 0 ? 0.0 : reads.row(i).dot(weights);
    }
    if ((impulse.array() >= 0.0).all()) return;
    const Matrix open = linalg::null_space(equations, tolerance::rank);
    const Matrix moved = linalg::clean_product(reads, open);
    const lcp::Solution solution = lcp::lemke(moved * moved.transpose(), impulse);
    if (solution.status == lcp::Status::solved) take(1, scale, weights + open * (moved.transpose() * solution.z));
  }

  const System& s_;
  double noise_, root_;
  std::vector<int> blocked_;  ///< valves: no sign of theirs counts
  std::vector<int> active_;
  Matrix a_, c_;
  std::vector<Matrix> effect_;  ///< A^j B
  std::vector<Matrix> markov_;
  Vector error_;                  ///< of the weights
  std::vector<Vector> u_, size_;  ///< u^{−j−1} and what counts as zero of it
};

}  // namespace

Impulse find_impulse(const System& system, double rate, const IndexSet& active, const Vector& jump, double noise) {
  Impulses impulses(system, rate, active, noise);
  Impulse result;
  result.weight = Vector::Zero(system.ports);
  for (int order = 1; order <= std::max(system.n, 1); ++order) {
    if (!impulses.solve(order, jump)) continue;
    result.order = order;
    result.weight = impulses.weight();
    for (int i = 0; i < system.diodes; ++i)
      result.sign.push_back(impulses.is_blocked(i) ? 0 : active.contains(i) ? impulses.sign_of_input(i) : impulses.sign_of_output(i));
    break;
  }
  return result;
}

}  // namespace pwlsim::model
