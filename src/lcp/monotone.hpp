#pragma once
/// All solutions of a monotone problem (M positive semidefinite, not necessarily symmetric) from one of them.
///
/// They form the polyhedron {z : z_B ≥ 0, w_N ≥ 0, all other z and w zero} with B (N) the indices where some solution has z_i > 0 (w_i > 0): a
/// solution differs from another by d with (M + Mᵀ) d = 0, and B and N are disjoint (Cottle, Pang, Stone, Theorem 3.1.7). B and N grow from one
/// solution by directions d with d_i ≥ 0, (M d)_i ≥ 0 on the indices undecided as yet; that none is left is decided by the theorem of
/// Stiemke: G t ≥ 0, G t ≠ 0 has no solution t exactly when Gᵀ λ = 0 for a λ > 0, and min |Gᵀ λ|², λ ≥ 1, is a complementarity problem
/// whose solution gives either that λ or the direction t = Gᵀ λ.

#include "lcp/problem.hpp"

namespace pwlsim::lcp {

struct SolutionSet {
  int dimension = 0;                             ///< of the polyhedron; 0: one solution
  linalg::Vector z, w;                           ///< the solution with the least |z|² + |w|², in the units of the caller
  bool least = true;                             ///< false: the projection failed; z, w is a solution from inside the polyhedron
  std::vector<char> z_determined, w_determined;  ///< the same in all solutions
};

/// `z`: any solution. The least norm counts z and w alike, so that it does not depend on which of a port's two variables was called z.
/// Directions of M below 1e-10 after diagonal scaling count as without effect, components below 1e-10 of the largest of their kind as zero.
[[nodiscard]] SolutionSet all_solutions(const linalg::Matrix& m, const linalg::Vector& q, const linalg::Vector& z);

/// Whether the symmetric part of M, scaled to a unit diagonal, has no eigenvalue below −1e-12·k.
[[nodiscard]] bool is_monotone(const linalg::Matrix& m);

}  // namespace pwlsim::lcp
