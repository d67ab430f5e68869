#pragma once
/// Sparse LU of SuiteSparse KLU (Davis and Palamadai Natarajan, ACM TOMS 37, 2010, Algorithm 907), owned and counted.
///
/// The ordering is found once for a pattern. A matrix of that pattern is factored with pivoting, or with the pivots of an earlier one, which
/// is faster and as good if these pivots still are: pivot growth, then the ratio of pivots, then an estimate of the condition decide this;
/// otherwise it is factored with new pivots. Of KLU's factorisation only the pivots are kept (fixed_pivots.hpp).

#include <cstdint>
#include <memory>
#include <vector>

#include "linalg/fixed_pivots.hpp"
#include "linalg/sparse.hpp"

namespace pwlsim::linalg {

enum class Factored { good, singular, no_memory };

class KluOrdering {
 public:
  explicit KluOrdering(SparsePattern pattern);
  ~KluOrdering();
  KluOrdering(const KluOrdering&) = delete;
  KluOrdering& operator=(const KluOrdering&) = delete;

  [[nodiscard]] const SparsePattern& pattern() const { return pattern_; }
  /// From now on pivots are the largest entries that are left of their columns (partial pivoting). KLU usually takes those on the ordering's diagonal down to a thousandth of that, which costs six
  /// digits in bridges with leaks of 10¹¹ Ω, and saves no time.
  void pivot_on_largest();
  /// False if no values give a regular matrix; it cannot be factored then.
  [[nodiscard]] bool structurally_regular() const;
  /// Counts of all factors of this ordering.
  struct Counts {
    std::uint64_t factorizations = 0;          ///< with pivoting
    std::uint64_t refactorizations = 0;        ///< with kept pivots
    std::uint64_t partial_factorizations = 0;  ///< with pivoting, of columns that differ from those of another factor
    std::uint64_t solves = 0;                  ///< right-hand sides
  };
  mutable Counts counts;

 private:
  friend class KluFactor;
  struct Handle;
  class Elimination;
  SparsePattern pattern_;
  std::unique_ptr<Handle> handle_;
  mutable std::vector<double> work_;
};

class KluFactor {
 public:
  /// The ordering must outlive the factor.
  explicit KluFactor(const KluOrdering& ordering) : ordering_(&ordering) {}

  /// `values`: one per entry of the pattern.
  [[nodiscard]] Factored factor(const std::vector<double>& values);
  /// With the pivots of the last `factor`, if there was one and they are still good.
  [[nodiscard]] Factored refactor(const std::vector<double>& values);
  /// With the pivots of another factor of the same ordering, in the same way.
  [[nodiscard]] Factored refactor_as(const KluFactor& other, const std::vector<double>& values);
  /// With new pivots, as by `factor`; columns that the factor of a matrix with few other entries has as well are taken over. That one must have pivots of its own.
  [[nodiscard]] Factored factor_near(const KluFactor& other, const std::vector<double>& values);
  /// b := A⁻¹ b for `columns` columns, one after the other. Only after a successful factorisation.
  void solve(double* b, int columns = 1) const;

  /// Not those of a matrix before.
  [[nodiscard]] bool has_own_pivots() const { return has_own_pivots_; }
  /// Smallest over largest pivot of the last factorisation.
  [[nodiscard]] double pivot_ratio() const { return numeric_.pivot_ratio(); }
  /// After `singular`: the column where this was found, −1: unknown.
  [[nodiscard]] int singular_column() const { return singular_column_; }
  /// Entries of L and U.
  [[nodiscard]] std::size_t entries() const { return numeric_.entries(); }

 private:
  [[nodiscard]] Factored factor_by(const std::shared_ptr<const Pivots>& pivots, int order, const std::vector<double>& values);
  void keep(FixedPivotFactor factor, const std::vector<double>& values);
  [[nodiscard]] bool pivots_are_good(const std::vector<double>& values) const;

  const KluOrdering* ordering_;
  FixedPivotFactor numeric_;
  std::vector<double> values_;  ///< of the matrix
  int order_ = 0;               ///< of the ordering's, the one that the factor goes by
  bool has_own_pivots_ = false;
  double first_pivot_ratio_ = 0.0;
  int singular_column_ = -1;
};

}  // namespace pwlsim::linalg
