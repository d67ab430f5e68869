#pragma once
/// A bound of the error of a motion in a Krylov space of a passive network, in the norm of the space.
///
/// What W K y and the sources' ζ of the same vectors miss, together x = (z, ζ), is one vector times a number,
///
///     x' = A x − (h x_{m+1} f_m − Δ f)/γ,   f = K² y,   Δ the rounding of the solutions T z.
///
/// No row without derivative is broken by it. But the sources of x are not those of the network: they are off by  δ = ζ − ζ_x,  δ' = A_w δ + h ζ_{m+1} f_m/γ. Where the vectors hold all
/// directions U that ζ takes, with  A_w U = U A_U,  a combination X of them has the sources U, and x + X a, δ = U a, the network's own. It misses
///
///     h (x_{m+1} − X α) f_m/γ + (A X − X A_U) a,   ζ_{m+1} = U α,   a' = A_U a + h α f_m/γ,
///
/// which has no sources. Two motions with the same sources do not depart from each other, so that the error grows by no more than the norm of that. Any X will do; it is the one for which X and
/// τ A X are least.
///
/// The start is another matter: there states are known. So is rounding, which is estimated. The integral of |f_m| is that of polynomials of degree 8 through values at equal distances, over pieces
/// that are halved until the last coefficients are small.

#include "engine/sparse/krylov_space.hpp"
#include "engine/sparse/source_directions.hpp"

namespace pwlsim::engine::sparse {

struct ErrorGrowth {
  double error = 0.0, rounding = 0.0;
  bool holds = true;  ///< false: the vectors do not hold all that the sources do, and sources that are off count as if they moved nothing
};
/// By how much the error is larger at τ than at the start, at most. `directions`: of the sources at the start. `counts`: less √energy than that is nothing.
[[nodiscard]] ErrorGrowth error_growth(const KrylovSpace::Relation& relation, const SourceDirections& directions, double tau,
                                       double counts);

}  // namespace pwlsim::engine::sparse
