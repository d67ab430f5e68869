#pragma once
/// The part of a mode that is left once its fast decays have died out.
///
/// Where A₁ has eigenvalues far apart, c = N c_s + M f + L ζ with N, M bases of the slow and the fast invariant subspace and L ζ the
/// quasi-static response of the fast part to the sources, so that f' = A_f f goes to zero by itself and
///
///     c_s' = W A₁ N c_s + W E ζ,   W N = 1, W M = 0.
///
/// With f at rounding level a guard is a function of (c_s, ζ) alone, which moves at the slow rate: bounds on its derivatives close over
/// intervals of that length. Computed in extended precision by subspace iteration (Golub & Van Loan, Matrix Computations, §7.3, §7.6).

#include <memory>
#include <vector>

#include "model/mode.hpp"

namespace pwlsim::model {

struct SlowPart {
  Mode mode;           ///< in coordinates (c_s, ζ): flow, guards and their norms; no outputs
  Matrix basis, lift;  ///< N (n1 × n_s), orthonormal; L (n1 × n_ζ)
  Matrix coordinates;  ///< W (n_s × n1)

  /// y of the whole mode -> y of this part; false where the fast part is not yet at rounding level.
  [[nodiscard]] bool enter(const double* whole, double* slow) const;
  void to_whole(const double* slow, double* whole) const;
};

/// Slow parts of a mode, the fastest first; empty where no gap in the spectrum, or nothing damped behind it, makes one worth having.
[[nodiscard]] std::vector<std::unique_ptr<SlowPart>> slow_parts(const System& system, const Mode& mode);

}  // namespace pwlsim::model
