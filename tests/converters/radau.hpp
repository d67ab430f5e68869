#pragma once
/// Radau IIA with five stages, order nine, for E x' + G x = b(t) with constant E, G. With Z the changes from x(0) to the stages and D the derivative
/// of the collocation polynomial at the stages, (D⊗E/h + I⊗G) Z = b(cᵢh) - G x(0); T⁻¹ D T is diagonal: one real and two complex systems of the size of E.
/// E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, IV.5 and IV.8.

#include <array>
#include <vector>

#include "converters/sparse_lu.hpp"

namespace pwlsim::test::converters {

struct Radau {
  static constexpr std::size_t stages = 5, pairs = 2;
  using Stages = std::array<Real, stages>;

  std::array<Real, stages + 1> nodes{};  ///< nodes[0] = 0
  Real real_value = 0;                   ///< eigenvalues of D; of each conjugate pair the one with positive imaginary part
  std::array<Complex, pairs> complex_values{};
  Stages real_vector{}, real_row{};  ///< of T, T⁻¹
  std::array<std::array<Complex, stages>, pairs> complex_vectors{}, complex_rows{};
  Stages leading{};  ///< coefficient of the Chebyshev polynomial of degree five on [0, 1] in the collocation polynomial, of the changes

  /// Weights of the stage values in the polynomial of degree four through them, at `place` (1 is the end of the step).
  [[nodiscard]] Stages weights(Real place) const;
};

[[nodiscard]] const Radau& radau();

}  // namespace pwlsim::test::converters
