#include "engine/sparse/windings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/disjoint_sets.hpp"
#include "linalg/dense.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::engine::sparse {

namespace {

using linalg::Wide;
using linalg::WideMatrix;
using model::tolerance::coupling_rank;

}  // namespace

/// N = U D Uᵀ of a symmetric matrix with ±1 on its diagonal; a pivot below `coupling_rank` is zero.
struct Windings::Decoupling {
  explicit Decoupling(WideMatrix rest);
  std::vector<Eigen::Index> order;  ///< of the pivots
  WideMatrix u;                     ///< rows and columns in that order
  linalg::WideVector d;
  bool possible = true;  ///< false: a negative pivot, or a rest beside pivots of zero
};

Windings::Decoupling::Decoupling(WideMatrix rest)
    : u(WideMatrix::Identity(rest.rows(), rest.rows())), d(linalg::WideVector::Zero(rest.rows())) {
  const Eigen::Index n = rest.rows();
  order.resize(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (Eigen::Index j = 0; j < n; ++j) {
    Eigen::Index pivot = 0;
    const Wide largest = rest.diagonal().tail(n - j).cwiseAbs().maxCoeff(&pivot);
    pivot += j;
    if (largest < coupling_rank) {
      possible &= rest.bottomRightCorner(n - j, n - j).cwiseAbs().maxCoeff() <= 1e3L * coupling_rank;
      return;
    }
    rest.row(j).swap(rest.row(pivot));
    rest.col(j).swap(rest.col(pivot));
    u.row(j).head(j).swap(u.row(pivot).head(j));
    std::swap(order[static_cast<std::size_t>(j)], order[static_cast<std::size_t>(pivot)]);
    d[j] = rest(j, j);
    possible &= d[j] > 0;
    const Eigen::Index below = n - j - 1;
    u.col(j).tail(below) = rest.col(j).tail(below) / d[j];
    rest.bottomRightCorner(below, below) -= d[j] * u.col(j).tail(below) * u.col(j).tail(below).transpose();
  }
}

Windings::Windings(const model::Network& network) {
  const auto n = network.inductors.size();
  DisjointSets sets(static_cast<int>(n));
  for (const auto& k : network.couplings) sets.join(k.inductor_a, k.inductor_b);
  std::map<int, std::vector<int>> groups;
  for (int i = 0; i < static_cast<int>(n); ++i) {
    d_.push_back(network.inductors[static_cast<std::size_t>(i)].inductance);
    groups[sets.find(i)].push_back(i);
  }
  for (auto* sums : {&w_, &w_columns_, &u_columns_, &fluxes_}) {
    sums->resize(n);
    for (int i = 0; i < static_cast<int>(n); ++i) (*sums)[static_cast<std::size_t>(i)] = {{i, 1.0}};
  }
  for (const auto& [root, group] : groups)
    if (group.size() > 1) decouple(network, group);
}

void Windings::decouple(const model::Network& network, const std::vector<int>& group) {
  const auto n = static_cast<Eigen::Index>(group.size());
  const auto place = [&](int inductor) { return std::lower_bound(group.begin(), group.end(), inductor) - group.begin(); };
  WideMatrix coefficients = WideMatrix::Zero(n, n);
  linalg::WideVector root(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Wide inductance = network.inductors[static_cast<std::size_t>(group[static_cast<std::size_t>(i)])].inductance;
    coefficients(i, i) = inductance < 0 ? -1 : 1;
    root[i] = std::sqrt(std::abs(inductance));
  }
  for (const auto& k : network.couplings) {
    const Eigen::Index first = place(k.inductor_a), second = place(k.inductor_b);
    if (first == n || group[static_cast<std::size_t>(first)] != k.inductor_a) continue;
    coefficients(first, second) += k.coefficient;
    coefficients(second, first) += k.coefficient;
  }
  const Decoupling parts(coefficients);
  possible_ &= parts.possible || coefficients.diagonal().minCoeff() < 0;
  take(parts, coefficients.diagonal(), root, group);
}

/// From the matrix with unit diagonal to the inductors' own units.
void Windings::take(const Decoupling& parts, const linalg::WideVector& signs, const linalg::WideVector& root,
                    const std::vector<int>& group) {
  const auto n = static_cast<Eigen::Index>(group.size());
  const WideMatrix w = parts.u.triangularView<Eigen::UnitLower>().solve(WideMatrix::Identity(n, n));
  const auto slot = [](std::vector<Sum>& sums, int i) -> Sum& { return sums[static_cast<std::size_t>(i)]; };
  const auto add = [](Sum& sum, int index, Wide weight) {
    if (weight != 0) sum.push_back({index, static_cast<double>(weight)});
  };
  for (const int i : group)
    for (auto* sums : {&w_, &w_columns_, &u_columns_, &fluxes_}) slot(*sums, i).clear();
  for (Eigen::Index row = 0; row < n; ++row) {
    const Eigen::Index of_row = parts.order[static_cast<std::size_t>(row)];
    const int j = group[static_cast<std::size_t>(of_row)];
    d_[static_cast<std::size_t>(j)] = static_cast<double>(parts.d[row] * root[of_row] * root[of_row]);
    for (Eigen::Index column = 0; column <= row; ++column) {
      const Eigen::Index of_column = parts.order[static_cast<std::size_t>(column)];
      const int i = group[static_cast<std::size_t>(of_column)];
      const Wide ratio = root[of_row] / root[of_column];
      add(slot(w_, j), i, ratio * w(row, column));
      add(slot(w_columns_, i), j, ratio * w(row, column));
      add(slot(u_columns_, i), j, ratio * parts.u(row, column));
      add(slot(fluxes_, j), i, signs[of_row] * parts.u(row, column) * parts.d[column] / ratio);
    }
  }
}

}  // namespace pwlsim::engine::sparse
