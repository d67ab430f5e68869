#pragma once
/// y ↦ e^{Aτ} y for one A and many τ, exact to rounding.
///
/// Below radius/rate the Taylor series of the vector is summed; above, powers X_p = e^{A·2^p} − I are built by squaring,
/// X_{p+1} = 2X_p + X_p² (in this form a large gain loses nothing against the identity), kept, and applied digit by digit.
/// Higham, Functions of Matrices (2008), §10.3, for scaling and squaring.

#include <array>
#include <cstdint>
#include <map>
#include <memory>

#include "linalg/dense.hpp"

namespace pwlsim::linalg {

class Exponential {
 public:
  /// `rate`: a bound of the norm that governs convergence (nilpotent parts need not count), 1/s.
  Exponential() = default;
  Exponential(Matrix a, double rate);

  /// y := e^{Aτ} y, τ ≥ 0. `work` holds 2·n doubles.
  void apply(double tau, double* y, double* work) const;
  /// The same for a τ that is not expected again.
  void apply_once(double tau, double* y, double* work) const;
  /// The same for a short τ of either sign; false, and y as it was, where rate·|τ| is beyond the reach of the series.
  bool shift(double tau, double* y, double* work) const;
  /// out := e^{Aτ} y for a short τ ≥ 0, from y, Ay, … A^k y one behind the other, k ≥ 1; false, and nothing done, where τ is beyond the reach of the
  /// series or there are too many states for it to be worth while.
  bool continue_series(const double* powers, int k, double tau, double* out) const;
  /// e^{Aτ} − I.
  [[nodiscard]] Matrix minus_identity(double tau) const;

  [[nodiscard]] const Matrix& a() const { return a_; }
  [[nodiscard]] double rate() const { return rate_; }

 private:
  /// The leading block, which moves by itself while all behind it is zero, as sources at rest and the inputs of derivatives are. Null where it is not much
  /// smaller.
  [[nodiscard]] const Exponential* lead(const double* y) const;
  void taylor(double tau, double* y, double* work) const;
  [[nodiscard]] Matrix taylor_minus_identity(double tau) const;
  [[nodiscard]] const Matrix& power(int p) const;

  Matrix a_;
  double rate_ = 0.0;
  int base_ = 0;  ///< 2^base·rate ≤ radius
  mutable std::map<int, Matrix> powers_;
  /// Intervals that recur up to rounding (a switching period) get a matrix of their own; the rounding is made up for to first order.
  struct Recurring {
    double tau = 0.0;
    Eigen::Index uses = 0;    ///< up to those that are worth a matrix
    std::uint32_t worth = 0;  ///< by its uses, less of those long ago; 0: none yet
    Matrix x;
  };
  [[nodiscard]] bool apply_recurring(double tau, double* y, double* work) const;
  mutable std::array<Recurring, 4> recurring_;
  mutable std::size_t victim_ = 0;
  mutable std::uint32_t misses_ = 0;  ///< times the golden ratio
  mutable std::shared_ptr<const Exponential> lead_;
  mutable Eigen::Index lead_size_ = 0;
};

/// A norm bound that is cheap and not too pessimistic: the least of the 1-, ∞- and Frobenius norms.
[[nodiscard]] double norm_bound(const Matrix& m);

}  // namespace pwlsim::linalg
