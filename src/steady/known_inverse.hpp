#pragma once
/// What spaces of earlier points know of (1 − Φ)⁻¹, for systems at the next, where Φ is nearly the same.
///
/// P is a product of I + V ((1 − H)⁻¹ − I) Vᵀ, one a space: it is (1 − Φ)⁻¹ in the space, and does nothing outside of it. With δ = P y,  (1 − Φ) δ = f  reads  (1 − Ψ) y = f,  Ψ = 1 − (1 − Φ) P,
/// whose residuals are those of δ (Saad, Iterative Methods for Sparse Linear Systems, 2003, §9.3.2). Where 1 − Φ is singular and f outside of its range, no residual becomes small.

#include <vector>

#include "steady/derivative_space.hpp"

namespace pwlsim::steady {

class KnownInverse {
 public:
  using Matrix = linalg::Matrix;
  using Vector = linalg::Vector;

  explicit KnownInverse(const DerivativeSpace::Operator& phi);
  /// Ψ; Φ itself as long as nothing is known.
  [[nodiscard]] const DerivativeSpace::Operator& psi() const { return psi_; }
  [[nodiscard]] Vector applied(Vector y) const;
  [[nodiscard]] bool is_empty() const { return factors_.empty(); }
  /// From a space of Ψ.
  void learn(const DerivativeSpace& space);
  void forget();

 private:
  struct Factor {
    Matrix vectors, measured, change;
  };
  bool map(Vector& y) const;

  const DerivativeSpace::Operator& phi_;
  DerivativeSpace::Operator psi_;
  std::vector<Factor> factors_;
  Eigen::Index count_ = 0;  ///< vectors
};

}  // namespace pwlsim::steady
