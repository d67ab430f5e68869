#pragma once
/// The free directions of linear constraints.

#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

/// For independent rows H (k × n): an orthonormal basis of {x : H x = 0} that keeps unknowns that no constraint reads as they are. Each
/// Householder reflection is about an unknown in which its constraint is large, so that small entries of the basis keep their digits.
class ConstraintBasis {
 public:
  explicit ConstraintBasis(const WideMatrix& rows);

  /// n × (n − k).
  [[nodiscard]] WideMatrix null() const;
  /// The least X (n × columns of `right`) with H X = right.
  [[nodiscard]] WideMatrix least(const WideMatrix& right) const;
  /// k unknowns in which constraints are large: H is regular in them.
  [[nodiscard]] const std::vector<Eigen::Index>& pivots() const { return pivots_; }

 private:
  std::vector<Eigen::Index> pivots_, order_;  ///< unknown and constraint of each reflection
  WideMatrix q_, upper_;                      ///< Hᵀ = Q R, the rows of R that are not zero at the pivots
};

}  // namespace pwlsim::linalg
