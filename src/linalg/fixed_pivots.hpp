#pragma once
/// Sparse LU factors with given pivots and blocks:
///    P R⁻¹ A Q  =  blocks L U along the diagonal and entries above them,    R the largest entry of each row.
///
/// With the pivots and the block triangular form of KLU, this does what klu_refactor and klu_solve do. The pattern of the factors does not depend on
/// values, so that several factors share one, and a solution walks through two lists.

#include <memory>
#include <vector>

#include "linalg/sparse.hpp"

namespace pwlsim::linalg {

/// Order of the pivots, and the pattern of the factors that belongs to it.
struct Pivots {
  SparsePattern pattern;         ///< of the matrix, without entries that are zero
  std::vector<int> entry;        ///< of the array of values, of each entry of the pattern
  std::vector<int> left_out;     ///< entries of that array that have to be zero
  std::vector<int> row, column;  ///< of A, of each pivot
  std::vector<int> place;        ///< of a row of A among the pivots
  std::vector<int> block;        ///< bounds of the diagonal blocks
  /// By columns, in the order of the pivots. Above the diagonal first the entries outside the block, in the order of A's entries, then those inside,
  /// in an order in which it can be eliminated.
  std::vector<int> lower_start{0}, lower_row, upper_start{0}, upper_row;
};

class FixedPivotFactor {
 public:
  struct Values {
    std::vector<double> lower, upper, inverse_pivot;
    std::vector<double> row_factor;  ///< 1/R
  };
  FixedPivotFactor() = default;
  /// The pivots of known values, whose growth is accepted.
  FixedPivotFactor(std::shared_ptr<const Pivots> pivots, Values values);

  /// `values`: as the pivots' `entry` and `left_out` number them. False if a pivot is zero, a factor is not finite, or what has to be zero is not.
  [[nodiscard]] bool factor(const std::vector<double>& values, std::shared_ptr<const Pivots> pivots, std::vector<double>& work);
  /// b := A⁻¹ b
  void solve(double* b, std::vector<double>& work) const;
  /// b := A⁻ᵀ b
  void solve_transposed(double* b, std::vector<double>& work) const;

  [[nodiscard]] const std::shared_ptr<const Pivots>& pivots() const { return pivots_; }
  /// Smallest over largest pivot.
  [[nodiscard]] double pivot_ratio() const { return pivot_ratio_; }
  /// The least, over the columns of blocks, of the largest entry of A over that of U, rows scaled.
  [[nodiscard]] double growth() const { return growth_; }
  /// An estimate of ‖A⁻¹‖₁ (Hager, SIAM J. Sci. Stat. Comput. 5, 1984).
  [[nodiscard]] double inverse_norm(std::vector<double>& work) const;
  /// Entries of L and U.
  [[nodiscard]] std::size_t entries() const { return values_.lower.size() + values_.upper.size() + values_.inverse_pivot.size(); }

 private:
  void find_pivot_ratio();
  void scale_rows(const std::vector<double>& values);
  [[nodiscard]] double scatter(const std::vector<double>& values, int k, int first, int& above, double* column);
  [[nodiscard]] double eliminate(int k, int above, double* column);

  std::shared_ptr<const Pivots> pivots_;
  Values values_;
  double pivot_ratio_ = 0.0, growth_ = 1.0;
};

}  // namespace pwlsim::linalg
