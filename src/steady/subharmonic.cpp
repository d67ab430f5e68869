#include "steady/subharmonic.hpp"

#include <cmath>

#include "linalg/factorisations.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

constexpr int periods_of_long_run = 50;                             ///< times k
constexpr int few_periods_after_push = 4, periods_after_push = 20;  ///< times k

/// The orbit moved along its most unstable direction.
engine::RunState beside(const engine::March& march, const Orbit& orbit) {
  const Stacking stacking(march.model());
  engine::RunState state = orbit.begin;
  if (orbit.monodromy.size() == 0) return state;
  const Eigen::EigenSolver<Matrix> eigen(orbit.monodromy);
  Eigen::Index most = 0;
  eigen.eigenvalues().cwiseAbs().maxCoeff(&most);
  const Vector direction = eigen.eigenvectors().col(most).real().normalized();
  state.xi = stacking.apart(stacking.stacked(state.xi) + tolerance::push * orbit.largest * direction);
  return state;
}

}  // namespace

int repeats_after(engine::March& march, const Orbit& orbit, const OrbitTask& task) {
  const Stacking stacking(march.model());
  for (int part = 1; part <= task.multiple / 2; ++part) {
    if (task.multiple % part != 0) continue;
    engine::RunState state = orbit.begin;
    const engine::Answer answer = march.advance(state, task.period * part / task.multiple, nullptr);
    if (answer.outcome != engine::Outcome::completed) continue;
    if ((stacking.stacked(state.xi) - stacking.stacked(orbit.begin.xi)).norm() <= tolerance::same_orbit * orbit.largest) return part;
  }
  return 0;
}

Orbit find_driven_orbit(engine::March& march, const engine::RunState& start, const OrbitTask& task) {
  Orbit orbit = find_orbit(march, start, task);
  if (task.multiple == 1 || orbit.verdict != Verdict::found) return orbit;
  orbit.repeats_after = repeats_after(march, orbit, task);
  if (orbit.repeats_after == 0) return orbit;
  const auto again = [&](const engine::RunState& from, int periods) {
    OrbitTask further = task;
    further.periods_before = periods;
    Orbit other = find_orbit(march, from, further);
    other.periods_simulated += orbit.periods_simulated;
    return other;
  };
  Orbit other = again(beside(march, orbit), few_periods_after_push);
  if (other.verdict != Verdict::found || repeats_after(march, other, task) != 0) other = again(start, periods_of_long_run);
  if (other.verdict != Verdict::found || repeats_after(march, other, task) != 0) other = again(beside(march, orbit), periods_after_push);
  if (other.verdict == Verdict::found && repeats_after(march, other, task) == 0) return other;
  orbit.periods_simulated = other.periods_simulated;
  return orbit;
}

}  // namespace pwlsim::steady
