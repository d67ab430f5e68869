#pragma once
/// The DC equations of one mode, to the last place of extended precision:  0 = A ξ + B_J u_J + e,  0 = C_J ξ + D_JJ u_J + f_J.
///
/// If they leave ξ open, the solution nearest to a given x₀, and the least u if they leave u open. Iterated regularisation (the
/// proximal-point method): (K − E)(v⁺ − v) = r − K v, E = diag(ε, δ), δ ≪ ε. In a passive system −K is monotone: v keeps its component in
/// the kernel of K, all others converge to the solution, and the rank of K is never decided. Components that E does not dominate converge
/// slowly; then ε is lowered.

#include <vector>

#include "model/system.hpp"

namespace pwlsim::engine {

struct StaticModeSolution {
  bool exists = false;
  bool unique = true;  ///< ξ
  linalg::WideVector xi, u;
};

/// `rate`: of the slowest states.
[[nodiscard]] StaticModeSolution solve_static_mode(const model::System& system, const linalg::Vector& zeta, const std::vector<int>& active,
                                                   const linalg::Vector& x0, double rate);

/// Of a solution's ξ, of its largest: what rounding of A, B and C makes of it.
[[nodiscard]] double rounding_share(const model::System& system, const linalg::Vector& zeta, const std::vector<int>& active, double rate,
                                    const linalg::WideVector& xi, const linalg::WideVector& u);

}  // namespace pwlsim::engine
