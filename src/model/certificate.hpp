#pragma once
/// Passivity in energy coordinates.

#include "model/network.hpp"
#include "model/system.hpp"

namespace pwlsim::model {

/// Largest eigenvalue of [[τ0(A+Aᵀ), τ0·B−Cᵀ],[τ0·Bᵀ−C, −(D+Dᵀ)]] over the ξ part, with ξ divided by √(τ0‖A‖) first (KYP with K = τ0·I).
/// ≤ passivity_tolerance: the system is passive, its state trajectory unique and never amplifies errors.
inline constexpr double passivity_tolerance = 1e-9;
[[nodiscard]] double kyp_residual(const System& system);

/// Whether the network consists of resistances ≥ 0, diodes, switches and independent sources besides its stores: then, with stores of
/// positive energy, it is passive whatever the rounding of its matrices.
[[nodiscard]] bool has_passive_parts_only(const Network& network);

}  // namespace pwlsim::model
