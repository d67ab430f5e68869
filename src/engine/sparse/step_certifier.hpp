#pragma once
/// Residuals of the equations on samples of the accepted steps.

#include <cmath>
#include <span>

#include "engine/run.hpp"
#include "engine/sparse/stepper.hpp"

namespace pwlsim::engine::sparse {

/// Of a segment, s: its length, and for how long it was followed. A rate that is off by a part of a charge or flux over the length is off by that part; and by no more than what it makes of them in
/// the time it was followed. They count as what all the energy would be in the row's store, |(E z)_i| <= sqrt(E_ii zᵀE z): that is what a segment's error is measured against.
struct SegmentTimes {
  double length = INFINITY, followed = INFINITY;
};

/// Every step at first, then an evenly thinning sample:
///  - complementarity: |min(u, s)| of the diodes, against the largest u or s of the run;
///  - KCL/KVL: every row of  k + G z + H w + g  at the end of a step, k the rate of E z, against its largest term of the run, beyond what rounding of
///    the rates of unknowns makes of k where these cancel (two nodes that fall together);
///  - energy: change of ½ zᵀE z over a step minus ∫ zᵀ k by the method's own weights: the energy that a step loses or gains, which is of the size of
///    its local error.
class StepCertifier {
 public:
  explicit StepCertifier(const Descriptor& descriptor) : descriptor_(descriptor), stores_(descriptor.memory_diagonal()) {}
  /// From now on ports and rows at zero may be so to rounding: of the largest unknowns, and of this voltage.
  void allow_rounding(double least) { least_ = least; }
  /// A step of TR-BDF2, of which the part up to `reached` was used.
  void add_step(const Point& from, const Stepper::Trial& trial, const Point& reached, const PortSolver& ports);
  /// Whether the next point would be looked at; one that is not counts as seen, and need not be made.
  [[nodiscard]] bool wants_point() {
    const bool is_sampled = looks_next();
    if (!is_sampled) ++seen_;
    return is_sampled;
  }
  [[nodiscard]] bool looks_next() const { return seen_ % stride_ == 0; }
  /// A point by itself. `rising`: ports whose sign is not judged there, as they are at zero to rounding and rise.
  void add_point(const Point& point, const PortSolver& ports, const SegmentTimes& times = {}, std::span<const int> rising = {});
  /// The residual of the rows at a point that is not added, as `check` would have it.
  [[nodiscard]] double row_residual(const Point& point, const SegmentTimes& times);
  /// A segment's error by its own estimate, relative to the largest √energy: a bound of its energy's error.
  void add_estimate(double share) { estimate_ = std::max(estimate_, share); }
  [[nodiscard]] Certificate check() const;

 private:
  struct Rounding {
    double voltage = 0.0, input = 0.0;
  };
  [[nodiscard]] Rounding rounding_at(const Point& point) const;
  [[nodiscard]] bool sampled();
  void add_rows(const Point& point, const SegmentTimes& times = {});
  /// Of each row the largest residual, the largest of what one makes of a charge or flux, and the largest terms; and the largest voltage of a node: over R0 a current that counts when all is at rest.
  struct Rows {
    std::vector<double> residual, moved, size;
    double voltage = 0.0, twice_energy = 0.0;
  };
  [[nodiscard]] double largest_residual(const Rows& rows) const;
  void add_ports(const Point& point, const PortSolver& ports, std::span<const int> rising = {});
  void add_energy(const Point& from, const Stepper::Trial& trial);
  [[nodiscard]] double energy(const Point& point);

  const Descriptor& descriptor_;
  std::vector<double> stores_;
  Rows rows_;
  std::vector<double> rates_, row_size_;
  double input_ = 0.0, slack_ = 0.0, input_scale_ = 0.0, slack_scale_ = 0.0;
  double least_ = 0.0;
  double energy_ = 0.0, energy_scale_ = 0.0, estimate_ = 0.0;
  std::uint64_t seen_ = 0, stride_ = 1, points_ = 0;
};

}  // namespace pwlsim::engine::sparse
