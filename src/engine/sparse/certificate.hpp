#pragma once
/// Residuals of the equations on samples of the accepted steps.

#include "engine/run.hpp"
#include "engine/sparse/stepper.hpp"

namespace pwlsim::engine::sparse {

/// Every step at first, then an evenly thinning sample:
///  - complementarity: |min(u, s)| of the diodes at the end of a step, against the largest u or s of the run;
///  - KCL/KVL: every row of  k + G z + H w + g,  k the rate of E z, against its largest term of the run;
///  - energy: change of ½ zᵀE z over a step against ∫ zᵀ k by the method's own weights: what it loses or gains a step, which is of the size of
///    its local error.
class CertificateRecorder {
 public:
  explicit CertificateRecorder(const Descriptor& descriptor) : descriptor_(descriptor) {}
  void add(const Point& from, const Stepper::Trial& trial, double h, const PortSolver& ports);
  [[nodiscard]] Certificate check() const;

 private:
  void add_rows(const Point& point);
  void add_ports(const Point& point, const PortSolver& ports);
  void add_energy(const Point& from, const Stepper::Trial& trial, double h);

  const Descriptor& descriptor_;
  std::vector<double> residual_, size_, row_, row_size_, values_;
  double input_ = 0.0, slack_ = 0.0, input_scale_ = 0.0, slack_scale_ = 0.0;
  double voltage_ = 0.0;  ///< largest of a node: over R0 a current that counts when all is at rest
  double energy_ = 0.0, energy_scale_ = 0.0;
  std::uint64_t seen_ = 0, stride_ = 1, points_ = 0;
};

}  // namespace pwlsim::engine::sparse
