#pragma once
/// Certificates that a system has one solution: passivity in energy coordinates, or positive principal minors.

#include "model/network.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

/// Largest eigenvalue of [[τ0(A+Aᵀ), τ0·B−Cᵀ],[τ0·Bᵀ−C, −(D+Dᵀ)]] over the ξ part, with ξ divided by √(τ0‖A‖) first (KYP with K = τ0·I).
/// ≤ passivity_tolerance: the system is passive, its state trajectory unique and never amplifies errors.
inline constexpr double passivity_tolerance = 1e-9;  ///< Of: the scaled matrix. Why: rounding of the extraction, and of gains that cancel.
[[nodiscard]] double kyp_residual(const System& system);

/// Whether the system has a solution from any state, with any sources and switch positions. Sufficient: it is passive and [B; D + Dᵀ] has
/// full column rank. With G = (sI − A)⁻¹B the matrix M = D + C·G of the rational problem obeys M + Mᵀ ⪰ D + Dᵀ + 2s·GᵀG, so it is then
/// positive definite at every s > 0 (van der Schaft & Schumacher 1996, §4, have it for B of full column rank).
[[nodiscard]] bool always_has_solution(const System& system);

/// Whether all 2ᵏ−1 principal minors of a k×k matrix are positive: M is a P-matrix, and y = q + M u, 0 ≤ u ⊥ y ≥ 0 has one solution for
/// every q (Cottle, Pang & Stone 1992, Theorem 3.3.7). Works in time 2ᵏ.
inline constexpr int most_ports_for_minors = 20;
[[nodiscard]] bool has_positive_principal_minors(Matrix m);

/// Whether the network consists of resistances ≥ 0, diodes, switches and independent sources besides its stores: then, with stores of
/// positive energy, it is passive whatever the rounding of its matrices. A controlled source of voltage with nothing else at one of its nodes only computes
/// a number.
[[nodiscard]] bool has_passive_parts_only(const Network& network);

}  // namespace pwlsim::model
