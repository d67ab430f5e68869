#pragma once
/// An implicit Euler step as a change of the point that it begins at:
///    (shift·E + G) (z1 − z0) = r,   r = −(G z0 + H w0 + g) − H (w1 − w0).
///
/// Where z0 satisfies a row, r is an exact zero there but for the sources' change, which the exosystem knows to its own digits. So a point that rests has no currents,
/// be C/h times the rounding of its voltages as large as it will, and ports that are at zero leave it by what moves them.

#include <vector>

#include "engine/sparse/descriptor.hpp"
#include "linalg/dense.hpp"
#include "model/exosystem.hpp"

namespace pwlsim::engine::sparse {

/// (1 − step·A_w)⁻¹ ζ, block by block.
[[nodiscard]] linalg::Vector after_step(const model::Exosystem& exosystem, double step, const linalg::Vector& zeta);

class StartChange {
 public:
  StartChange(const Descriptor& descriptor, const model::Exosystem& exosystem) : descriptor_(descriptor), exosystem_(exosystem) {}

  /// `more`: charges and fluxes beside E z0, or empty. `zeta`: the sources' states at the start; all zero, of a deviation of two motions.
  void take(const std::vector<double>& z, const std::vector<double>& more, const linalg::Vector& zeta, double shift);
  /// r, its closing rows without meaning.
  [[nodiscard]] const std::vector<double>& right() const { return right_; }
  /// What the closing row  of_slack·s + of_input·u = 0  of a port misses: a slack that is rounding is zero. `is_at_zero`: both are.
  [[nodiscard]] double closing(const DescriptorPort& port, double of_slack, double of_input, bool is_at_zero = false) const;

 private:
  const Descriptor& descriptor_;
  const model::Exosystem& exosystem_;
  const double* z_ = nullptr;
  double one_ = 1.0;           ///< the constant of ζ: 0 of a deviation, which constants do not move
  linalg::Vector w_, change_;  ///< sources at the start, and their change
  std::vector<double> right_, sizes_;
};

}  // namespace pwlsim::engine::sparse
