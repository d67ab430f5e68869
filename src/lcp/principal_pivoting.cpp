#include "lcp/principal_pivoting.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lcp/condition.hpp"
#include "lcp/lemke.hpp"
#include "lcp/tolerances.hpp"

namespace pwlsim::lcp {

namespace {

using linalg::Matrix;
using linalg::Vector;

constexpr double single_share = 0.6;  ///< a single pivot is preferred to a pair down to this size (Bunch and Kaufman: 0.64)

struct Pivot {
  std::vector<int> block;
  double size = 0.0;  ///< |pivot|, or root of the |determinant| of a pair
};

Pivot largest_single(const Matrix& m, const std::vector<int>& among) {
  Pivot best;
  for (const int i : among)
    if (std::abs(m(i, i)) > best.size) best = {{i}, std::abs(m(i, i))};
  return best;
}

Pivot largest_pair(const Matrix& m, const std::vector<int>& among) {
  Pivot best;
  for (const int i : among)
    for (const int j : among) {
      if (j <= i) continue;
      const double size = std::sqrt(std::abs(m(i, i) * m(j, j) - m(i, j) * m(j, i)));
      if (size > best.size) best = {{i, j}, size};
    }
  return best;
}

Pivot largest_pivot(const Matrix& m, const std::vector<int>& among) {
  Pivot single = largest_single(m, among);
  double entry = 0.0;
  for (const int i : among)
    for (const int j : among) entry = std::max(entry, std::abs(m(i, j)));
  if (single.size >= single_share * entry) return single;
  Pivot pair = largest_pair(m, among);
  return pair.size * single_share > single.size ? pair : single;
}

}  // namespace

PrincipalTableau::PrincipalTableau(Matrix m, Vector q)
    : m_(std::move(m)), q_(std::move(q)), exchanged_(static_cast<std::size_t>(q_.size()), 0) {}

std::vector<int> PrincipalTableau::basis() const {
  std::vector<int> basis;
  for (int i = 0; i < static_cast<int>(exchanged_.size()); ++i)
    if (exchanged_[static_cast<std::size_t>(i)]) basis.push_back(i);
  return basis;
}

void PrincipalTableau::exchange(const std::vector<int>& block) {
  const Matrix inverse = Matrix(m_(block, block)).inverse();
  const Matrix columns = m_(Eigen::all, block) * inverse;
  const Matrix rows = m_(block, Eigen::all);
  const Vector right = q_(block);
  m_.noalias() -= columns * rows;
  q_.noalias() -= columns * right;
  m_(block, Eigen::all) = -inverse * rows;
  q_(block) = -inverse * right;
  m_(Eigen::all, block) = columns;
  m_(block, block) = inverse;
  for (const int i : block) exchanged_[static_cast<std::size_t>(i)] ^= 1;
}

int PrincipalTableau::exchange_most(std::vector<int> wanted) {
  if (wanted.empty()) return 0;
  const auto all = static_cast<int>(wanted.size());
  if (reciprocal_condition(Eigen::PartialPivLU<Matrix>(m_(wanted, wanted))) > tolerance::good_condition) {
    exchange(wanted);
    return all;
  }
  const double smallest = tolerance::pivot * m_.cwiseAbs().maxCoeff();
  while (!wanted.empty()) {
    const Pivot pivot = largest_pivot(m_, wanted);
    if (!(pivot.size > smallest)) break;
    exchange(pivot.block);
    for (const int i : pivot.block) std::erase(wanted, i);
  }
  return all - static_cast<int>(wanted.size());
}

Solution lemke_from(const Matrix& m, const Vector& q, const std::vector<int>& previous) {
  PrincipalTableau tableau(m, q);
  tableau.exchange_most(previous);
  const Vector scale = diagonal_scale(tableau.m());
  const Solution rest = lemke(scale.asDiagonal() * tableau.m() * scale.asDiagonal(), scale.asDiagonal() * tableau.q());
  if (rest.status != Status::solved) return {rest.status, Vector::Zero(q.size()), q, {}, rest.pivots};
  const std::vector<int> old = tableau.basis();
  std::vector<int> basis;
  std::set_symmetric_difference(old.begin(), old.end(), rest.basis.begin(), rest.basis.end(), std::back_inserter(basis));
  Solution solution = at_basis(m, q, std::move(basis));
  solution.status = Status::solved;
  solution.pivots = rest.pivots;
  return solution;
}

Solution least_index(const Matrix& m, const Vector& q) {
  const auto k = static_cast<int>(q.size());
  PrincipalTableau tableau(m, q);
  const int limit = 20 * k + 200;
  for (int pivots = 0; pivots <= limit; ++pivots) {
    const double level = k > 0 ? tolerance::sign * tableau.q().cwiseAbs().maxCoeff() : 0.0;
    int first = 0;
    while (first < k && tableau.q()[first] >= -level) ++first;
    if (first == k) {
      Solution solution = at_basis(m, q, tableau.basis());
      solution.pivots = pivots;
      return solution;
    }
    const double pivot = std::abs(tableau.m()(first, first));
    if (!(pivot > tolerance::pivot * tableau.m().row(first).cwiseAbs().maxCoeff()))
      return {Status::singular, Vector::Zero(k), q, {}, pivots};
    tableau.exchange({first});
  }
  return {Status::pivot_limit, Vector::Zero(k), q, {}, limit};
}

}  // namespace pwlsim::lcp
