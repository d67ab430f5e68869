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
  /// The same for a τ that is not expected to recur.
  void apply_once(double tau, double* y, double* work) const;
  /// The same for a short τ of either sign; false, with y unchanged, if rate·|τ| is beyond the reach of the series.
  bool shift(double tau, double* y, double* work) const;
  /// out := e^{Aτ} y for a short τ ≥ 0, from y, Ay, … A^k y one after the other, k ≥ 1; false, without any change, if τ is beyond the reach of the
  /// series or there are too many states for it to pay.
  bool continue_series(const double* powers, int k, double tau, double* out) const;
  /// e^{Aτ} − I.
  [[nodiscard]] Matrix minus_identity(double tau) const;

  [[nodiscard]] const Matrix& a() const { return a_; }
  [[nodiscard]] double rate() const { return rate_; }

 private:
  /// The leading block, which evolves alone while all entries after it are zero, as constant sources and the inputs of derivatives are. Null if it is not much
  /// smaller.
  [[nodiscard]] const Exponential* lead(const double* y) const;
  void taylor(double tau, double* y, double* work) const;
  [[nodiscard]] Matrix taylor_minus_identity(double tau) const;
  [[nodiscard]] const Matrix& power(int p) const;

  Matrix a_;
  double rate_ = 0.0;
  int base_ = 0;                                                 ///< 2^base·rate ≤ radius
  mutable std::map<int, std::shared_ptr<const Matrix>> powers_;  ///< copies share them
  /// Intervals that recur up to rounding (a switching period) get their own matrix; the rounding is corrected to first order.
  struct Recurring {
    double tau = 0.0;
    Eigen::Index uses = 0;    ///< counted until a matrix is built
    std::uint32_t worth = 0;  ///< by its uses, older ones count less; 0: unused
    Matrix x;
  };
  [[nodiscard]] bool apply_recurring(double tau, double* y, double* work) const;
  mutable std::array<Recurring, 4> recurring_;
  mutable std::size_t victim_ = 0;
  mutable std::uint32_t misses_ = 0;  ///< times the golden ratio
  mutable std::shared_ptr<const Exponential> lead_;
  mutable Eigen::Index lead_size_ = 0;
};

/// A cheap bound of ‖A‖₂ that is not too pessimistic: the least of the 1-, ∞- and Frobenius norms.
[[nodiscard]] double norm_bound(const Matrix& m);

}  // namespace pwlsim::linalg
