#include "lcp/principal_pivoting.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/condition.hpp"
#include "lcp/lemke.hpp"
#include "lcp/tolerances.hpp"
#include "linalg/factorisations.hpp"

namespace pwlsim::lcp {

using linalg::Matrix;
using linalg::Vector;

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
