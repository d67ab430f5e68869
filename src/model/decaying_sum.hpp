#pragma once
/// f(τ) = c + b τ + Σ_k a_k e^{−τ/T_k}, T_k > 0: a guard while the fast decays of its mode last.

#include <vector>

namespace pwlsim::model {

struct DecayingTerm {
  double start = 0.0;          ///< a_k
  double time_constant = 0.0;  ///< T_k, s
};

struct DecayingSum {
  double rest = 0.0;  ///< c
  double drift =
      0.0;  ///< b: of the slow motion, 1/s. It counts until e^−40 of the slowest term is left: from then on the slow motion is searched
  std::vector<DecayingTerm> terms;

  /// Whether f(τ) ≥ level is proved for all τ ≥ 0. With s = e^{−τ/T}, T the largest T_k, f = c − b T ln s + Σ a_k s^{r_k} with r_k ≥ 1, and on a part [p, q] of [0, 1] each term lies between its
  /// values at both ends, and so does each term of df/ds. A part where f may be below is halved, unless f rises or falls throughout; so
  /// are its halves, a few times.
  [[nodiscard]] bool stays_above(double level) const;
  /// Whether all sums of `rest`, a part of the drift and any of the terms have the same sign.
  [[nodiscard]] bool keeps_sign() const;

 private:
  [[nodiscard]] double slowest() const;  ///< T, s
  [[nodiscard]] double drifted() const;  ///< b·40 T
};

}  // namespace pwlsim::model
