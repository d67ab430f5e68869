#include "linalg/careful_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "linalg/tolerances.hpp"

namespace pwlsim::linalg {

namespace {

void normalise(Doubled& n) {
  const Wide sum = n.value + n.rest;
  n.rest -= sum - n.value;
  n.value = sum;
}

}  // namespace

CarefulElimination::CarefulElimination(const WideMatrix& m, const WideMatrix& rest, const WideMatrix& doubt)
    : rows_(m.rows()),
      columns_(m.cols()),
      entry_(static_cast<std::size_t>(m.size())),
      row_(static_cast<std::size_t>(rows_)),
      column_(static_cast<std::size_t>(columns_)) {
  std::iota(row_.begin(), row_.end(), 0);
  std::iota(column_.begin(), column_.end(), 0);
  for (Eigen::Index i = 0; i < m.size(); ++i) {
    Number& number = entry_[static_cast<std::size_t>(i)];
    number = {{m.data()[i], rest.size() > 0 ? rest.data()[i] : 0}, doubt.size() > 0 ? doubt.data()[i] : 0};
    normalise(number.n);
    if (std::abs(number.n.value) <= number.error) number = {};
  }
  eliminate();
}

Doubled CarefulElimination::quotient(const Doubled& a, const Doubled& b) {
  const Wide first = a.value / b.value;
  Doubled remainder = a;
  subtract_product(remainder, {first, 0}, b);
  Doubled result{first, remainder.value / b.value};
  normalise(result);
  return result;
}

CarefulElimination::Number CarefulElimination::quotient(const Number& a, const Number& b) {
  const Doubled result = quotient(a.n, b.n);
  const Wide size = std::abs(result.value);
  return {result, (a.error + size * b.error) / std::abs(b.n.value) + tolerance::doubled_rounding * size};
}

/// a := a − b·c.
void CarefulElimination::subtract_product(Doubled& a, const Doubled& b, const Doubled& c) {
  a.add_product(-b.value, c.value);
  a.rest -= b.value * c.rest + b.rest * c.value;
  normalise(a);
}

/// The same, and zero where that is not above its error.
void CarefulElimination::subtract_product(Number& a, const Number& b, const Number& c) {
  const Wide size = std::abs(b.n.value * c.n.value);
  a.error += std::abs(b.n.value) * c.error + std::abs(c.n.value) * b.error + b.error * c.error +
             tolerance::doubled_rounding * (size + std::abs(a.n.value));
  subtract_product(a.n, b.n, c.n);
  if (std::abs(a.n.value) <= a.error) a = {};
}

/// Largest of what is left to the diagonal; false where nothing is left.
bool CarefulElimination::bring_pivot() {
  Eigen::Index i = rank_, j = rank_;
  for (Eigen::Index b = rank_; b < columns_; ++b)
    for (Eigen::Index a = rank_; a < rows_; ++a)
      if (std::abs(at(a, b).n.value) > std::abs(at(i, j).n.value)) {
        i = a;
        j = b;
      }
  if (at(i, j).is_zero()) return false;
  if (i != rank_)
    for (Eigen::Index b = 0; b < columns_; ++b) std::swap(at(i, b), at(rank_, b));
  if (j != rank_)
    for (Eigen::Index a = 0; a < rows_; ++a) std::swap(at(a, j), at(a, rank_));
  std::swap(row_[static_cast<std::size_t>(i)], row_[static_cast<std::size_t>(rank_)]);
  std::swap(column_[static_cast<std::size_t>(j)], column_[static_cast<std::size_t>(rank_)]);
  return true;
}

void CarefulElimination::eliminate() {
  std::vector<Eigen::Index> used;
  for (; rank_ < std::min(rows_, columns_) && bring_pivot(); ++rank_) {
    used.clear();
    for (Eigen::Index b = rank_ + 1; b < columns_; ++b)
      if (!at(rank_, b).is_zero()) used.push_back(b);
    for (Eigen::Index a = rank_ + 1; a < rows_; ++a) {
      if (at(a, rank_).is_zero()) continue;
      at(a, rank_) = quotient(at(a, rank_), at(rank_, rank_));
      for (const Eigen::Index b : used) subtract_product(at(a, b), at(a, rank_), at(rank_, b));
    }
  }
}

/// With t(i, k) for i ≤ k < rank the entries of a triangle and t(i, f) those of the rows or columns behind it: vectors v with v_f = 1 and
/// Σ t(i, k) v_k = 0, each entry at its place.
template <class Triangle>
WideMatrix CarefulElimination::null_vectors(const std::vector<Eigen::Index>& place, const Triangle& t) const {
  const auto size = static_cast<Eigen::Index>(place.size());
  WideMatrix result = WideMatrix::Zero(size, size - rank_);
  std::vector<Number> v(static_cast<std::size_t>(rank_));
  for (Eigen::Index f = rank_; f < size; ++f) {
    result(place[static_cast<std::size_t>(f)], f - rank_) = 1;
    for (Eigen::Index i = rank_; i-- > 0;) {
      Number& value = v[static_cast<std::size_t>(i)];
      value = t(i, f);
      value.n = {-value.n.value, -value.n.rest};
      for (Eigen::Index k = i + 1; k < rank_; ++k) {
        const Number& other = v[static_cast<std::size_t>(k)];
        if (!other.is_zero() && !t(i, k).is_zero()) subtract_product(value, t(i, k), other);
      }
      if (!value.is_zero()) value = quotient(value, t(i, i));
      result(place[static_cast<std::size_t>(i)], f - rank_) = value.n.value;
    }
  }
  return result;
}

WideMatrix CarefulElimination::kernel() const {
  return null_vectors(column_, [this](Eigen::Index i, Eigen::Index k) -> const Number& { return at(i, k); });
}

WideMatrix CarefulElimination::left_kernel() const {
  const Number one{{1, 0}, 0};
  return null_vectors(row_, [this, &one](Eigen::Index i, Eigen::Index k) -> const Number& { return i == k ? one : at(k, i); });
}

WideMatrix CarefulElimination::solve(const WideMatrix& right) const {
  WideMatrix x = WideMatrix::Zero(columns_, right.cols());
  std::vector<Doubled> y(static_cast<std::size_t>(rank_));
  for (Eigen::Index c = 0; c < right.cols(); ++c) {
    const auto subtract = [&](Doubled& value, Eigen::Index i, Eigen::Index k) {
      const Doubled& other = y[static_cast<std::size_t>(k)];
      if (!at(i, k).is_zero() && other.value != 0) subtract_product(value, at(i, k).n, other);
    };
    for (Eigen::Index i = 0; i < rank_; ++i) {
      Doubled& value = y[static_cast<std::size_t>(i)];
      value = {right(row_[static_cast<std::size_t>(i)], c), 0};
      for (Eigen::Index k = 0; k < i; ++k) subtract(value, i, k);
    }
    for (Eigen::Index i = rank_; i-- > 0;) {
      Doubled& value = y[static_cast<std::size_t>(i)];
      for (Eigen::Index k = i + 1; k < rank_; ++k) subtract(value, i, k);
      value = quotient(value, at(i, i).n);
      x(column_[static_cast<std::size_t>(i)], c) = value.value;
    }
  }
  return x;
}

}  // namespace pwlsim::linalg
