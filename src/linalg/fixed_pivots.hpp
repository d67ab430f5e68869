#pragma once
/// Sparse LU factors with given pivots and blocks:
///    P R⁻¹ A Q  =  blocks L U along the diagonal and entries above them,    R the largest entry of each row.
///
/// With the pivots and the block triangular form of KLU, this does what klu_refactor and klu_solve do. The pattern of the factors does not depend on
/// values, so that several factors share one, and a solution walks through two lists. Rows keep their numbers, so that a column can be taken over where
/// others have other pivots (partial_factor.hpp).

#include <memory>
#include <vector>

#include "linalg/sparse.hpp"

namespace pwlsim::linalg {

/// Which entries of a pattern a matrix leaves zero.
struct Zeros {
  std::vector<char> is_zero;        ///< of each entry
  std::vector<int> entries_of_row;  ///< those that are not
};
[[nodiscard]] Zeros zeros_of(const SparsePattern& pattern, const std::vector<double>& values);

/// Order of the pivots, and the pattern of the factors that belongs to it. Rows are those of A.
struct Pivots {
  Zeros zeros;                   ///< entries of the matrix's pattern that are none of the factors', and have to be zero
  std::vector<int> row, column;  ///< of each pivot
  std::vector<int> place;        ///< of a row among the pivots
  std::vector<int> block;        ///< bounds of the diagonal blocks
  int single_rows = 0;           ///< blocks at the end, of rows with one entry beside such rows
  /// By columns, in the order of the pivots. Above the diagonal first the entries outside the block, in the order of A's entries, then those inside,
  /// in an order in which it can be eliminated.
  std::vector<int> lower_start{0}, lower_row, upper_start{0}, upper_row;
};

class FixedPivotFactor {
 public:
  struct Values {
    std::vector<double> lower, upper, inverse_pivot;  ///< as the pivots
    std::vector<double> row_size, row_factor;         ///< R and 1/R, of each row of A
  };
  FixedPivotFactor() = default;
  /// The pivots of known values, whose growth is accepted.
  FixedPivotFactor(std::shared_ptr<const Pivots> pivots, Values values);

  /// `values`: one per entry of the pattern. False if a pivot is zero, a factor is not finite, or what has to be zero is not.
  [[nodiscard]] bool factor(const SparsePattern& pattern, const std::vector<double>& values, std::shared_ptr<const Pivots> pivots,
                            std::vector<double>& work);
  /// b := A⁻¹ b
  void solve(double* b, std::vector<double>& work) const;
  /// b := A⁻ᵀ b
  void solve_transposed(double* b, std::vector<double>& work) const;

  [[nodiscard]] const std::shared_ptr<const Pivots>& pivots() const { return pivots_; }
  [[nodiscard]] const Values& values() const { return values_; }
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
  void scale_rows(const SparsePattern& pattern, const std::vector<double>& values);
  [[nodiscard]] double scatter(const SparsePattern& pattern, const std::vector<double>& values, int k, int first, int& above,
                               double* column);
  [[nodiscard]] double eliminate(int k, int above, double* column);

  std::shared_ptr<const Pivots> pivots_;
  Values values_;
  double pivot_ratio_ = 0.0, growth_ = 1.0;
};

}  // namespace pwlsim::linalg
