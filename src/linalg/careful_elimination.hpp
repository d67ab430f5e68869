#pragma once
/// Gaussian elimination that decides by its own rounding whether a pivot is zero.
///
/// Each number has twice the digits of extended precision and a bound on its error: that of M's entries, `doubt`, and
/// the rounding of each step (Higham 2002, Accuracy and Stability of Numerical Algorithms, §3.3, running error analysis). A number that is not
/// above its bound is zero. Sizes alone decide nothing: incidence numbers, which are exact, give exact ranks even with entries of 1e-20.

#include <vector>

#include "linalg/dense.hpp"
#include "linalg/doubled.hpp"

namespace pwlsim::linalg {

class CarefulElimination {
 public:
  /// Factorises M + M_rest (m × n), M_rest the rounding errors of M's entries; `doubt` (m × n) ≥ 0, or empty if M is exact.
  CarefulElimination(const WideMatrix& m, const WideMatrix& rest, const WideMatrix& doubt);

  [[nodiscard]] Eigen::Index rank() const { return rank_; }
  /// Columns that span {x : M x = 0} (n × (n − rank)); column j has a 1 in a row of its own.
  [[nodiscard]] WideMatrix kernel() const;
  /// Columns that span {y : yᵀ M = 0} (m × (m − rank)); column j has its 1 at free_rows()[j].
  [[nodiscard]] WideMatrix left_kernel() const;
  [[nodiscard]] std::vector<Eigen::Index> free_rows() const { return {row_.begin() + rank_, row_.end()}; }
  /// X with M X = right if that has a solution; unknowns beyond the rank are zero.
  [[nodiscard]] WideMatrix solve(const WideMatrix& right) const;

 private:
  struct Number {
    Doubled n;
    Wide error = 0;
    [[nodiscard]] bool is_zero() const { return n.value == 0; }
  };

  [[nodiscard]] Number& at(Eigen::Index i, Eigen::Index j) { return entry_[static_cast<std::size_t>(i + j * rows_)]; }
  [[nodiscard]] const Number& at(Eigen::Index i, Eigen::Index j) const { return entry_[static_cast<std::size_t>(i + j * rows_)]; }
  static Doubled quotient(const Doubled& a, const Doubled& b);
  static Number quotient(const Number& a, const Number& b);
  static void subtract_product(Doubled& a, const Doubled& b, const Doubled& c);
  static void subtract_product(Number& a, const Number& b, const Number& c);
  void eliminate();
  bool bring_pivot();
  template <class Triangle>
  [[nodiscard]] WideMatrix null_vectors(const std::vector<Eigen::Index>& place, const Triangle& t) const;

  Eigen::Index rows_, columns_;
  std::vector<Number> entry_;               ///< L U, column by column
  std::vector<Eigen::Index> row_, column_;  ///< of M, at each place of L U
  Eigen::Index rank_ = 0;
};

}  // namespace pwlsim::linalg
