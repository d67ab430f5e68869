#pragma once
/// Linear complementarity systems written down by hand: the examples of van der Schaft and Schumacher (1996) and others whose
/// continuation is known in closed form.

#include <algorithm>
#include <cmath>
#include <memory>

#include "model/mode.hpp"
#include "model/system.hpp"

namespace pwlsim::test {

/// n energy states, then n_ζ source states that `sources` describes.
inline model::System handmade(const model::Matrix& a, const model::Matrix& b, const model::Matrix& c, const model::Matrix& d,
                              const std::vector<model::SourceFunction>& sources = {}, bool constant = false) {
  model::System system;
  system.name = "handmade";
  system.exosystem = std::make_shared<model::Exosystem>(sources, constant);
  system.n_zeta = system.exosystem->size();
  system.n = static_cast<int>(a.rows()) - system.n_zeta;
  system.ports = system.diodes = static_cast<int>(b.cols());
  system.a = a;
  system.b = b;
  system.c = c;
  system.d = d;
  system.x0 = model::Vector::Zero(system.n);
  system.port.resize(static_cast<std::size_t>(system.ports));
  for (int i = 0; i < system.ports; ++i) system.port[static_cast<std::size_t>(i)].name = "P" + std::to_string(i);
  return system;
}

/// Two carts, two springs, a stop that keeps x1 ≥ 0 with force u; positions x1, x2, velocities x3, x4 (paper, section 1).
inline model::System carts() {
  model::Matrix a(4, 4), b(4, 1), c(1, 4);
  a << 0, 0, 1, 0, 0, 0, 0, 1, -2, 1, 0, 0, 1, -1, 0, 0;
  b << 0, 0, 1, 0;
  c << 1, 0, 0, 0;
  return handmade(a, b, c, model::Matrix::Zero(1, 1));
}

/// x1' = x2, x2' = x3, x3' = u, 0 ≤ x1 ⊥ u ≥ 0.
inline model::System triple_integrator() {
  model::Matrix a = model::Matrix::Zero(3, 3), b(3, 1), c(1, 3);
  a(0, 1) = a(1, 2) = 1.0;
  b << 0, 0, 1;
  c << 1, 0, 0;
  return handmade(a, b, c, model::Matrix::Zero(1, 1));
}

/// x' = sign·v, v ∈ sgn(x), with the relay's whole vertical segment at 0: v = 1 − 2λ, 0 ≤ λ ⊥ x + m ≥ 0, 0 ≤ m ⊥ 1 − λ ≥ 0;
/// m is the negative part of x. Ports λ, m; the state 1 comes second.
inline model::System relay(double sign) {
  model::Matrix a(2, 2), b(2, 2), c(2, 2), d(2, 2);
  a << 0, sign, 0, 0;
  b << -2 * sign, 0, 0, 0;
  c << 1, 0, 0, 1;
  d << 0, 1, -1, 0;
  return handmade(a, b, c, d, {}, true);
}

/// A tank of rate 2 with losses; its second state is behind a port whose blocking resistance makes it decay at 1/delta:
/// active: y = x₂ + δ u = 0, x₂' = −2 x₁ − x₂ + u, hence A_J = (−1 2; −2 −1−1/δ).
inline model::System leaking(double delta) {
  model::Matrix a(2, 2), b(2, 1), c(1, 2), d(1, 1);
  a << -1, 2, -2, -1;
  b << 0, 1;
  c << 0, 1;
  d << delta;
  return handmade(a, b, c, d);
}

/// Eigenvalues of (−1 2; −2 −1−r): λ² + (2 + r) λ + 5 + r = 0, the slow one without cancellation.
struct TwoRates {
  double fast, slow;
};
inline TwoRates rates(double delta) {
  const double r = 1.0 / delta, half = 0.5 * (2.0 + r);
  const double fast = -half - std::sqrt(half * half - (5.0 + r));
  return {fast, (5.0 + r) / fast};
}

inline model::Vector vector(std::initializer_list<double> values) {
  model::Vector v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

inline model::IndexSet set_of(int ports, std::initializer_list<int> members) {
  model::IndexSet set(ports);
  for (const int i : members) set.set(i, true);
  return set;
}

}  // namespace pwlsim::test
