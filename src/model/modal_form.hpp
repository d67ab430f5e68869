#pragma once
/// A mode in the coordinates of its eigenvectors.
///
/// The part with rates of its own is x = (c, ζ of oscillations and decays):  x' = M x + L l,  l the levels and ramps, l'' = 0 up to the next corner of a source.
/// With M V = V Λ every coordinate of z = V⁻¹ x moves alone, and so does its part of a guard p·x + q·l, p V = (p_k):
///
///     g(τ) = g + q·l' τ + Σ_k Re p_k (z_k' e₁(λ_k, τ) + f_k' e₂(λ_k, τ)),   f' = V⁻¹ L l',   e₁ = (e^{λτ} − 1)/λ,  e₂ = (e₁ − τ)/λ,
///
/// without cancellation for rates of any size (Higham, Functions of Matrices (2008), §4.5, for diagonalization and its condition). One λ_k represents both of a complex pair.

#include <complex>
#include <memory>
#include <vector>

#include "model/mode.hpp"

namespace pwlsim::model {

/// λ_k, 1/s, and values computed from it that are used often.
struct ModalRate {
  std::complex<double> value, inverse;  ///< inverse: 0 of 0
  double size = 0.0, time = 0.0;        ///< |λ|, 1/|λ| (∞ of 0)
  double decay_time = 0.0;              ///< −1/Re λ: negative where it grows, ±∞ where it lasts
  bool is_real = true;
};

struct ModalForm {
  std::vector<ModalRate> rates;
  /// Real and imaginary parts in rows (columns) 2k and 2k + 1.
  Matrix velocities, absolute_velocities;  ///< z' = velocities·y (2·rates × ny)
  Matrix velocity_errors;                  ///< errors of z' are at most velocity_errors·|y|; empty: its rounding
  Matrix pushes;                           ///< f' = pushes·y (2·rates × ny)
  Matrix weights;                          ///< p_k of each guard (2·rates × guards)
  Matrix weight_sizes;                     ///< |p_k| (rates × guards)
  Matrix drift;                            ///< q·l' = drift·y (guards × ny)
  /// What those who search remember: where the first root of a guard was last, s from where it was looked for (0: none yet); and how many segments to come are
  /// searched so from their start.
  mutable double last_root = 0.0;
  mutable int segments_at_once = 0;
};

/// Null if the eigenvectors are too close to parallel, or too many, for it to be useful. Computed in extended precision; of many states the eigenvectors in double, and their residual is what counts. `longest`: it serves for no longer, s; what is that slow need not be told from rest.
[[nodiscard]] std::unique_ptr<ModalForm> modal_form(const System& system, const Mode& mode, double longest);

}  // namespace pwlsim::model
