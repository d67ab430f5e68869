#pragma once
/// Periodic orbits: Newton's method on the exact map over a period, with its exact derivative.
///
/// Driven: x ↦ φ_T(x) from t = 0⁻ to T⁻, T the common period of the sources, times k. Self-timed: the return map of an event, right of it.
/// A step is accepted if it passes the natural monotonicity test (Deuflhard, Newton Methods for Nonlinear Problems, 2004, §3.3); a few steps need not.
/// If Newton's method is stuck, the implicit Euler method follows x' = φ(x) − x, several periods per step (pseudo-transient continuation:
/// Kelley & Keyes, SIAM J. Numer. Anal. 35 (1998)); if that does not help either, periods are simulated.

#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "engine/exact/march.hpp"
#include "steady/orbit_trace.hpp"
#include "steady/variation.hpp"

namespace pwlsim::steady {

/// The event of a self-timed circuit that begins a period: true at that instant.
struct Section {
  std::string name;  ///< "S1 closes"
  EndsAt is_passed;
};

struct OrbitTask {
  double period = 0.0;   ///< s, of a driven circuit: k times the common period; 0: self-timed
  int multiple = 1;      ///< k
  Section section;       ///< self-timed
  double longest = 0.0;  ///< s, self-timed: without an event for this long there is none
  int most_iterations = 100;
  int most_periods = 4000;  ///< simulated
  int periods_before = 4;   ///< simulated before the first step
  double tolerance = 0.0;   ///< of ‖φ(x) − x‖ against the largest state; 0: rounding
};

enum class Verdict { found, no_orbit, drifts, not_converged, no_event, run_failed, interrupted };

struct Multiplier {
  std::complex<double> value;
  bool trivial = false;
  Eigen::VectorXcd direction;  ///< its eigenvector, of the stacked state
  double residual = 0.0;       ///< ‖Φ v − λ v‖ for |v| = 1, where it is one of Arnoldi's method
};

/// As Beside, by name.
struct NamedBeside {
  double time = 0.0;  ///< s
  std::string name;
};

struct Orbit {
  Verdict verdict = Verdict::not_converged;
  engine::Answer answer;  ///< of the last run
  engine::RunState begin;
  double period = 0.0;  ///< s
  Trace trace;          ///< of one period, `multiple` periods of the sources
  Matrix monodromy;
  std::string kink;            ///< why there are no multipliers; "" if there are
  std::vector<Beside> beside;  ///< guards passed together with other events: multipliers are those of one order
  double residual = 0.0;       ///< ‖φ(x) − x‖ against the largest state on the orbit
  double largest = 0.0;        ///< that state's norm, √J
  int iterations = 0, periods_simulated = 0;
  double least_singular = 1.0;          ///< smallest singular value of I − Φ
  std::vector<Vector> free_directions;  ///< of a family of orbits
  Vector drift;                         ///< of ξ per period, if it drifts
  std::vector<Multiplier> multipliers;  ///< the largest first; those that are zero are left out
  double uncertainty = 0.0;             ///< of Krylov segments: how far a store may be beside the orbit, of the largest of its unit
  bool has_leading_only = false;        ///< of the multipliers: found by Krylov segments
  std::string unknown_stability;        ///< then why the largest is not known; "" if it is
  std::vector<NamedBeside> named_beside;
  std::vector<double> residuals;  ///< of the iterations
  std::string section;            ///< self-timed: the event that begins the period
  int repeats_after = 0;          ///< k > 1: the orbit found repeats after this many of its k periods; 0: after all of them
  bool drift_turns = false;       ///< the drifting state oscillates within the period: a resonance
  bool repeats_modes = false;     ///< not converged: the best attempt goes through the same modes in the next period
};

[[nodiscard]] Orbit find_orbit(engine::March& march, const engine::RunState& start, const OrbitTask& task);

/// Largest magnitude of the multipliers except the trivial one; 0 if there is none.
[[nodiscard]] double spectral_radius(const Orbit& orbit);

}  // namespace pwlsim::steady
