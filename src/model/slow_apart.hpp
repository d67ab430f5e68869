#pragma once
/// A mode in coordinates in which its slow motion stands apart.
///
/// Fast decays that are followed are part of the mode itself, whose matrix mixes them with what is slow: e^{Aτ} then loses ‖A‖τ units of the last place, and what reads a leak through its resistance reads the
/// rounding of all states. With the slow motion ξ = N c + R ζ, c' = A_s c + E_s ζ (slow_manifold.hpp) and F orthonormal, NᵀF = 0, in the mode's own subspace,
///
///     ξ = N c + F φ,   φ = ψ + R_F ζ,   R_F = FᵀR,
///     c' = A_s c + X φ + (E_s − X R_F) ζ,   φ' = Λ φ + (R_F A_ζ − Λ R_F) ζ,   X = NᵀA F,   Λ = FᵀA F:
///
/// and a guard or signal that is C_s c + D_s ζ on the slow motion, C ξ + D ζ in the mode itself, is C_s c + C F φ + D ζ.
/// ψ = 0 is the slow motion, in its own digits, and what rounding leaves in φ decays. The coordinates are orthonormal as the mode's own, so that bounds by norms hold as there.

#include <memory>

#include "model/mode.hpp"

namespace pwlsim::model {

/// `slow`: the slow motion of `whole`, a mode of the same active set.
[[nodiscard]] std::unique_ptr<Mode> with_slow_apart(const System& system, const Mode& whole, const Mode& slow);

}  // namespace pwlsim::model
