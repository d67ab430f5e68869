#pragma once
/// The linear complementarity problem: find z with  w = M z + q,  0 ≤ w ⊥ z ≥ 0.  M: k×k, q, z, w: k.

#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::lcp {

enum class Status {
  solved,
  ray,          ///< no solution along Lemke's path; for positive semidefinite M: none exists
  pivot_limit,  ///< gave up; the path is longer than any seen for the problems in use
  cycle,        ///< returned to a basis it had left
  singular,     ///< met a basis (or pivot) that is singular
  inexact       ///< solvers claimed solutions whose residuals are too large
};

struct Solution {
  Status status = Status::solved;
  linalg::Vector z, w;
  std::vector<int> basis;  ///< indices j with z_j basic in the final tableau (M_basis nonsingular), ascending
  int pivots = 0;          ///< or iterations of a method that changes more than one index at once
};

/// Powers of two s with s_i² |M_ii| about 1 (if |M_ii| is small against its row, a hundredth of the row's largest entry is taken). With S = diag(s)
/// the problem (S M S, S q) has the solution (S⁻¹ z, S w), without any rounding.
[[nodiscard]] linalg::Vector diagonal_scale(const linalg::Matrix& m);

/// z_basis = −M_basis⁻¹ q_basis (least norm by least squares where M_basis is singular), zero elsewhere; w = M z + q, zero on the basis.
/// Negative entries of z that are rounding of the largest become zero. Status `singular` if M_basis is singular; assess the solution then.
[[nodiscard]] Solution at_basis(const linalg::Matrix& m, const linalg::Vector& q, std::vector<int> basis);

/// The violations of a claimed solution, with w recomputed as M z + q.
struct Assessment {
  double scale_z = 0.0;          ///< max |z|
  double scale_w = 0.0;          ///< max(max |q|, max |M||z|)
  double negative_z = 0.0;       ///< max(−z), relative to scale_z
  double negative_w = 0.0;       ///< max(−w), relative to scale_w
  double complementarity = 0.0;  ///< max_i min(|z_i|/scale_z, |w_i|/scale_w)
  double power = 0.0;            ///< |zᵀw|, relative to k·scale_z·scale_w

  [[nodiscard]] double worst() const;
};

[[nodiscard]] Assessment assess(const linalg::Matrix& m, const linalg::Vector& q, const linalg::Vector& z);

/// One number for a claimed solution: max_i of |min(z_i, w_i)|, w recomputed as M z + q, relative to max(|q|, |M||z|).
[[nodiscard]] double residual(const linalg::Matrix& m, const linalg::Vector& q, const linalg::Vector& z);

}  // namespace pwlsim::lcp
