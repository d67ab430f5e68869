#include "property/resistive_network.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace pwlsim::test {
namespace {

using Real = ResistiveNetwork::Real;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// Share of terms that cancelled, before a potential or current was left, in what counts as its size.
constexpr Real cancelled = 1e-4L;

/// One position of the diodes.
class Trial {
 public:
  Trial(const ResistiveNetwork& network, ResistiveNetwork::Position position, Real slack)
      : network_(network),
        position_(position),
        slack_(slack),
        tree_(at(network.nodes), -1),
        above_(at(network.nodes)),
        edges_(at(network.nodes)) {}

  bool solves() { return grow_forest() && join_parts() && blocking_are_tied() && solve_trees() && none_forward() && none_backward(); }
  std::vector<Real> potentials() const { return e_; }

 private:
  /// An edge of the forest as one of its ends sees it: v(to) = v(here) + rise.
  struct Edge {
    int to = 0;
    Real rise = 0;
    int diode = -1;
  };

  bool conducts(std::size_t diode) const { return (position_ >> diode & 1U) != 0; }

  /// False where conducting diodes close a loop.
  bool grow_forest() {
    std::vector<int> set(at(network_.nodes));
    std::iota(set.begin(), set.end(), 0);
    const auto join = [&](int p, int n, Real voltage, int diode) {
      const int a = set[at(p)], b = set[at(n)];
      if (a == b) return false;
      std::replace(set.begin(), set.end(), a, b);
      edges_[at(p)].push_back({n, -voltage, diode});
      edges_[at(n)].push_back({p, voltage, diode});
      return true;
    };
    for (const auto& item : network_.rigid) join(item.p, item.n, item.voltage, -1);
    for (std::size_t d = 0; d < network_.diodes.size(); ++d)
      if (conducts(d) && !join(network_.diodes[d].p, network_.diodes[d].n, 0, static_cast<int>(d))) return false;
    for (int node = 0; node < network_.nodes; ++node)
      if (tree_[at(node)] < 0) climb(node);
    return true;
  }

  /// Numbers a new tree from its root; nodes stand in `order_` after the one above them.
  void climb(int root) {
    const std::size_t first = order_.size();
    tree_[at(root)] = trees_;
    rise_.resize(at(network_.nodes));
    order_.push_back(root);
    above_[at(root)] = {-1, 0, -1};
    for (std::size_t next = first; next < order_.size(); ++next) {
      const int node = order_[next];
      for (const Edge& edge : edges_[at(node)]) {
        if (tree_[at(edge.to)] >= 0) continue;
        tree_[at(edge.to)] = trees_;
        rise_[at(edge.to)] = rise_[at(node)] + edge.rise;
        above_[at(edge.to)] = {node, 0, edge.diode};
        order_.push_back(edge.to);
      }
    }
    ++trees_;
  }

  /// Parts are trees that conductances tie together.
  bool join_parts() {
    part_.resize(at(trees_));
    std::iota(part_.begin(), part_.end(), 0);
    for (const auto& item : network_.conductances) {
      const int a = part_[at(tree_[at(item.p)])], b = part_[at(tree_[at(item.n)])];
      if (item.conductance > 0 && a != b) std::replace(part_.begin(), part_.end(), std::max(a, b), std::min(a, b));
    }
    return true;
  }

  bool blocking_are_tied() const {
    for (std::size_t d = 0; d < network_.diodes.size(); ++d)
      if (!conducts(d) && part_[at(tree_[at(network_.diodes[d].p)])] != part_[at(tree_[at(network_.diodes[d].n)])]) return false;
    return true;
  }

  /// Potentials e and what their rounding is relative to. The first tree of a part is at zero.
  /// Trees are eliminated one after the other by the star-mesh transformation: no conductance is ever subtracted, so that the smallest
  /// beside the largest keep all their digits.
  bool solve_trees() {
    RealMatrix mesh = RealMatrix::Zero(trees_, trees_);
    RealVector e = RealVector::Zero(trees_), terms = e;
    for (const auto& item : network_.conductances) {
      const int p = tree_[at(item.p)], n = tree_[at(item.n)];
      if (p == n) continue;
      const Real own = item.conductance * (rise_[at(item.p)] - rise_[at(item.n)]) + item.offset;
      mesh(p, n) += item.conductance;
      mesh(n, p) += item.conductance;
      e[p] -= own;
      e[n] += own;
      terms[p] += std::abs(own);
      terms[n] += std::abs(own);
    }
    for (int tree = trees_ - 1; tree >= 0; --tree)
      if (part_[at(tree)] != tree) eliminate(tree, mesh, e, terms);
    for (int tree = 0; tree < trees_; ++tree) {
      if (part_[at(tree)] == tree) {
        e[tree] = terms[tree] = 0;
        continue;
      }
      e[tree] += mesh.row(tree).head(tree).dot(e.head(tree));
      terms[tree] += mesh.row(tree).head(tree).dot(terms.head(tree));
    }
    for (int node = 0; node < network_.nodes; ++node) {
      e_.push_back(e[tree_[at(node)]] + rise_[at(node)]);
      size_.push_back(std::abs(e[tree_[at(node)]]) + std::abs(rise_[at(node)]));
      noisy_.push_back(size_.back() + cancelled * terms[tree_[at(node)]]);
    }
    return true;
  }

  /// Its neighbours that are left have lower numbers. Its row then holds their shares in its potential, its entry of e the rest of that.
  static void eliminate(int tree, RealMatrix& mesh, RealVector& e, RealVector& terms) {
    const Real sum = mesh.row(tree).head(tree).sum();
    const Eigen::Matrix<Real, 1, Eigen::Dynamic> share = mesh.row(tree).head(tree) / sum;
    mesh.topLeftCorner(tree, tree) += mesh.col(tree).head(tree) * share;
    e.head(tree) += share.transpose() * e[tree];
    terms.head(tree) += share.transpose() * terms[tree];
    mesh.row(tree).head(tree) = share;
    e[tree] /= sum;
    terms[tree] /= sum;
  }

  bool none_forward() const {
    for (std::size_t d = 0; d < network_.diodes.size(); ++d) {
      const auto p = at(network_.diodes[d].p), n = at(network_.diodes[d].n);
      if (!conducts(d) && e_[p] - e_[n] > slack_ * (noisy_[p] + noisy_[n])) return false;
    }
    return true;
  }

  bool none_backward() const {
    std::vector<Real> leaving(at(network_.nodes)), terms = leaving;
    for (const auto& item : network_.conductances) {
      const auto p = at(item.p), n = at(item.n);
      const Real current = item.conductance * (e_[p] - e_[n]) + item.offset;
      const Real size = item.conductance * (size_[p] + size_[n]) + std::abs(item.offset);
      leaving[p] += current;
      leaving[n] -= current;
      terms[p] += size;
      terms[n] += size;
    }
    Real all = 0;
    for (const auto& item : network_.conductances) all += std::abs(item.offset);
    for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
      const Edge& edge = above_[at(*node)];
      if (edge.to < 0) continue;
      const Real upwards = -leaving[at(*node)];
      if (edge.diode >= 0) {
        const Real current = network_.diodes[at(edge.diode)].p == *node ? upwards : -upwards;
        if (current < -slack_ * (terms[at(*node)] + cancelled * all)) return false;
      }
      leaving[at(edge.to)] += leaving[at(*node)];
      terms[at(edge.to)] += terms[at(*node)];
    }
    return true;
  }

  const ResistiveNetwork& network_;
  const ResistiveNetwork::Position position_;
  const Real slack_;
  int trees_ = 0;
  std::vector<int> tree_, order_, part_;
  std::vector<Real> rise_;   ///< of a node above the root of its tree
  std::vector<Edge> above_;  ///< of a node: the edge towards the root
  std::vector<std::vector<Edge>> edges_;
  std::vector<Real> e_;
  std::vector<Real> size_;   ///< of the potentials that e is a difference of
  std::vector<Real> noisy_;  ///< and of what cancelled in them
};

}  // namespace

std::vector<Real> ResistiveNetwork::potentials(Position position, Real slack) const {
  Trial trial(*this, position, slack);
  return trial.solves() ? trial.potentials() : std::vector<Real>{};
}

std::vector<Real> ResistiveNetwork::solve(Position& first, Real slack) const {
  for (int distance = 0; distance <= static_cast<int>(diodes.size()); ++distance)
    for (Position change = 0; change < positions(); ++change) {
      if (std::popcount(change) != distance) continue;
      auto solution = potentials(first ^ change, slack);
      if (solution.empty()) continue;
      first ^= change;
      return solution;
    }
  return {};
}

}  // namespace pwlsim::test
