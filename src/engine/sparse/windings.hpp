#pragma once
/// Coordinates m in which coupled inductors are not coupled:  i = Wᵀ m,  W L Wᵀ = D,  D diagonal, W unit lower triangular in the order of the pivots.
///
/// With L = U D Uᵀ, W = U⁻¹:  m = Uᵀ i,  and Faraday's laws  v = L i'  become  W v = D m'.  Two windings have m₁ = i₁ + (M/L₁) i₂, the current that magnetises
/// the core, and m₂ = i₂ with the leakage  L₂ − M²/L₁ = L₂ (1 − k²),  a coefficient of its own and no difference of two. Where the coupling is perfect it
/// is zero, and what is left of Faraday's law is the ratio of the voltages. Computed in extended precision from the coefficients, by pivots of the matrix with
/// unit diagonal.

#include <vector>

#include "linalg/dense.hpp"
#include "model/network.hpp"

namespace pwlsim::engine::sparse {

class Windings {
 public:
  explicit Windings(const model::Network& network);

  /// weight times a quantity of an inductor, or of a coordinate.
  struct Share {
    int index;
    double weight;
  };
  using Sum = std::vector<Share>;
  /// Row j of W: whose voltages drive m_j, and into whose currents it goes.
  [[nodiscard]] const Sum& voltages(int j) const { return of(w_, j); }
  /// Column i of W: the current of an inductor as a sum of m.
  [[nodiscard]] const Sum& current(int i) const { return of(w_columns_, i); }
  /// Column j of U: m_j as a sum of currents.
  [[nodiscard]] const Sum& coordinate(int j) const { return of(u_columns_, j); }
  /// Flux of an inductor over its inductance as a sum of m.
  [[nodiscard]] const Sum& flux(int i) const { return of(fluxes_, i); }
  /// D_j in H; zero where a perfect coupling leaves nothing.
  [[nodiscard]] double inductance(int j) const { return d_[static_cast<std::size_t>(j)]; }
  /// False: the inductance matrix is indefinite though all inductances are positive.
  [[nodiscard]] bool possible() const { return possible_; }

 private:
  static const Sum& of(const std::vector<Sum>& sums, int i) { return sums[static_cast<std::size_t>(i)]; }
  struct Decoupling;
  void decouple(const model::Network& network, const std::vector<int>& group);
  void take(const Decoupling& parts, const linalg::WideVector& signs, const linalg::WideVector& root, const std::vector<int>& group);

  std::vector<Sum> w_, w_columns_, u_columns_, fluxes_;
  std::vector<double> d_;
  bool possible_ = true;
};

}  // namespace pwlsim::engine::sparse
