#pragma once
/// Gaussian elimination with full pivoting in extended precision, for the matrices of a mode (one to a dozen rows), where a general
/// library spends more on blocking, packing and temporaries than on arithmetic.

#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// P M Q = L U for a square M (q × q), up to the first pivot whose magnitude is not above `tolerance`; the remainder counts as zero.
class WideElimination {
 public:
  WideElimination(WideMatrix m, Wide tolerance);

  [[nodiscard]] int rank() const { return rank_; }
  /// |first pivot| and |last pivot above the tolerance|; 0 if there is none.
  [[nodiscard]] Wide largest_pivot() const { return rank_ > 0 ? std::abs(lu_(0, 0)) : 0; }
  [[nodiscard]] Wide smallest_pivot() const { return rank_ > 0 ? std::abs(lu_(rank_ - 1, rank_ - 1)) : 0; }
  /// X (q × columns of `right`) with M X = right if that has a solution; unknowns beyond the rank are zero.
  [[nodiscard]] WideMatrix solve(const WideMatrix& right) const;
  /// M⁻¹; rank() must be q.
  [[nodiscard]] WideMatrix inverse() const { return solve(WideMatrix::Identity(lu_.rows(), lu_.rows())); }
  /// Columns that span {x : M x = 0} and {y : yᵀ M = 0}, each with an entry 1 at a place without a pivot (q × (q − rank)).
  [[nodiscard]] WideMatrix kernel() const;
  [[nodiscard]] WideMatrix left_kernel() const;

 private:
  template <class Triangle>
  [[nodiscard]] WideMatrix null_vectors(const std::vector<Eigen::Index>& place, const Triangle& t) const;

  WideMatrix lu_;
  std::vector<Eigen::Index> row_, column_;  ///< of M, at each place of L U
  int rank_ = 0;
};

}  // namespace pwlsim::linalg
