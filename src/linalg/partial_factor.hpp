#pragma once
/// LU factors of a matrix by those of another of the same pattern that differs from it in few entries.
///
/// Columns whose entries are the same, and which meet the same columns in their elimination, are taken over (Chan and Brandwajn, IEEE Trans. Power
/// Systems 1(1), 1986, "Partial matrix refactorization"); the others are eliminated anew, with pivots of their own and time proportional to their
/// operations (Gilbert and Peierls, SIAM J. Sci. Stat. Comput. 9, 1988). Both matrices go by one order of columns.

#include <optional>
#include <vector>

#include "linalg/fixed_pivots.hpp"
#include "linalg/sifted.hpp"

namespace pwlsim::linalg {

/// A factor with its matrix.
struct FactoredMatrix {
  const FixedPivotFactor& factor;
  const std::vector<double>& values;
};

class PartialFactor {
 public:
  /// The sifter must outlive it.
  explicit PartialFactor(Sifter& sifter);

  /// `diagonal_share`: the pivot of the order is taken where it is at least this share of the largest entry that is left of its column.
  /// Nothing where a column has no pivot.
  [[nodiscard]] std::optional<FixedPivotFactor> factor(const FactoredMatrix& other, const std::vector<double>& values,
                                                       double diagonal_share);
  /// Of the last one, those that were not taken over.
  [[nodiscard]] int eliminated_columns() const { return eliminated_columns_; }

 private:
  void begin(const FactoredMatrix& other, const std::vector<double>& values);
  void find_changes(const FactoredMatrix& other, const std::vector<double>& values);
  void note_change(std::size_t entry, bool is_zero);
  void scale_again(int row, const std::vector<double>& values);
  [[nodiscard]] bool may_take_over(int column, const Pivots& other) const;
  [[nodiscard]] bool may_keep_single(int row, int column, const Pivots& other) const;
  void take_over(int column, const FixedPivotFactor& other);
  void copy_columns(const FixedPivotFactor& other);
  void scatter(int column, const std::vector<double>& values);
  void reach(int first);
  void eliminate();
  [[nodiscard]] int choose_pivot(int preferred, double diagonal_share);
  void exchange_preferred(std::vector<int>& preferred, std::size_t k, int pivot);
  void take_single(int row, int column, const std::vector<double>& values);
  void end_column(int row, int column);

  Sifter& sifter_;
  std::vector<int> column_of_entry_;
  FixedPivotFactor::Values values_;  ///< of the factor that is made
  std::shared_ptr<Pivots> pivots_;
  std::vector<char> is_changed_;           ///< columns that differ
  std::vector<char> is_taken_over_;        ///< of rows that are pivots: the column is
  int first_copied_ = 0, end_copied_ = 0;  ///< places of the other's columns that are taken over and wait for being copied
  int eliminated_columns_ = 0;
  std::vector<char> is_changed_row_;
  std::vector<int> changed_rows_;
  std::vector<int> place_before_;  ///< of each column among the other's pivots
  int first_single_before_ = 0;    ///< of these places
  std::vector<int> preferred_of_;  ///< of each row the place of the pivot that it should be
  /// Of the column that is eliminated.
  std::vector<double> column_;
  std::vector<int> rows_left_, reached_;  ///< without a pivot yet; with one, each before those that reach it
  std::size_t left_ = 0, reached_count_ = 0;
  std::vector<int> mark_;  ///< rows that were seen for the column with this number
  int present_ = 0;
  struct Visit {
    int row, next, end;
  };
  std::vector<Visit> visits_;
};

}  // namespace pwlsim::linalg
