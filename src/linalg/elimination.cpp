#include "linalg/elimination.hpp"

#include <numeric>

namespace pwlsim::linalg {

WideElimination::WideElimination(WideMatrix m, Wide tolerance)
    : lu_(std::move(m)), row_(static_cast<std::size_t>(lu_.rows())), column_(row_.size()) {
  std::iota(row_.begin(), row_.end(), 0);
  std::iota(column_.begin(), column_.end(), 0);
  const Eigen::Index q = lu_.rows();
  for (; rank_ < q; ++rank_) {
    Eigen::Index i = rank_, j = rank_;
    for (Eigen::Index b = rank_; b < q; ++b)
      for (Eigen::Index a = rank_; a < q; ++a)
        if (std::abs(lu_(a, b)) > std::abs(lu_(i, j))) {
          i = a;
          j = b;
        }
    if (!(std::abs(lu_(i, j)) > tolerance)) return;
    lu_.row(i).swap(lu_.row(rank_));
    lu_.col(j).swap(lu_.col(rank_));
    std::swap(row_[static_cast<std::size_t>(i)], row_[static_cast<std::size_t>(rank_)]);
    std::swap(column_[static_cast<std::size_t>(j)], column_[static_cast<std::size_t>(rank_)]);
    for (Eigen::Index a = rank_ + 1; a < q; ++a) lu_(a, rank_) /= lu_(rank_, rank_);
    for (Eigen::Index b = rank_ + 1; b < q; ++b)
      for (Eigen::Index a = rank_ + 1; a < q; ++a) lu_(a, b) -= lu_(a, rank_) * lu_(rank_, b);
  }
}

WideMatrix WideElimination::solve(const WideMatrix& right) const {
  WideMatrix x = WideMatrix::Zero(lu_.rows(), right.cols());
  WideVector y(rank_);
  for (Eigen::Index c = 0; c < right.cols(); ++c) {
    for (Eigen::Index i = 0; i < rank_; ++i) {
      Wide value = right(row_[static_cast<std::size_t>(i)], c);
      for (Eigen::Index k = 0; k < i; ++k) value -= lu_(i, k) * y[k];
      y[i] = value;
    }
    for (Eigen::Index i = rank_; i-- > 0;) {
      Wide value = y[i];
      for (Eigen::Index k = i + 1; k < rank_; ++k) value -= lu_(i, k) * y[k];
      y[i] = value / lu_(i, i);
      x(column_[static_cast<std::size_t>(i)], c) = y[i];
    }
  }
  return x;
}

/// With t(i, k) for i ≤ k < rank the entries of a triangle and t(i, f) those of the rows or columns behind it: vectors v with v_f = 1 and
/// Σ t(i, k) v_k = 0, each entry at its place.
template <class Triangle>
WideMatrix WideElimination::null_vectors(const std::vector<Eigen::Index>& place, const Triangle& t) const {
  const Eigen::Index q = lu_.rows();
  WideMatrix result = WideMatrix::Zero(q, q - rank_);
  WideVector v(rank_);
  for (Eigen::Index f = rank_; f < q; ++f) {
    result(place[static_cast<std::size_t>(f)], f - rank_) = 1;
    for (Eigen::Index i = rank_; i-- > 0;) {
      Wide value = -t(i, f);
      for (Eigen::Index k = i + 1; k < rank_; ++k) value -= t(i, k) * v[k];
      v[i] = value / t(i, i);
      result(place[static_cast<std::size_t>(i)], f - rank_) = v[i];
    }
  }
  return result;
}

WideMatrix WideElimination::kernel() const {
  return null_vectors(column_, [this](Eigen::Index i, Eigen::Index k) { return lu_(i, k); });
}

WideMatrix WideElimination::left_kernel() const {
  return null_vectors(row_, [this](Eigen::Index i, Eigen::Index k) { return i == k ? Wide{1} : lu_(k, i); });
}

}  // namespace pwlsim::linalg
