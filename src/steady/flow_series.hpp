#pragma once
/// Integrals of e^{At} against turns that are slow in comparison with the length τ of a stretch, also where A is singular:
///
///     W(ω) = ∫₀^τ e^{(A − jω)s} ds = τ Σ (−jωτ)^k N_k,   ∫₀^τ s e^{(A − jω)s} ds = τ² Σ (−jωτ)^k (k + 1) N_{k+1},   N_k = ∫₀¹ x^k/k! e^{Aτx} dx.
///
/// N_k of a part of the stretch that is brief for A by Taylor's series, then by doubling: N_k(2h) = 2^{−k−1} [N_k + e^{Ah} Σ_i N_i/(k − i)!](h). All terms add up
/// where (A − jω)⁻¹ (e^{(A − jω)τ} − 1) cancels.

#include <complex>
#include <vector>

#include "linalg/dense.hpp"

namespace pwlsim::steady {

class FlowSeries {
 public:
  FlowSeries(const linalg::Matrix& a, double length);

  /// Whether a turn is slow enough for the series.
  [[nodiscard]] static bool is_slow(double omega, double length);
  /// W(ω).
  [[nodiscard]] Eigen::MatrixXcd integral(double omega) const;
  /// The same with the factor s.
  [[nodiscard]] Eigen::MatrixXcd moment(double omega) const;

 private:
  double length_;
  std::vector<linalg::Matrix> n_;
};

}  // namespace pwlsim::steady
