#include "linalg/constraint_basis.hpp"

#include <algorithm>

#include "linalg/factorisations.hpp"

namespace pwlsim::linalg {

namespace {

/// y := (1 − factor·v vᵀ) y.
void reflect(const Wide* v, Wide factor, Wide* y, Eigen::Index n) {
  Wide sum = 0;
  for (Eigen::Index i = 0; i < n; ++i) sum += v[i] * y[i];
  if (sum == 0) return;
  sum *= factor;
  for (Eigen::Index i = 0; i < n; ++i) y[i] -= sum * v[i];
}

}  // namespace

ConstraintBasis::ConstraintBasis(const WideMatrix& rows) : upper_(WideMatrix::Zero(rows.rows(), rows.rows())) {
  const Eigen::Index k = rows.rows(), n = rows.cols();
  WideMatrix m = rows.transpose();  // its columns become the vectors of the reflections
  WideVector factor(k);
  std::vector<char> used(static_cast<std::size_t>(n), 0), done(static_cast<std::size_t>(k), 0);
  for (Eigen::Index r = 0; r < k; ++r) {
    Eigen::Index pivot = 0, constraint = 0;
    Wide largest = -1;
    for (Eigen::Index c = 0; c < k; ++c)
      for (Eigen::Index i = 0; i < n && done[static_cast<std::size_t>(c)] == 0; ++i)
        if (used[static_cast<std::size_t>(i)] == 0 && std::abs(m(i, c)) > largest) {
          largest = std::abs(m(i, c));
          pivot = i;
          constraint = c;
        }
    Wide* v = m.data() + constraint * n;
    for (Eigen::Index i = 0; i < r; ++i) {
      upper_(i, r) = v[pivots_[static_cast<std::size_t>(i)]];
      v[pivots_[static_cast<std::size_t>(i)]] = 0;
    }
    const Wide norm = m.col(constraint).norm();
    upper_(r, r) = v[pivot] > 0 ? -norm : norm;
    v[pivot] -= upper_(r, r);
    factor[r] = 2 / m.col(constraint).squaredNorm();
    used[static_cast<std::size_t>(pivot)] = done[static_cast<std::size_t>(constraint)] = 1;
    pivots_.push_back(pivot);
    order_.push_back(constraint);
    for (Eigen::Index c = 0; c < k; ++c)
      if (done[static_cast<std::size_t>(c)] == 0) reflect(v, factor[r], m.data() + c * n, n);
  }
  q_ = WideMatrix::Identity(n, n);
  for (Eigen::Index r = k; r-- > 0;)
    for (Eigen::Index j = 0; j < n; ++j) reflect(m.data() + order_[static_cast<std::size_t>(r)] * n, factor[r], q_.data() + j * n, n);
}

WideMatrix ConstraintBasis::null() const {
  WideMatrix basis(q_.rows(), q_.cols() - upper_.cols());
  Eigen::Index next = 0;
  for (Eigen::Index j = 0; j < q_.cols(); ++j)
    if (std::find(pivots_.begin(), pivots_.end(), j) == pivots_.end()) basis.col(next++) = q_.col(j);
  return basis;
}

WideMatrix ConstraintBasis::least(const WideMatrix& right) const {
  const WideMatrix ordered = right(order_, Eigen::all);
  return product(q_(Eigen::all, pivots_), upper_.transpose().triangularView<Eigen::Lower>().solve(ordered));
}

}  // namespace pwlsim::linalg
