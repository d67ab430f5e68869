#include "steady/impulses.hpp"

#include <optional>

#include "linalg/dense.hpp"
#include "model/impulse.hpp"
#include "steady/tolerances.hpp"
#include "steady/variation.hpp"

namespace pwlsim::steady {
namespace {

using linalg::Matrix;
using linalg::Vector;
using model::Mode;
using model::System;

/// Impulses of the ports by the state before the jump into a mode. Empty where they are of higher order, or no linear function.
std::optional<Matrix> ports_by_state(const System& system, const Mode& mode, const Vector& x) {
  const double rate = linalg::rate_of(system.a);
  const auto impulse_of = [&](const Vector& jump) {
    return model::find_impulse(system, rate, mode.active, jump, mode.noise * jump.norm());
  };
  const Matrix jumps = mode.projector - Matrix::Identity(system.size(), system.size());
  Matrix by_state = Matrix::Zero(system.ports, system.size());
  for (Eigen::Index k = 0; k < jumps.cols(); ++k) {
    const Vector jump = jumps.col(k);
    if (jump.norm() <= tolerance::no_jump) continue;
    const model::Impulse own = impulse_of(jump);
    if (own.order != 1) return std::nullopt;
    by_state.col(k) = own.weight;
  }
  const Vector jump = jumps * x;
  if (jump.norm() <= tolerance::no_jump * x.norm()) return by_state;
  const model::Impulse whole = impulse_of(jump);
  if (whole.order != 1 || !((by_state * x - whole.weight).norm() <= tolerance::proportional_impulse * whole.weight.norm()))
    return std::nullopt;
  return by_state;
}

}  // namespace

Impulses impulses_of(const System& system, const engine::Change& change) {
  Impulses result;
  if (change.before == nullptr || change.y_before.empty()) return result;
  Vector x(system.size()), after(system.size());
  model::from_mode(system, *change.before, change.y_before.data(), x.data());
  model::from_mode(system, *change.after, change.y_after.data(), after.data());
  x.tail(system.n_zeta) = after.tail(system.n_zeta);  // what sources are when the state jumps
  Vector rate = state_speed(system, *change.before, change.y_before);
  for (std::size_t way = 0; way < change.by_way_of.size(); ++way) {
    const Mode& mode = *change.by_way_of[way];
    if (!mode.constrained) continue;
    const std::optional<Matrix> ports = ports_by_state(system, mode, x);
    for (std::size_t k = 0; k < system.outputs.size(); ++k) {
      const model::OutputRow& row = system.outputs[k];
      if (!row.reads_ports()) continue;
      if (!ports) {
        result.unknown.push_back(static_cast<int>(k));
        continue;
      }
      OutputImpulse impulse{way, static_cast<int>(k), row.input.transpose() * *ports, 0.0, 0.0};
      if (impulse.on.isZero(0.0)) continue;
      impulse.rate = impulse.on.dot(rate.transpose());
      impulse.size = impulse.on.dot(x.transpose());
      result.list.push_back(std::move(impulse));
    }
    x = mode.projector * x;
    rate = mode.projector * rate;
  }
  return result;
}

}  // namespace pwlsim::steady
